"""Zones and lanes as traffic sees them: the number of their places, and the robots that hold one or wait for one."""
from __future__ import annotations

import math
from bisect import insort
from typing import TYPE_CHECKING, Any, Dict, List, NamedTuple, Optional, Tuple

from ..maps.lane_map import NEAR

if TYPE_CHECKING:
    from .outline import Outline
    from .traveller import Traveller

Point = Tuple[float, float]


class AreaState(NamedTuple):
    """The state of an area of the ``kind`` 'zone', 'lane', 'node' or 'group'.

    ``robots`` hold a place, in the order of their indices. ``waiting`` wait for one, in the order of the queue.
    ``capacity``: the number of places, None: any number.
    """

    kind: str
    name: str
    capacity: Optional[int]
    closed: bool
    robots: Tuple[str, ...]
    waiting: Tuple[str, ...]


class Area:
    """A zone with its ``outline`` (Outline), or a lane, a node at ``point`` (x, y) [m] with its ``spots``, or a group.

    Its ``name`` contains the kind, for example 'zone gate' or 'lane depot - gate'. A robot that is in the area holds a
    place there; ``capacity`` is the number of places, None: any number.
    """

    def __init__(self, kind: str, name: str, capacity: Optional[int] = None, outline: Optional[Outline] = None,
                 group: Optional[Area] = None, point: Optional[Point] = None,
                 spots: Tuple[Point, ...] = ()) -> None:
        self.name = '{} {}'.format(kind, name)
        self._kind_and_name = kind, name
        self.capacity = capacity
        self.outline = outline
        self.point = point
        self._spots = spots
        self._standing: Dict[Traveller, int] = {}  # the numbers of the spots of robots that hold a place
        #: the area of its group, in which a robot in this area holds a place, too
        self.group = group
        self._members: List[Area] = []  # the areas of this group that have an outline
        if group is not None and outline is not None:
            group._members.append(self)
        self.is_closed = False
        self.is_told = False  # whether its capacity has been reported
        self.queue: List[Request] = []  # in their order
        self.watchers: List[Request] = []  # requests that others overtake while there is no room here
        self.holders: Dict[Traveller, bool] = {}  # in the order in which they came

    def has_room(self) -> bool:
        """Return whether one more robot may come in."""
        return not self.is_closed and not self.is_full()

    def is_full(self) -> bool:
        """Return whether all places are taken (or even more robots than that are inside)."""
        return self.capacity is not None and len(self.holders) >= self.capacity

    def first(self, traveller: Optional[Traveller] = None) -> Optional[Request]:
        """Return the first request, or the first one for which ``traveller`` has to wait; that may be its own.

        Requests of robots that go on only if that is safe (``is_careful``) do not count. For ``traveller``, neither do
        other robots' requests that lack room ahead or at the node behind the lane. If ``traveller`` holds a place in
        the group of this area, other robots' requests for a place in the group do not count either.
        """
        return next((request for request in self.queue if not request.traveller.is_careful and (
            traveller is None or not self.is_overtaken(request, traveller))), None)

    def is_overtaken(self, request: Request, traveller: Traveller) -> bool:
        """Return whether ``traveller`` need not wait for ``request``, which is another robot's request here."""
        return request.traveller is not traveller and (not all(area.has_room() for area in request.lets_pass) or (
            self.group is not None and self.group in traveller.held and self.group in request.areas))

    def before(self, request: Request) -> List[Request]:
        """Return the requests in the queue for which ``request`` has to wait; see :meth:`first`."""
        return [one for one in self.queue[:self.queue.index(request)] if not one.traveller.is_careful
                and not self.is_overtaken(one, request.traveller)]

    def may_be_next(self) -> List[Request]:
        """Return the requests that may be served next: the first one and, if others may overtake it, those too."""
        first = self.first()
        if first is None or (self.group is None and not first.lets_pass):
            return [] if first is None else [first]
        return [request for request in self.queue if not request.traveller.is_careful]

    def contains(self, x: float, y: float) -> bool:
        """Return whether a robot at (x, y) [m] is in this zone, at this node, or in a zone of this group."""
        if self.point is not None:
            return math.dist(self.point, (x, y)) <= NEAR or self.is_spot((x, y))
        if self.outline is not None:
            return self.outline.contains(x, y)
        return any(area.contains(x, y) for area in self._members)

    def is_spot(self, point: Point) -> bool:
        """Return whether one of the spots of this node is at ``point`` (x, y) [m]."""
        return any(math.dist(spot, point) <= NEAR for spot in self._spots)

    def spot(self, traveller: Traveller, wished: Point) -> Optional[Point]:
        """Return the spot (x, y) [m] for ``traveller``, or None if this is no node with spots, or none is free.

        A robot that holds a place keeps its spot: the one at ``wished`` if that is free, otherwise the first one that
        is left for it by robots that hold a place, too, and come first by name. Another robot has no spot of its own
        yet, and gets to know which one it would get.
        """
        self._standing = {one: number for one, number in self._standing.items() if one in self.holders}
        number = self._standing.get(traveller)
        if number is None:
            taken = self._standing.values()
            free = [number for number in range(len(self._spots)) if number not in taken]
            is_holder = traveller in self.holders
            before = sum(one not in self._standing and not (is_holder and one.rank >= traveller.rank)
                         for one in self.holders)
            number = next((one for one in free if math.dist(self._spots[one], wished) <= NEAR), None)
            if number is None:
                if before >= len(free):
                    return None
                number = free[before]
            if is_holder:
                self._standing[traveller] = number
        return self._spots[number]

    def forget_spot(self, traveller: Traveller) -> None:
        """Let another robot have the spot of ``traveller``."""
        self._standing.pop(traveller, None)

    def load(self, traveller: Traveller) -> float:
        """Return the number of other robots that hold a place or wait before ``traveller``, divided by the places.

        If there is place for any number of robots, the result is 0.
        """
        if self.capacity is None:
            return 0.0
        own = traveller.request
        waiting = 0 if traveller in self.holders else sum(own is None or one < own for one in self.queue)
        return (len(self.holders) - (traveller in self.holders) + waiting) / self.capacity

    def state(self) -> AreaState:
        """Return the AreaState."""
        robots = sorted(self.holders, key=lambda one: one.index)
        return AreaState(*self._kind_and_name, self.capacity, self.is_closed, tuple(one.name for one in robots),
                         tuple(request.traveller.name for request in self.queue))


class Request:
    """The request of ``traveller`` for a place in each of ``areas``, since ``since_ns`` [ns].

    The areas ``ahead`` must have room, too, but the robot gets no place in them. While there is no room in one of
    ``lets_pass``, the areas ahead and nodes, other robots need not wait for this one. The request is in no queue before
    :meth:`line_up`.
    """

    __slots__ = ('key', 'traveller', 'areas', 'ahead', 'lets_pass', 'is_lined_up', 'is_in_circle', 'cut_off',
                 '_since_ns')

    def __init__(self, since_ns: int, traveller: Traveller, areas: Tuple[Area, ...],
                 ahead: Tuple[Area, ...] = ()) -> None:
        self.key = -traveller.priority, since_ns, traveller.rank
        self._since_ns = since_ns
        self.traveller: Traveller = traveller
        self.areas: Tuple[Area, ...] = areas
        self.ahead: Tuple[Area, ...] = ahead
        self.lets_pass: Tuple[Area, ...] = (*ahead, *(area for area in areas if area.point is not None))
        self.is_lined_up = False
        self.is_in_circle = False  # whether it is in a circle of waiting that has been reported
        self.cut_off: Tuple[Any, ...] = ()  # robots that could not reach their goals any more, see SafeStates

    def __lt__(self, other: Request) -> bool:
        """Return whether this request comes first: by priority (higher first), then by age, then by name."""
        return self.key < other.key

    @property
    def reason(self) -> str:
        """The reason for which the robot is held: the names of the areas."""
        return ', '.join(area.name for area in (*self.areas, *self.ahead))

    def has_room(self) -> bool:
        """Return whether all areas have room, including those ahead."""
        return all(area.has_room() for area in self.areas) and all(area.has_room() for area in self.ahead)

    def is_first(self) -> bool:
        """Return whether all areas have room and no other request comes before this one."""
        firsts = [area.first(self.traveller) for area in self.areas]
        return all(one is None or not one < self for one in firsts) and self.has_room()

    def goes_on_alone(self) -> bool:
        """Return whether a robot that drives may go on if no other one asks: nobody waits, and all areas have room."""
        return self.traveller.asked is self and self.has_room() and not any(area.queue for area in self.areas)

    def line_up(self) -> None:
        """Enter the queues, or take another place there, by the present priority of the robot."""
        self.withdraw()
        self.is_lined_up = True
        self.key = -self.traveller.priority, self._since_ns, self.traveller.rank
        for area in self.areas:
            insort(area.queue, self)
        for area in self.lets_pass:
            area.watchers.append(self)

    def withdraw(self) -> None:
        """Leave the queues."""
        if self.is_lined_up:
            self.is_lined_up = False
            for area in self.areas:
                area.queue.remove(self)
            for area in self.lets_pass:
                area.watchers.remove(self)
