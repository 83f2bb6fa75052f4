"""Which properties are broken by the rows of robots in an event log: those of goals, places and batteries."""
from __future__ import annotations

import json
from typing import Any, Callable, Dict, Iterator, List, Set, Tuple

from ..runs.event_log import Event

_EMPTY = 'empty'  # in a row ``battery``
Found = Tuple[str, int, str, str, Tuple[str, ...]]  # the fields of Broken


class Robots:
    """Takes the events of a log in their order. ``broken``: the properties that they have broken so far."""

    def __init__(self) -> None:
        self.broken: List[Found] = []
        self._goals: Dict[str, int] = {}  # {robot: instant at which it departed to a goal that has not ended}
        self._tasks: Dict[Tuple[str, str], int] = {}  # {(robot, goal id): instant since which the task exists}
        self._room: Dict[str, int] = {}  # {area: number of robots that have room}
        self._inside: Dict[str, List[str]] = {}  # {area: robots in it}
        self._working: Dict[str, List[Tuple[str, str]]] = {}  # {place: (robot, goal id) of the tasks there}
        self._charging: Set[str] = set()
        self._circles: List[Tuple[int, str, List[str]]] = []  # (instant, robot that closed it, [robot, area, ...])
        self._takers: Dict[str, Callable[[Event, Any], None]] = {
            'departed': self._departed, 'ended': self._ended, 'waiting_began': self._task, 'task_began': self._task,
            'works_at': self._works_at, 'task_ended': self._task_ended,
            'places': self._places, 'entered': self._entered, 'left': self._left,
            'charging_began': self._charge, 'charging_ended': self._charge, 'battery': self._battery,
            'deadlock': self._deadlock}

    def take(self, event: Event) -> None:
        """Take the next event. Rows of users' nodes that have the name of one of these kinds are ignored."""
        taker = self._takers.get(event.kind)
        if taker is not None:
            try:
                taker(event, json.loads(event.values))
            except (LookupError, TypeError, ValueError):
                pass

    def left_open(self, is_quiet: bool) -> Iterator[Found]:
        """Yield the properties that the end of the run breaks; ``is_quiet``: nothing more could have happened."""
        for since_ns, robot, circle in self._circles:
            pairs = ', '.join('{} for {}'.format(*pair) for pair in zip(circle[::2], circle[1::2]))
            yield 'no_standstill', since_ns, robot, 'robots wait for each other, to the end of the run', (pairs,)
        if is_quiet:
            for robot, since_ns in self._goals.items():
                yield 'every_goal_ends', since_ns, robot, 'the goal to which it departed then never ends', ()
            for (robot, goal_id), since_ns in self._tasks.items():
                yield 'every_goal_ends', since_ns, robot, 'the task that it got then never ends', (goal_id,)

    def _departed(self, event: Event, _values: Any) -> None:
        self._goals.setdefault(event.robot, event.time_ns)

    def _ended(self, event: Event, _values: Any) -> None:
        self._goals.pop(event.robot, None)
        self._circles = [one for one in self._circles if event.robot not in one[2][::2]]

    def _task(self, event: Event, values: Any) -> None:
        self._tasks.setdefault((event.robot, values[0]), event.time_ns)

    def _task_ended(self, event: Event, values: Any) -> None:
        self._tasks.pop((event.robot, values[0]), None)
        for working in self._working.values():
            working[:] = [one for one in working if one != (event.robot, values[0])]

    def _works_at(self, event: Event, values: Any) -> None:
        goal_id, place, room = values
        working = self._working.setdefault(place, [])
        working.append((event.robot, goal_id))
        if len(working) == room + 1:
            self.broken.append(('capacities_kept', event.time_ns, event.robot,
                                'it works at {}, which has room for {}'.format(place, room),
                                tuple(robot for robot, _ in working)))

    def _places(self, _event: Event, values: Any) -> None:
        area, room = values
        self._room[area] = int(room)

    def _entered(self, event: Event, values: Any) -> None:
        inside = self._inside.setdefault(values[0], [])
        inside.append(event.robot)
        room = self._room.get(values[0])
        if room is not None and len(inside) == room + 1:
            self.broken.append(('capacities_kept', event.time_ns, event.robot,
                                'it came into {}, which has room for {}'.format(values[0], room), tuple(inside)))

    def _left(self, event: Event, values: Any) -> None:
        inside = self._inside.get(values[0], [])
        if event.robot in inside:
            inside.remove(event.robot)
        self._circles = [one for one in self._circles if event.robot not in one[2][::2]]

    def _charge(self, event: Event, _values: Any) -> None:
        (self._charging.add if event.kind == 'charging_began' else self._charging.discard)(event.robot)

    def _battery(self, event: Event, values: Any) -> None:
        if values[-1] == _EMPTY and event.robot not in self._charging:
            self.broken.append(('charged', event.time_ns, event.robot, 'its battery is empty', ()))

    def _deadlock(self, event: Event, values: Any) -> None:
        self._circles.append((event.time_ns, event.robot, values))
