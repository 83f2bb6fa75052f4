"""Robots that wait for each other in a circle, so that none of them can go on."""
from __future__ import annotations

from typing import TYPE_CHECKING, Dict, List, Optional, Tuple

if TYPE_CHECKING:
    from .area import Area, Request
    from .traveller import Traveller


def waiting_circle(request: Request) -> Optional[List[Tuple[Traveller, Area]]]:
    """Return a circle of waiting through ``request``, [(Traveller, Area), ...], or None.

    Each robot of it waits for the area beside it, in which the next robot holds a place; it begins with the first
    name. A robot is stuck if one of the areas that it asks for is full of stuck robots only, or if a stuck one comes
    before it there: the largest set of which that is so. An area that is closed may be opened: nobody is stuck for it.
    Who goes on where that is safe only is overtaken, so that nobody waits for it who comes behind it.
    """
    if not request.traveller.held and all(area.queue[-1] is request for area in request.areas):
        return None  # nobody waits for it
    stuck = _stuck(_connected(request))
    ring = _way_back(request.traveller, stuck) if request.traveller in stuck else None
    if ring is None:
        return None  # it waits for a circle of others
    first = min(range(len(ring)), key=lambda place: ring[place][0].rank)
    return ring[first:] + ring[:first]


def _way_back(traveller: Traveller, stuck: Dict[Traveller, bool]) -> Optional[List[Tuple[Traveller, Area]]]:
    """Return the shortest circle of waiting from ``traveller`` to it, [(Traveller, Area), ...], or None."""
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
    """Return all who wait, {Traveller: True}, that can be reached from ``request`` by waiting for one another."""
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
    before = queue[:queue.index(traveller)] if traveller in queue else []  # who only wants room ahead is in none
    return [one for one in before if not one.is_careful and one.request is not None
            and not area.asks_for_what_is_held(one.request, traveller)]


def _stuck(candidates: Dict[Traveller, bool]) -> Dict[Traveller, bool]:
    """Return those of ``candidates`` that wait for candidates only, {Traveller: True}."""
    while True:
        left = {one: True for one in candidates if _waits_for(one, candidates)}
        if len(left) == len(candidates):
            return left
        candidates = left


def _waits_for(traveller: Traveller, stuck: Dict[Traveller, bool]) -> List[Tuple[Area, Traveller]]:
    """Return [(area, Traveller), ...]: by which areas ``traveller`` is stuck, and for whom it waits there."""
    found: List[Tuple[Area, Traveller]] = []
    request = traveller.request
    for area in (*request.areas, *request.ahead) if request is not None else ():
        if not area.is_closed:
            if area.is_full() and all(one in stuck for one in area.holders):
                found += [(area, one) for one in sorted(area.holders, key=lambda one: one.rank)]
            found += [(area, one) for one in _before(area, traveller) if one in stuck]
    return found
