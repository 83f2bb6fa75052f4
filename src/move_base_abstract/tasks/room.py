"""Limited room at a place: which robots work, which wait, which are refused, and which must give way."""
from __future__ import annotations

import bisect
import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional, Tuple

if TYPE_CHECKING:
    from ..engine.event_queue import EventQueue
    from ..engine.simulation import Simulation
    from .arrivals import Task

from ..common.ros_names import natural_order
from .places import Place

#: a function that takes an instant [ns]
Admission = Callable[[int], object]


@dataclass
class Guest:
    """A robot that asks for room: its priority, and functions that tell it the answer.

    ``begin(due_ns)`` is called if there is room, ``wait(due_ns)`` if there is none yet, and ``refuse(waiting)`` if no
    more robots than the ``waiting`` ones may wait. All of these are called at the end of the instant.
    ``give_way(due_ns)`` is called if the robot works and must make room for a more urgent one. ``due_ns`` is the
    instant [ns].
    """

    robot_index: int
    robot_name: str
    begin: Admission
    wait: Admission
    refuse: Callable[[int], object] = lambda waiting: None
    give_way: Admission = lambda due_ns: None
    priority: int = 0
    since_ns: int = 0
    ticket: int = 0
    is_settled: bool = False  # it has been told to wait, so it is not refused any more

    @property
    def key(self) -> Tuple[Any, ...]:
        """The order of robots: by priority (higher first), then by arrival, then by name; as in zones and on lanes."""
        return -self.priority, self.since_ns, natural_order(self.robot_name), self.ticket


class Room:
    """Decides which robots work at a :class:`.Place` that has a capacity, and which wait, in the order of Guest.key.

    If the place has ``preemption``, a guest with a higher priority takes the room of the one that comes last of all
    that work. That one waits again, as if it came now, even if the queue is full. The place's ``queue`` is the number
    of newcomers that may wait.
    """

    def __init__(self, queue: EventQueue, place: Place) -> None:
        assert place.capacity is not None
        self.capacity: int = place.capacity
        self._most_waiting = place.queue
        self._preempts = place.preemption
        self._queue = queue
        self._numbers = itertools.count()
        self._waiting: List[Guest] = []
        self._working: Dict[int, Guest] = {}  # by ticket, in the order in which they began
        self._is_due = False
        self._followers: List[Callable[[], object]] = []

    @property
    def workers(self) -> Tuple[str, ...]:
        """The names of the robots that work, in the order in which they began."""
        return tuple(guest.robot_name for guest in self._working.values())

    @property
    def waiters(self) -> Tuple[str, ...]:
        """The names of the robots that wait, in the order in which they will begin."""
        return tuple(guest.robot_name for guest in self._waiting)

    def follow(self, changed: Callable[[], object]) -> None:
        """Call ``changed()`` whenever other robots work or wait."""
        self._followers.append(changed)

    def ask(self, guest: Guest, now_ns: int) -> int:
        """Ask for room for ``guest``; return a ticket. The guest gets its answer at the end of the instant."""
        guest.ticket, guest.since_ns, guest.is_settled = next(self._numbers), now_ns, False
        self._line_up(guest)
        self._look(now_ns)
        return guest.ticket

    def give_back(self, ticket: int, now_ns: int) -> None:
        """Note that the robot with ``ticket`` no longer waits or works."""
        self._working.pop(ticket, None)
        self._waiting = [guest for guest in self._waiting if guest.ticket != ticket]
        self._look(now_ns)
        self._changed()

    def _line_up(self, guest: Guest) -> None:
        keys = [one.key for one in self._waiting]
        self._waiting.insert(bisect.bisect_right(keys, guest.key), guest)

    def _look(self, now_ns: int) -> None:
        if self._waiting and not self._is_due:
            self._is_due = True
            self._queue.decide(now_ns, self._admit)

    def _admit(self, due_ns: int, _now_ns: int) -> None:
        self._is_due = False
        while self._waiting and (len(self._working) < self.capacity or self._make_way(due_ns)):
            guest = self._waiting.pop(0)
            self._working[guest.ticket] = guest
            guest.begin(due_ns)
        self._refuse()
        for guest in self._waiting:
            if not guest.is_settled:
                guest.is_settled = True
                guest.wait(due_ns)
        self._changed()

    def _make_way(self, due_ns: int) -> bool:
        """Interrupt the last robot that works if the first one that waits is more urgent; return whether it was."""
        if not self._preempts:
            return False
        last = max(self._working.values(), key=lambda one: one.key)
        if last.priority >= self._waiting[0].priority:
            return False
        del self._working[last.ticket]
        last.since_ns, last.is_settled = due_ns, True
        self._line_up(last)
        last.give_way(due_ns)
        return True

    def _refuse(self) -> None:
        if self._most_waiting is None:
            return
        newcomers = [guest for guest in self._waiting if not guest.is_settled]
        stay = max(0, self._most_waiting - (len(self._waiting) - len(newcomers)))
        for guest in newcomers[stay:]:
            self._waiting.remove(guest)
            guest.refuse(self._most_waiting)

    def _changed(self) -> None:
        for changed in self._followers:
            changed()


class Rooms:
    """The places ({name: Place}) of a world, and the :class:`Room` at each of them.

    ``seconds``: the distribution of the durations [s] of tasks where neither they nor their place has one; None: such
    tasks cannot be done.
    """

    def __init__(self, simulation: Simulation, places: Dict[str, Place], seconds: Any = None) -> None:
        self.simulation = simulation
        self.places = places
        self._seconds = seconds
        self._rooms = {name: Room(simulation.queue, place) for name, place in places.items()
                       if place.capacity is not None}

    def of(self, place: str) -> Optional[Room]:
        """Return the :class:`Room` at the place of this name, or None if any number of robots may work there."""
        return self._rooms.get(place)

    def place_of(self, task: Task) -> Place:
        """Return the Place of a Task; if the task names none, a place at its pose."""
        return self.places[task.place] if task.place else Place('its place', task.pose)

    def seconds_of(self, task: Task) -> Any:
        """Return the distribution of the duration [s] of a Task that says none; None: its place has none either."""
        return self.place_of(task).work.seconds or self._seconds
