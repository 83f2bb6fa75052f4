"""Zones and lanes as traffic sees them: how many robots they hold, which ones, and who waits for a place."""
from __future__ import annotations

from bisect import insort
from typing import TYPE_CHECKING, Any, Dict, List, NamedTuple, Optional, Tuple

if TYPE_CHECKING:
    from .outline import Outline
    from .traveller import Traveller


class AreaState(NamedTuple):
    """A ``kind`` 'zone' or 'lane': robots that hold a place, and robots that wait for one, first come first."""

    kind: str
    name: str
    capacity: Optional[int]
    closed: bool
    robots: Tuple[str, ...]
    waiting: Tuple[str, ...]


class Area:
    """A zone with its ``outline`` (Outline), or a lane without; its ``name`` is as 'zone gate', 'lane depot - gate'."""

    def __init__(self, kind: str, name: str, capacity: Optional[int] = None, outline: Optional[Outline] = None,
                 group: Optional[Area] = None) -> None:
        self.name = '{} {}'.format(kind, name)
        self._kind_and_name = kind, name
        self.capacity = capacity
        self.outline = outline
        #: the area of its group, in which who is here has a place, too
        self.group = group
        self._members: List[Area] = []  # of this group, those with an outline
        if group is not None and outline is not None:
            group._members.append(self)
        self.is_closed = False
        self.is_told = False  # for how many it has room
        self._state: Optional[AreaState] = None
        self.queue: List[Request] = []  # in their order
        self.watchers: List[Request] = []  # who asks for a place before this one, and goes on only if there is one here
        self.holders: Dict[Traveller, bool] = {}  # in the order in which they came

    def has_room(self) -> bool:
        """Return whether one more may come in."""
        return not self.is_closed and not self.is_full()

    def is_full(self) -> bool:
        """Return whether as many as there is place for, or more, hold one."""
        return self.capacity is not None and len(self.holders) >= self.capacity

    def first(self, traveller: Optional[Traveller] = None) -> Optional[Request]:
        """Return the first request that ``traveller``, None: nobody in particular, has to wait for, also its own.

        Who goes on where that is safe only has no turn. Who holds a place in the group waits for nobody that still asks
        for one there.
        """
        return next((request for request in self.queue if not request.traveller.is_careful and (
            traveller is None or not self.asks_for_what_is_held(request, traveller))), None)

    def asks_for_what_is_held(self, request: Request, traveller: Traveller) -> bool:
        """Return whether a request here is also for a place in the group, in which ``traveller`` has one."""
        return self.group is not None and self.group in traveller.held and self.group in request.areas

    def first_within(self) -> Optional[Request]:
        """Return the first request of who is in the group already, or None."""
        return None if self.group is None else next((
            request for request in self.queue if not request.traveller.is_careful and self.group not in request.areas),
            None)

    def contains(self, x: float, y: float) -> bool:
        """Return whether who stands at (x, y) [m] has a place here: in this zone, or in a zone of this group."""
        if self.outline is not None:
            return self.outline.contains(x, y)
        return any(area.contains(x, y) for area in self._members)

    def load(self, traveller: Traveller) -> float:
        """Return how many robots for each place hold one, or wait for one before ``traveller``; 0: any number."""
        if self.capacity is None:
            return 0.0
        own = traveller.request
        waiting = 0 if traveller in self.holders else sum(own is None or one < own for one in self.queue)
        return (len(self.holders) - (traveller in self.holders) + waiting) / self.capacity

    def changed(self) -> None:
        """Its state is another now."""
        self._state = None

    def state(self) -> AreaState:
        """Return the AreaState. What has not changed is not made anew."""
        if self._state is None:
            robots = sorted(self.holders, key=lambda one: one.index)
            self._state = AreaState(*self._kind_and_name, self.capacity, self.is_closed,
                                    tuple(one.name for one in robots),
                                    tuple(request.traveller.name for request in self.queue))
        return self._state


class Request:
    """``traveller`` asks for a place in each of ``areas`` since ``since_ns`` [ns]; ``ahead`` must have room, too."""

    __slots__ = ('key', 'traveller', 'areas', 'ahead', 'is_in_circle', 'cut_off')

    def __init__(self, since_ns: int, traveller: Traveller, areas: Tuple[Area, ...],
                 ahead: Tuple[Area, ...] = ()) -> None:
        self.key = -traveller.priority, since_ns, traveller.rank
        self.traveller: Traveller = traveller
        self.areas: Tuple[Area, ...] = areas
        self.ahead: Tuple[Area, ...] = ahead
        self.is_in_circle = False  # as far as has been told
        self.cut_off: Tuple[Any, ...] = ()  # with deadlock: avoid, who would not come to its goal any more
        for area in areas:
            insort(area.queue, self)
        for area in ahead:
            area.watchers.append(self)

    def __lt__(self, other: Request) -> bool:
        """Return whether this one comes first: a higher priority, who asked first, by name."""
        return self.key < other.key

    @property
    def reason(self) -> str:
        """For what the robot is held."""
        return ', '.join(area.name for area in (*self.areas, *self.ahead))

    def has_room(self) -> bool:
        """Return whether there is a place in all areas."""
        return all(area.has_room() for area in self.areas) and all(area.has_room() for area in self.ahead)

    def is_first(self) -> bool:
        """Return whether there is a place in all the areas, and nobody comes before."""
        firsts = [area.first(self.traveller) for area in self.areas]
        return all(one is None or not one < self for one in firsts) and self.has_room()

    def renewed(self) -> Request:
        """Return the request that takes the place of this one, by the priority that its robot has now."""
        self.withdraw()
        request = Request(self.key[1], self.traveller, self.areas, self.ahead)
        request.is_in_circle = self.is_in_circle
        return request

    def withdraw(self) -> None:
        """Leave the queues."""
        for area in self.areas:
            area.queue.remove(self)
        for area in self.ahead:
            area.watchers.remove(self)
