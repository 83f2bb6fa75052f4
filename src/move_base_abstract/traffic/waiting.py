"""The graph of waiting: for each robot that waits for a place, the reasons, and the robots that can end them.

A robot waits because an area is closed; because it is full; because other robots come before it in a queue; or because
it is careful (:mod:`.safe_states`), and some robots could not reach their goals any more. The first reason is an
external cause: somebody may open the area. The others are edges of the graph. They lead to robots that wait, too, or
to an external cause: a robot that drives, stands without a goal, or is held for anything else may go on by itself.

A robot is *stuck* if one of its reasons can be ended by stuck robots only. The stuck robots are the largest set for
which that is true. All that asks who waits for whom asks this graph.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Callable, Dict, Iterable, Iterator, List, NamedTuple, Optional, Tuple

if TYPE_CHECKING:
    from .area import Area, Request
    from .traveller import Traveller

    #: returns the robots that keep a careful robot out of a place that is free
    Against = Callable[[Request], Tuple[Traveller, ...]]


class Reason(NamedTuple):
    """A reason for which a robot does not get a place in ``area``, or one behind that.

    It ends when so many of ``robots`` as are ``needed`` go on. 0: the area is closed, so no robot ends it.
    """

    area: Area
    robots: Tuple[Traveller, ...]
    needed: int = 1
    is_unsafe: bool = False

    def binds(self, stuck: Dict[Traveller, bool]) -> bool:
        """Return whether this lasts for ever if the ``stuck`` robots never go on, and all others do."""
        return sum(one not in stuck for one in self.robots) < self.needed


def in_words(reasons: Iterable[Reason]) -> str:
    """Return for which areas a robot waits, and which robots are why, in words; '': for none."""
    robots: Dict[str, Dict[str, bool]] = {}
    for reason in reasons:
        robots.setdefault(reason.area.name, {}).update(dict.fromkeys(map(_who, reason.robots), True))
    return '; '.join('{} because of {}'.format(area, ', '.join(names)) if names else '{}, which is closed'.format(area)
                     for area, names in robots.items())


def _who(one: Traveller) -> str:
    held_for, name = ', '.join(one.navigator.travel.held_for), one.navigator.robot.name
    if one.request is not None:
        return '{} (waits, too)'.format(name)
    if held_for:
        return '{} (held for {})'.format(name, held_for)
    return '{} ({})'.format(name, 'on its way' if one.navigator.is_active else 'has no goal')


def reasons_of(request: Request, against: Against) -> Iterator[Reason]:
    """Yield the reasons of ``request``, none if it can be granted; ``against``: see :meth:`.Traffic.against`."""
    is_free = True
    for area in (*request.areas, *request.ahead):
        if not area.has_room():
            is_free = False
            holders = tuple(sorted(area.holders, key=lambda one: one.rank))
            yield Reason(area, (), 0) if area.is_closed else Reason(
                area, holders, len(holders) - (area.capacity or 0) + 1)
    for area in request.areas:
        for one in area.before(request):
            is_free = False
            yield Reason(area, (one.traveller,))
    if is_free and request.traveller.is_careful:
        robots = against(request)
        if robots:
            yield Reason(request.areas[0], robots, is_unsafe=True)


class WaitingGraph:
    """The present graph of waiting, from ``requests`` on: {Traveller: [Reason, ...]}, and the robots that are stuck.

    ``against``: see :meth:`.Traffic.against`.
    """

    def __init__(self, requests: Iterable[Request], against: Against) -> None:
        self.reasons: Dict[Traveller, List[Reason]] = {}
        open_: List[Optional[Request]] = list(requests)
        while open_:
            request = open_.pop()
            if request is not None and request.traveller not in self.reasons:
                found = self.reasons[request.traveller] = list(reasons_of(request, against))
                open_ += [one.request for reason in found for one in reason.robots]
        #: {Traveller: True} of the robots that are stuck
        self.stuck = dict.fromkeys(self.reasons, True)
        while True:
            left = {one: True for one in self.stuck if any(reason.binds(self.stuck) for reason in self.reasons[one])}
            if len(left) == len(self.stuck):
                break
            self.stuck = left

    def circle(self, traveller: Traveller) -> Optional[List[Tuple[Traveller, Reason]]]:
        """Return the shortest circle of stuck robots through ``traveller``, [(Traveller, Reason), ...], or None.

        Each robot waits for the reason beside it, which the next robot could end. The circle begins with the robot
        whose name comes first.
        """
        ring = self._way_back(traveller) if traveller in self.stuck else None
        if ring is None:
            return None  # it waits for a circle of other robots, or for nothing that lasts
        first = min(range(len(ring)), key=lambda place: ring[place][0].rank)
        return ring[first:] + ring[:first]

    def _way_back(self, traveller: Traveller) -> Optional[List[Tuple[Traveller, Reason]]]:
        came: Dict[Traveller, Tuple[Traveller, Reason]] = {}
        open_ = [traveller]
        for one in open_:
            for reason in self.reasons[one]:
                for other in reason.robots if reason.binds(self.stuck) else ():
                    if other in self.stuck and other not in came:
                        came[other] = one, reason
                        open_.append(other)
        if traveller not in came:
            return None
        ring: List[Tuple[Traveller, Reason]] = []
        one = traveller
        while not ring or one is not traveller:
            ring.append(came[one])
            one = came[one][0]
        return ring[::-1]
