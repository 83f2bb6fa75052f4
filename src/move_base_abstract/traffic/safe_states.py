"""Whether a robot may get a place without cutting any robot off from its goal, so that no circle of waiting arises.

Each robot knows its way, and so the areas into which it must still come before it holds no place any more: at its goal,
or at a point outside all areas. A robot is *able* to reach that point if there is a place for it in all these areas, or
if there would be one after other able robots have reached theirs. This is Dijkstra's banker's algorithm; for robots see
Reveliotis, "Real-time management of resource allocation systems", 2005. A place is given only if all robots that were
able still are. While all robots are able, at least one may always go on: one that reaches its goal without the others.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Dict, Iterable, List, Optional, Sequence, Tuple

if TYPE_CHECKING:
    from .area import Area, Request
    from .traveller import Traveller
    from .way import Crossing


def needs_of(ahead: Sequence[Crossing], held: Dict[Area, bool]) -> Tuple[Area, ...]:
    """Return the areas that a robot enters at the crossings ``ahead``, each once, up to where it holds no place."""
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


def first_to_go_on(travellers: Iterable[Traveller]) -> Optional[Request]:
    """Return the first request of a careful robot (``is_careful``) that may have the places for which it asks."""
    waiting = sorted(one.wants for one in travellers if one.is_careful and one.wants is not None)
    if not waiting:
        return None
    states = SafeStates(travellers)
    return next((request for request in waiting if request.is_first() and states.allows_request(request)), None)


class SafeStates:
    """Answers questions about which robot may take a place in the present state; valid until anything changes.

    A robot without a goal is assumed to leave.
    """

    def __init__(self, travellers: Iterable[Traveller]) -> None:
        self.travellers = list(travellers)
        self._busy = [traveller for traveller in self.travellers if traveller.needs]
        self._before: Optional[Dict[Traveller, bool]] = None

    def allows_request(self, request: Request) -> bool:
        """Return whether the robot of ``request`` may have its places, as :meth:`allows` does, but faster.

        If some robots would be cut off, they are noted in the request. The answer stays the same until one of these has
        moved: they wait only for one another, so what other robots do changes nothing.
        """
        taker = request.traveller
        if request.cut_off and taker in self._able_before() and all(
                one.needs is needs and tuple(one.held) == held for one, needs, held in request.cut_off):
            return False
        request.cut_off = ()
        return self.allows(taker, request.areas, request)

    def allows(self, taker: Traveller, takes: Tuple[Area, ...], request: Optional[Request] = None) -> bool:
        """Return whether ``taker`` may have a place in each of ``takes``.

        If the taker is still able, all others are, too: after it has reached its goal there are no fewer free places
        than before. So the search nearly always ends with the taker. Robots that would be cut off are noted in
        ``request``, if it is given.
        """
        if all(_has_room(area, len(area.holders), area in taker.held) for area in taker.needs):
            return True  # it reaches its goal without the others
        after = _able(self._busy, taker, takes)
        if taker in after:
            return True
        before = self._able_before()
        if taker not in before:
            return all(traveller in after for traveller in before)
        if request is not None:
            request.cut_off = tuple((one, one.needs, tuple(one.held)) for one in self._busy if one not in after)
        return False

    def against(self, request: Request) -> Tuple[Traveller, ...]:
        """Return the robots of which one must go on before the robot of ``request`` may have its places; (): it may.

        They hold places, and would not be able.
        """
        taker = request.traveller
        if self.allows_request(request):
            return ()
        after = _able(self._busy, taker, request.areas)
        return tuple(one for one in self._busy if one.held and one is not taker and one not in after)

    def _able_before(self) -> Dict[Traveller, bool]:
        if self._before is None:
            self._before = _able(self._busy)
        return self._before


def _able(busy: Sequence[Traveller], wanted: Optional[Traveller] = None,
          takes: Tuple[Area, ...] = ()) -> Dict[Traveller, bool]:
    """Return {Traveller: True} of the ``busy`` robots that are able if ``wanted`` holds ``takes``, too.

    The search ends when ``wanted`` is found to be able. Otherwise the result does not depend on the order of the
    search.
    """
    counts: Dict[Area, int] = {}  # the number of robots that hold a place and have not yet been found able
    for one in busy:
        for area in one.held:
            counts[area] = counts.get(area, 0) + 1
    for area in takes:
        counts[area] = counts.get(area, 0) + 1
    able: Dict[Traveller, bool] = {}
    stopped: Dict[Area, List[Traveller]] = {}  # robots by the first area in which there is no place for them
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
