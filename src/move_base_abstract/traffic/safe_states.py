"""Whether a robot may get a place without cutting any robot off from its goal, so that no circle of waiting arises.

Each robot knows its way, and so the areas into which it must still come before it holds no place any more: at its goal,
or at a point outside all areas. A robot is *able* to reach that point if there is a place for it in all these areas, or
if there would be one after other able robots have reached theirs. Queues count: it is not able before those that come
before it in a queue on its way. This is Dijkstra's banker's algorithm; for robots see Reveliotis, "Real-time management
of resource allocation systems", 2005. A place is given only if all robots that were able still are, and to a robot that
holds none only if it is able. While all robots are able, at least one may always go on: one that reaches its goal
without the others.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, Iterable, List, Optional, Sequence, Tuple

if TYPE_CHECKING:
    from .area import Area, Request
    from .traveller import Traveller
    from .way import Crossing
    from .ways_out import WaysOut


def needs_of(ahead: Sequence[Crossing], held: Dict[Area, bool]) -> Tuple[Area, ...]:
    """Return the areas that a robot enters at the crossings ``ahead``, each once, up to where it holds no place."""
    return needs_and_keeps(ahead, held)[0]


def needs_and_keeps(ahead: Sequence[Crossing], held: Dict[Area, bool]) -> Tuple[Tuple[Area, ...], Tuple[Area, ...]]:
    """Return (the areas of :func:`needs_of`, those in which the robot then still holds a place: its way ends there)."""
    needs: Dict[Area, bool] = {}
    holds = dict(held)
    for crossing in ahead:
        for area in crossing.enters:
            needs[area] = holds[area] = True
        for area in crossing.leaves:
            holds.pop(area, None)
        if not holds:
            break
    return tuple(needs), tuple(holds)


def is_in_the_way(travellers: Iterable[Traveller]) -> bool:
    """Return whether any robot stands, or will stand at the end of its way, where another one has to come."""
    travellers = list(travellers)
    keeping = [(one, area) for one in travellers for area in (one.held if one.keeps is None else one.keeps)
               if area.capacity is not None]
    needed: Dict[Area, int] = {}
    for one in travellers if keeping else ():
        _count(needed, one.needs)
    return any(needed.get(area, 0) > (area in one.needs) for one, area in keeping)


def cannot_stay(travellers: Iterable[Traveller], taker: Optional[Traveller] = None,
                takes: Tuple[Area, ...] = ()) -> List[Traveller]:
    """Return the robots left over when one after the other comes to the end of its way and stays there.

    A robot comes there only if it is then in the way of none that is left. Robots without a goal stay where they are.
    ``taker`` holds ``takes``, too. If the result is empty, there is such an order; the opposite need not be true.
    """
    travellers = list(travellers)
    if taker is None and not is_in_the_way(travellers):
        busy = [one for one in travellers if one.needs]
        able = _able(busy, {})
        return [one for one in busy if one not in able]
    counts: Dict[Area, int] = {}
    staying: Dict[Area, int] = {}
    needed: Dict[Area, int] = {}
    left: List[Traveller] = []
    for one in travellers:
        _count(counts, one.held)
        if one.keeps is None:
            _count(staying, one.held)
        else:
            _count(needed, one.needs)
            left.append(one)
    _count(counts, takes)
    while True:
        for one in left:
            own: Sequence[Area] = (*one.held, *takes) if one is taker else tuple(one.held)
            if all(_has_room(area, counts.get(area, 0), area in own) for area in one.needs) and not any(
                    area.capacity is not None and staying.get(area, 0) + 1 >= area.capacity
                    and needed.get(area, 0) > (area in one.needs) for area in one.keeps or ()):
                break
        else:
            return left
        left.remove(one)
        _count(counts, own, -1)
        _count(needed, one.needs, -1)
        for areas in (counts, staying):
            _count(areas, one.keeps or ())


def _count(counts: Dict[Area, int], areas: Iterable[Area], by: int = 1) -> None:
    for area in areas:
        counts[area] = counts.get(area, 0) + by


def first_to_go_on(travellers: Iterable[Traveller], ways_out: WaysOut) -> Optional[Request]:
    """Return the first request of a careful robot (``is_careful``) that may have the places for which it asks.

    Where the moves of ``ways_out`` say whether it may, they count.
    """
    waiting = [one.asked or one.request for one in travellers if one.is_careful and (one.asked or one.request)]
    if not waiting:
        return None
    states = SafeStates(travellers, ways_out.is_safe)
    for request in sorted(one for one in waiting if one is not None):
        if request.is_first():
            allowed = ways_out.allows(request.traveller, request.areas)
            if states.allows_request(request) if allowed is None else allowed:
                return request
    return None


def is_plainly_safe(travellers: Iterable[Traveller], taker: Traveller) -> bool:
    """Return True if :meth:`SafeStates.allows` surely lets ``taker`` go on: it needs nobody, and nobody needs it."""
    return all(_has_room(area, len(area.holders), area in taker.held) for area in taker.needs) and not is_in_the_way(
        travellers)


class SafeStates:
    """Answers questions about which robot may take a place in the present state; valid until anything changes.

    A robot without a goal is assumed to leave. ``may_stay``: whether all robots can now come to the ends of their ways
    and stay there, which is kept then.
    """

    def __init__(self, travellers: Iterable[Traveller], may_stay: bool = False) -> None:
        self.travellers = list(travellers)
        self._may_stay = may_stay and is_in_the_way(self.travellers)  # otherwise all that are able can stay
        self._busy = [traveller for traveller in self.travellers if traveller.needs]
        waits = any(one.request is not None and not one.is_careful for one in self._busy)
        self._behind = {one: _before(one) for one in self._busy} if waits else {}
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
        return self._leaves_all_able(taker, takes, request) and not (
            self._may_stay and cannot_stay(self.travellers, taker, takes))

    def _leaves_all_able(self, taker: Traveller, takes: Tuple[Area, ...], request: Optional[Request]) -> bool:
        if all(_has_room(area, len(area.holders), area in taker.held) for area in taker.needs):
            return True  # it reaches its goal without the others
        after = _able(self._busy, self._behind, taker, takes)
        if taker in after:
            return True
        before = self._able_before()
        if taker not in before:  # it cannot leave what it would come into; if it is in the way, it goes on nevertheless
            return bool(taker.held) and all(traveller in after for traveller in before)
        if request is not None:
            request.cut_off = tuple((one, one.needs, tuple(one.held)) for one in self._busy if one not in after)
        return False

    def against(self, request: Request) -> Tuple[Traveller, ...]:
        """Return the robots of which one must go on before the robot of ``request`` may have its places; (): it may.

        They hold places, and would not be able. If all would be able, but not all could stay, these are all that hold
        places.
        """
        taker = request.traveller
        if self.allows_request(request):
            return ()
        after = _able(self._busy, self._behind, taker, request.areas)
        found = tuple(one for one in self._busy if one.held and one is not taker and one not in after)
        return found or tuple(one for one in self.travellers if one.held and one is not taker)

    def _able_before(self) -> Dict[Traveller, bool]:
        if self._before is None:
            self._before = _able(self._busy, self._behind)
        return self._before


def _before(traveller: Traveller) -> List[Traveller]:
    """Return the robots that come before ``traveller`` in the queues where it waits, or will ask on its way."""
    own = traveller.wants
    return [one.traveller for area in traveller.needs for one in area.queue
            if not one.traveller.is_careful and one.traveller is not traveller
            and (one < own if own in area.queue else one.traveller.priority >= traveller.priority)
            and not (area.group in traveller.held and area.group in one.areas)]


def _able(busy: Sequence[Traveller], behind: Dict[Traveller, List[Traveller]], wanted: Optional[Traveller] = None,
          takes: Tuple[Area, ...] = ()) -> Dict[Traveller, bool]:
    """Return {Traveller: True} of the ``busy`` robots that are able if ``wanted`` holds ``takes``, too.

    A robot gets no place before those ``behind`` which it is or will be in a queue ({Traveller: [Traveller, ...]}),
    even if one is free. The search ends when ``wanted`` is found to be able. Otherwise the result does not depend on
    the order of the search.
    """
    counts: Dict[Area, int] = {}  # the number of robots that hold a place and have not yet been found able
    for one in busy:
        for area in one.held:
            counts[area] = counts.get(area, 0) + 1
    for area in takes:
        counts[area] = counts.get(area, 0) + 1
    able: Dict[Traveller, bool] = {}
    stopped: Dict[Any, List[Traveller]] = {}  # robots by the first robot before them, or area without a place
    open_ = list(reversed(busy))
    while open_:
        one = open_.pop()
        held, taken = one.held, takes if one is wanted else ()
        by: Any = next((other for other in behind.get(one, ()) if other not in able), None)
        for area in one.needs if by is None else ():
            if area.capacity is not None and counts.get(area, 0) >= area.capacity + (area in held or area in taken):
                by = area
                break
        if by is not None:
            stopped.setdefault(by, []).append(one)
            continue
        able[one] = True
        open_ += stopped.pop(one, ())
        if one is wanted:
            break
        for area in one.held:
            counts[area] -= 1
            open_ += stopped.pop(area, ())
    return able


def _has_room(area: Area, count: int, is_in: bool) -> bool:
    return area.capacity is None or count - is_in < area.capacity
