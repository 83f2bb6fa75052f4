"""Robots that wait for each other in a circle, so that none of them can go on."""
from __future__ import annotations

from typing import TYPE_CHECKING, Dict, List, Optional, Tuple

if TYPE_CHECKING:
    from .area import Area, Request
    from .traveller import Traveller


def waiting_circle(request: Request) -> Optional[List[Tuple[Traveller, Area]]]:
    """Return a circle of waiting through ``request``, [(Traveller, Area), ...], or None.

    Each robot waits for the area beside it, in which the next robot holds a place or waits before it. The circle begins
    with the robot whose name comes first.

    A robot is stuck if one of the areas for which it asks is full of stuck robots only, or if a stuck robot comes
    before it there. The stuck robots are the largest set for which that is true. No robot is stuck because of a closed
    area, since that may be opened. Other robots may overtake a careful robot (``is_careful``), so none is stuck behind
    it.
    """
    if not request.traveller.held and all(area.queue[-1] is request for area in request.areas):
        return None  # no robot waits for this one
    stuck = _stuck(_connected(request))
    ring = _way_back(request.traveller, stuck) if request.traveller in stuck else None
    if ring is None:
        return None  # it waits for a circle of other robots
    first = min(range(len(ring)), key=lambda place: ring[place][0].rank)
    return ring[first:] + ring[:first]


def _way_back(traveller: Traveller, stuck: Dict[Traveller, bool]) -> Optional[List[Tuple[Traveller, Area]]]:
    """Return the shortest circle of waiting from ``traveller`` back to it, [(Traveller, Area), ...], or None."""
    came: Dict[Traveller, Tuple[Traveller, Area]] = {}
    open_ = [traveller]
    for one in open_:
        for area, other in _waits_for(one, stuck):
            if other not in came:
                came[other] = one, area
                open_.append(other)
    if traveller not in came:
        return None
    ring: List[Tuple[Traveller, Area]] = []
    one = traveller
    while not ring or one is not traveller:
        ring.append(came[one])
        one = came[one][0]
    return ring[::-1]


def _connected(request: Request) -> Dict[Traveller, bool]:
    """Return {Traveller: True} of all waiting robots for which ``request`` waits, directly or through other robots."""
    found: Dict[Traveller, bool] = {}
    open_ = [request.traveller]
    while open_:
        traveller = open_.pop()
        if traveller.request is not None and traveller not in found:
            found[traveller] = True
            for area in (*traveller.request.areas, *traveller.request.ahead):
                open_ += [*area.holders, *_before(area, traveller)]
    return found


def _before(area: Area, traveller: Traveller) -> List[Traveller]:
    queue = [request.traveller for request in area.queue]
    before = queue[:queue.index(traveller)] if traveller in queue else []  # for room ahead a robot is in no queue
    return [one for one in before if not one.is_careful and one.request is not None
            and not area.is_overtaken(one.request, traveller)]


def _stuck(candidates: Dict[Traveller, bool]) -> Dict[Traveller, bool]:
    """Return {Traveller: True} of the ``candidates`` that wait only for one another."""
    while True:
        left = {one: True for one in candidates if _waits_for(one, candidates)}
        if len(left) == len(candidates):
            return left
        candidates = left


def _waits_for(traveller: Traveller, stuck: Dict[Traveller, bool]) -> List[Tuple[Area, Traveller]]:
    """Return [(area, Traveller), ...]: the areas in which ``traveller`` is stuck, and the robots for which it waits."""
    found: List[Tuple[Area, Traveller]] = []
    request = traveller.request
    for area in (*request.areas, *request.ahead) if request is not None else ():
        if not area.is_closed:
            if area.is_full() and all(one in stuck for one in area.holders):
                found += [(area, one) for one in sorted(area.holders, key=lambda one: one.rank)]
            found += [(area, one) for one in _before(area, traveller) if one in stuck]
    return found
