"""Whether a place may be given away so that nobody is cut off from its goal: no circle of waiting comes to be.

Each robot knows its way, so the areas that it has yet to come into before it holds no place any more: at its goal, or
where no area is. A robot is *able* to come there if there is place for it in all of these, or would be when others who
are able have come to theirs (Dijkstra's banker; of robots, Reveliotis, "Real-time management of resource allocation
systems", 2005). A place is given only if all who were able still are. While all are able there is always one that may
go on: the first one that comes to its goal alone.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Dict, Iterable, List, Optional, Sequence, Tuple

if TYPE_CHECKING:
    from .area import Area, Request
    from .traveller import Traveller
    from .way import Crossing


def needs_of(ahead: Sequence[Crossing], held: Dict[Area, bool]) -> Tuple[Area, ...]:
    """Return the areas that are entered at the crossings ``ahead``, each once, up to where none is held any more."""
    needs: Dict[Area, bool] = {}
    holds = dict(held)
    for crossing in ahead:
        for area in crossing.enters:
            needs[area] = holds[area] = True
        for area in crossing.leaves:
            holds.pop(area, None)
        if not holds:
            break
    return tuple(needs)


def is_safe(travellers: Iterable[Traveller], taker: Traveller, takes: Tuple[Area, ...]) -> bool:
    """Return whether all of ``travellers`` who are able to come to their goals still are when ``taker`` has ``takes``.

    Who has no goal is taken for one that will leave.
    """
    return SafeStates(travellers).allows(taker, takes)


def first_to_go_on(travellers: Iterable[Traveller]) -> Optional[Request]:
    """Return the first request of those who go on where that is safe only and may have the places they wait for."""
    waiting = sorted(one.request for one in travellers if one.request is not None and one.is_careful)
    if not waiting:
        return None
    states = SafeStates(travellers)
    return next((request for request in waiting if request.is_first() and states.allows_request(request)), None)


class SafeStates:
    """Who may take a place as things are now: of as many questions as there are until anything changes."""

    def __init__(self, travellers: Iterable[Traveller]) -> None:
        self.travellers = list(travellers)
        self._busy = [traveller for traveller in self.travellers if traveller.needs]
        self._before: Optional[Dict[Traveller, bool]] = None

    def allows_request(self, request: Request) -> bool:
        """As :meth:`allows`; who would be cut off is looked for again only when one of these has moved.

        They wait for one another and for nobody else, so that what others do changes nothing.
        """
        taker = request.traveller
        if request.cut_off and taker in self._able_before() and all(
                one.needs is needs and tuple(one.held) == held for one, needs, held in request.cut_off):
            return False
        request.cut_off = ()
        return self.allows(taker, request.areas, request)

    def allows(self, taker: Traveller, takes: Tuple[Area, ...], request: Optional[Request] = None) -> bool:
        """Return whether ``taker`` may have ``takes``.

        If the taker is still able all others are, too: when it has come to its goal there is no less place than before.
        So nearly always the search ends with the taker.
        """
        if all(_has_room(area, len(area.holders), area in taker.held) for area in taker.needs):
            return True  # it comes to its goal alone
        after = _able(self._busy, taker, takes)
        if taker in after:
            return True
        before = self._able_before()
        if taker not in before:
            return all(traveller in after for traveller in before)
        if request is not None:
            request.cut_off = tuple((one, one.needs, tuple(one.held)) for one in self._busy if one not in after)
        return False

    def _able_before(self) -> Dict[Traveller, bool]:
        if self._before is None:
            self._before = _able(self._busy)
        return self._before


def _able(busy: Sequence[Traveller], wanted: Optional[Traveller] = None,
          takes: Tuple[Area, ...] = ()) -> Dict[Traveller, bool]:
    """Return {Traveller: True} of those who are able when ``wanted`` has ``takes``, too.

    The search ends where ``wanted`` is among them. Which of them is looked at first changes nothing else.
    """
    counts: Dict[Area, int] = {}  # who holds a place and has not come to its goal
    for one in busy:
        for area in one.held:
            counts[area] = counts.get(area, 0) + 1
    for area in takes:
        counts[area] = counts.get(area, 0) + 1
    able: Dict[Traveller, bool] = {}
    stopped: Dict[Area, List[Traveller]] = {}  # by the first area in which there is no place for them
    open_ = list(reversed(busy))
    while open_:
        one = open_.pop()
        held, taken = one.held, takes if one is wanted else ()
        full = None
        for area in one.needs:
            if area.capacity is not None and counts.get(area, 0) >= area.capacity + (area in held or area in taken):
                full = area
                break
        if full is not None:
            stopped.setdefault(full, []).append(one)
            continue
        able[one] = True
        if one is wanted:
            break
        for area in one.held:
            counts[area] -= 1
            open_ += stopped.pop(area, ())
    return able


def _has_room(area: Area, count: int, is_in: bool) -> bool:
    return area.capacity is None or count - is_in < area.capacity
