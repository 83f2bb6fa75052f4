"""Whether a place may be given away so that nobody is cut off from its goal: no circle of waiting comes to be.

Each robot knows its way, so the areas that it has yet to come into before it holds no place any more: at its goal, or
where no area is. A robot is *able* to come there if there is place for it in all of these, or would be when others who
are able have come to theirs (Dijkstra's banker; of robots, Reveliotis, "Real-time management of resource allocation
systems", 2005). A place is given only if all who were able still are. While all are able there is always one that may
go on: the first one that comes to its goal alone.
"""
from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING, Dict, Iterable, List, Optional, Sequence, Tuple

if TYPE_CHECKING:
    from .area import Area, Request
    from .control import Traveller
    from .way import Crossing


class DeadlockPolicy(Enum):
    """What becomes of a circle of waiting: nothing, the goal of who closed it is aborted, or none comes to be."""

    WAIT = 'wait'
    ABORT = 'abort'
    AVOID = 'avoid'


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
    if all(_has_room(area, len(area.holders), area in taker.held) for area in taker.needs):
        return True  # it comes to its goal alone, and then there is no less place than before
    busy = [traveller for traveller in travellers if traveller.needs]
    after = _able(busy, taker, takes)
    return all(traveller in after for traveller in _able(busy))


def first_to_go_on(travellers: Iterable[Traveller]) -> Optional[Request]:
    """Return the first request, in the order in which they asked, of those who may have the places they wait for."""
    waiting = sorted(one.request for one in travellers if one.request is not None)
    return next((request for request in waiting if all(area.has_room() for area in request.areas)
                 and is_safe(travellers, request.traveller, request.areas)), None)


def _able(busy: Sequence[Traveller], taker: Optional[Traveller] = None,
          takes: Tuple[Area, ...] = ()) -> Dict[Traveller, bool]:
    """Return {Traveller: True} of those who are able; which of them is looked at first changes nothing."""
    holds = {one: {**one.held, **dict.fromkeys(takes if one is taker else (), True)} for one in busy}
    counts: Dict[Area, int] = {}  # who holds a place and has not come to its goal
    for held in holds.values():
        for area in held:
            counts[area] = counts.get(area, 0) + 1
    able: Dict[Traveller, bool] = {}
    left: List[Traveller] = list(busy)
    while True:
        waiting: List[Traveller] = []
        for one in left:
            held = holds[one]
            if all(_has_room(area, counts.get(area, 0), area in held) for area in one.needs):
                able[one] = True
                for area in held:
                    counts[area] -= 1
            else:
                waiting.append(one)
        if len(waiting) == len(left):
            return able
        left = waiting


def _has_room(area: Area, count: int, is_in: bool) -> bool:
    return area.capacity is None or count - is_in < area.capacity
