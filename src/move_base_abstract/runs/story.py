"""The story of a run: what each robot did and where it waited, from the rows of an event log or of a trace.

A :class:`Story` takes each row once. All that tells what robots did asks it: reports, metrics, properties, replays. A
log without rows `goal` is of an earlier release or of another simulator. In such a log a goal begins when the robot
departs for it.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Container, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from .orders_of_run import FAILED, ORDER_ROWS, Orders
from .robot_story import Robot, Span
from .states import NAMES, STATES, Cause

#: the name of the place in :attr:`Story.waits` for waits for a charger
CHARGERS = 'chargers'
PLACE = 'place '  # before the names of places in Stay.where
#: what a robot does during a Stay: it is in a zone or on a lane, works at a place, is charged, or waits
INSIDE, WORKS, CHARGES, WAITS = 'inside', 'works', 'charges', 'waits'
REACHED = 'SUCCEEDED'
#: the endings of goals and tasks that count as failures
MISSED = ('ABORTED', 'REJECTED', 'LOST')
_S = 1e9  # dividing by it rounds once
_KWH = 3.6e6  # J
_NOTHING_ELSE = ('motion', 'held', 'released')  # kinds of rows that name a robot and change no state by themselves
_OPEN = 'goal'  # the `what` of goals
_BEGINS = {kind: (number, cause) for number, state in enumerate(STATES) for cause in state.causes
           for kind in cause.begin}
_ENDS = {kind: (number, cause) for number, state in enumerate(STATES) for cause in state.causes for kind in cause.end}


class Stay(NamedTuple):
    """A robot is, works, is charged or waits (``what``) at ``where`` from ``begin_ns`` to ``end_ns``.

    ``where``: the name of a zone or lane as in the rows, 'place NAME', CHARGERS, a reason of a hold, or '': work at a
    place that the log does not name. ``at``: (x, y) [m] where the robot stood when the stay began; None: not known.
    ``number``: that of its begin among all stays; ``is_open``: the run ended before the stay.
    """

    begin_ns: int
    end_ns: int
    robot: str
    what: str
    where: str
    at: Optional[Tuple[float, float]]
    number: int
    is_open: bool = False


@dataclass
class Emptied:
    """A battery has become empty at ``time_ns`` [ns] while no charger charged it.

    ``at``: (x, y) [m] where the robot stands then; None: not known. ``doing``: what it did, in words.
    """

    time_ns: int
    robot: str
    at: Optional[Tuple[float, float]]
    doing: str

    @property
    def words(self) -> str:
        """Where the robot was and what it did, in words."""
        return self.doing if self.at is None else f'at ({self.at[0]:.2f}, {self.at[1]:.2f}), {self.doing}'


class Overfull(NamedTuple):
    """One robot too many came to work at a place (``works``), or into a zone or lane, at ``time_ns``."""

    time_ns: int
    robot: str
    works: bool
    where: str
    room: int
    robots: Tuple[str, ...]


@dataclass
class Waits:
    """The waits at one place: their number, their sum and the longest one [ns]."""

    count: int = 0
    total_ns: int = 0
    longest_ns: int = 0

    def add(self, span_ns: int) -> None:
        """Add a wait of ``span_ns`` [ns]."""
        self.count += 1
        self.total_ns += span_ns
        self.longest_ns = max(self.longest_ns, span_ns)


class Story:
    """What happened in a run: give it the rows in their order by :meth:`take`, then call :meth:`close`.

    ``start_ns`` [ns]: when the run began. ``robots``: names of robots that count even if there is no row of them.
    ``keeps_spans``: whether each robot's ``spans`` are kept, and :attr:`stays`, besides the sums.
    """

    def __init__(self, start_ns: int, robots: Sequence[str] = (), keeps_spans: bool = False) -> None:
        self.start_ns = self.end_ns = self.last_end_ns = start_ns  # the last: when a goal ended last
        self._robots: Dict[str, Robot] = {name: Robot(name, start_ns) for name in robots}
        self._owners = dict(self._robots)  # {name in a row: its robot}
        self._keeps_spans = keeps_spans
        #: what happened to the orders (Orders)
        self.orders = Orders()
        #: the stays of all robots, at the end in the order in which they began
        self.stays: List[Stay] = []
        #: each time at which a robot too many came somewhere
        self.overfull: List[Overfull] = []
        #: each time at which a battery became empty while no charger charged it
        self.emptied: List[Emptied] = []
        #: (instant [ns], robot that closed it, [robot, area, ...]) of the circles of waiting that are still closed
        self.circles: List[Tuple[int, str, Sequence[Any]]] = []
        self._begun = 0  # the number of stays
        self._waits: Dict[str, Waits] = {}
        self._room: Dict[str, int] = {}  # {area that robots enter: how many may be there, a large number: any}
        self._there: Dict[Tuple[str, str], List[Tuple[str, Any]]] = {}  # {(what, where): [(robot, goal id)]}
        self._also: Dict[str, Callable[[int, Robot, str, Sequence[Any]], None]] = {
            'stands': self._stands, 'ended': self._ended, 'failed': self._counted, 'charging_began': self._charging,
            'charging_ended': self._charging, 'task_began': self._works, 'works_at': self._works,
            'task_ended': self._ended, 'waiting_began': self._queues, 'waiting_ended': self._queues,
            'charge_awaited': self._for_charger, 'charge_assigned': self._for_charger, 'held': self._held,
            'released': self._held, 'entered': self._entered, 'left': self._left, 'charge': self._charge,
            'battery': self._battery, 'deadlock': self._deadlock, 'departed': self._departed}

    def take(self, time_ns: int, name: str, kind: str, values: Sequence[Any]) -> None:
        """Take a row. Since any node may write rows, one of an unexpected form is left out, or what is odd of it."""
        self.end_ns = max(self.end_ns, time_ns)
        begins, ends, also = _BEGINS.get(kind), _ENDS.get(kind), self._also.get(kind)
        try:
            if begins or ends or also or kind in _NOTHING_ELSE:
                robot = self._of(name)
                if begins:
                    robot.begin(begins[1], begins[0], _name(begins[1], values), time_ns)
                if ends:
                    robot.end(ends[1], ends[0], _name(ends[1], values))
                robot.settle(time_ns, self._keeps_spans)
                if also:
                    also(time_ns, robot, kind, values)
            elif kind == 'places':
                self._room[values[0]] = int(values[1])
            elif kind in ORDER_ROWS:
                self.orders.take(time_ns, name, kind, values)
                if kind in ('order_assigned', 'order_done'):
                    self._of(name).orders += kind == 'order_done' and values[1] != FAILED
        except (LookupError, TypeError, ValueError, ArithmeticError):
            pass

    def close(self, end_ns: Optional[int] = None) -> None:
        """End the story of a run that is over at ``end_ns`` [ns], at the earliest at its last row."""
        self.end_ns = max(self.end_ns, end_ns or self.end_ns)
        for robot in self._robots.values():
            robot.settle(self.end_ns, self._keeps_spans)
            for what, where in list(robot.stays):
                self._leave(robot, what, where, self.end_ns, True)
        self.stays.sort(key=lambda stay: stay.number)
        self.orders.close(self.end_ns)

    # --- results -----------------------------------------------------------------------------------------------------

    @property
    def seconds(self) -> float:
        """How long the run was [s, simulated]."""
        return (self.end_ns - self.start_ns) / _S

    @property
    def robots(self) -> Dict[str, Robot]:
        """{name: Robot}, by name."""
        return dict(sorted(self._robots.items()))

    def spans(self, name: str) -> List[Span]:
        """Return the Spans of the robot ``name``, without gaps; [] if there is none."""
        return self._robots[name].spans if name in self._robots else []

    @property
    def figures(self) -> Dict[str, Dict[str, float]]:
        """{robot: {each state: s, 'orders', 'failures', 'charges', 'energy_used', 'energy_charged' [kWh]}}."""
        return {name: {**{state: ns / _S for state, ns in zip(NAMES, robot.ns)}, 'orders': robot.orders,
                       'failures': robot.failures, 'charges': robot.charges, 'energy_used': robot.used / _KWH,
                       'energy_charged': robot.charged / _KWH}
                for name, robot in self.robots.items()}

    @property
    def has_energy(self) -> bool:
        """Whether the rows have the states of charge of batteries."""
        return any(robot.charge is not None for robot in self._robots.values())

    @property
    def waits(self) -> Dict[str, Waits]:
        """{where: Waits}, the longest sum first; where: 'place NAME', the name of an area, or CHARGERS."""
        found = {where: waits for where, waits in self._waits.items()
                 if where in self._room or where == CHARGERS or where.startswith(PLACE)}
        return dict(sorted(found.items(), key=lambda item: (-item[1].total_ns, item[0])))

    def open_tasks(self) -> Iterator[Tuple[str, Any, int]]:
        """Yield (robot, name, since [ns]) of the tasks that have not ended."""
        for robot in self._robots.values():
            yield from ((robot.name, name, since_ns) for what, name, _, since_ns in robot.open if what == 'task')

    # --- rows --------------------------------------------------------------------------------------------------------

    def _of(self, name: str) -> Robot:
        """Return the robot of this name, or in whose namespace it lies; a new one if there is none."""
        if name not in self._owners:
            known = owner(name, self._robots) or name
            self._owners[name] = self._robots.setdefault(known, Robot(known, self.start_ns))
        return self._owners[name]

    def _stay(self, robot: Robot, what: str, where: str, now_ns: int) -> None:
        if (what, where) not in robot.stays:
            robot.stays[what, where] = now_ns, robot.at, self._begun
            self._begun += 1

    def _leave(self, robot: Robot, what: str, where: str, now_ns: int, is_open: bool = False) -> None:
        since_ns, at, number = robot.stays.pop((what, where), (now_ns, None, 0))
        if now_ns <= since_ns:
            return
        if what == WAITS:
            self._waits.setdefault(where, Waits()).add(now_ns - since_ns)
        if self._keeps_spans:
            self.stays.append(Stay(since_ns, now_ns, robot.name, what, where, at, number, is_open))

    def _leave_all(self, robot: Robot, now_ns: int, ends: Callable[[str, str], bool]) -> None:
        for what, where in list(robot.stays):
            if ends(what, where):
                self._leave(robot, what, where, now_ns)

    def _stands(self, now_ns: int, robot: Robot, _kind: str, values: Sequence[Any]) -> None:
        robot.at = float(values[0]), float(values[1])
        last = self.emptied[-1] if self.emptied else None
        if last is not None and (last.time_ns, last.robot) == (now_ns, robot.name):
            last.at = robot.at  # it stops where its battery becomes empty

    @staticmethod
    def _departed(now_ns: int, robot: Robot, _kind: str, _values: Sequence[Any]) -> None:
        if robot.begun(_OPEN) is None:  # in a log of an earlier release, or of another simulator
            robot.begin(*_BEGINS[_OPEN][::-1], None, now_ns)

    def _ended(self, now_ns: int, robot: Robot, kind: str, values: Sequence[Any]) -> None:
        if kind == 'ended':
            self._open_circles(robot)
        else:
            self._leave_all(robot, now_ns, lambda what, where: what == WORKS or (
                what == WAITS and where.startswith(PLACE)))
            self._forget_work(robot, values[0])
        if values[1] in MISSED:
            robot.missed.append(now_ns)
        if kind == 'ended':
            robot.goals += values[1] == REACHED
            robot.goals_missed += values[1] in MISSED
            self.last_end_ns = now_ns

    def _counted(self, _now_ns: int, robot: Robot, _kind: str, _values: Sequence[Any]) -> None:
        robot.failures += 1

    def _charging(self, now_ns: int, robot: Robot, kind: str, values: Sequence[Any]) -> None:
        if kind == 'charging_began':
            robot.charges += 1
            self._stay(robot, CHARGES, str(values[0]), now_ns)
        else:
            self._leave_all(robot, now_ns, lambda what, _where: what == CHARGES)

    def _works(self, now_ns: int, robot: Robot, kind: str, values: Sequence[Any]) -> None:
        if kind == 'works_at':
            goal_id, place, room = values
            self._leave_all(robot, now_ns, lambda what, _where: what == WORKS)
            self._stay(robot, WORKS, PLACE + place, now_ns)
            self._come(now_ns, robot, (WORKS, place), goal_id, room)
        elif not any(what == WORKS for what, _ in robot.stays):
            self._stay(robot, WORKS, '', now_ns)

    def _queues(self, now_ns: int, robot: Robot, kind: str, values: Sequence[Any]) -> None:
        where = PLACE + str(values[1])
        if kind == 'waiting_began':
            self._leave_all(robot, now_ns, lambda what, _where: what == WORKS)
            self._forget_work(robot, values[0])
            self._stay(robot, WAITS, where, now_ns)
        else:
            self._leave(robot, WAITS, where, now_ns)

    def _for_charger(self, now_ns: int, robot: Robot, kind: str, _values: Sequence[Any]) -> None:
        if kind == 'charge_awaited':
            self._stay(robot, WAITS, CHARGERS, now_ns)
        else:
            self._leave(robot, WAITS, CHARGERS, now_ns)

    def _held(self, now_ns: int, robot: Robot, _kind: str, values: Sequence[Any]) -> None:
        """Take the reasons for which a robot is held, each one area, or several with commas between them."""
        reasons = [one for reason in map(str, values) for one in dict.fromkeys((reason, *reason.split(', ')))]
        self._leave_all(robot, now_ns, lambda what, where: what == WAITS and where not in reasons
                        and where != CHARGERS and not where.startswith(PLACE))
        for where in reasons:
            self._stay(robot, WAITS, where, now_ns)

    def _entered(self, now_ns: int, robot: Robot, _kind: str, values: Sequence[Any]) -> None:
        room = self._room.setdefault(values[0], 2 ** 63)
        self._stay(robot, INSIDE, values[0], now_ns)
        self._open_circles(robot)
        self._come(now_ns, robot, (INSIDE, values[0]), '', room)

    def _left(self, now_ns: int, robot: Robot, _kind: str, values: Sequence[Any]) -> None:
        self._leave(robot, INSIDE, values[0], now_ns)
        self._open_circles(robot)
        there = self._there.get((INSIDE, values[0]), [])
        there[:] = [one for one in there if one[0] != robot.name]

    def _come(self, now_ns: int, robot: Robot, where: Tuple[str, str], goal_id: Any, room: int) -> None:
        there = self._there.setdefault(where, [])
        there.append((robot.name, goal_id))
        if len(there) == room + 1:
            self.overfull.append(Overfull(now_ns, robot.name, where[0] == WORKS, where[1], room,
                                          tuple(name for name, _ in there)))

    def _forget_work(self, robot: Robot, goal_id: Any) -> None:
        for (what, _), there in self._there.items():
            if what == WORKS:
                there[:] = [one for one in there if one != (robot.name, goal_id)]

    def _open_circles(self, robot: Robot) -> None:
        self.circles = [one for one in self.circles if robot.name not in one[2][::2]]

    def _deadlock(self, now_ns: int, robot: Robot, _kind: str, values: Sequence[Any]) -> None:
        self.circles.append((now_ns, robot.name, values))

    def _battery(self, now_ns: int, robot: Robot, _kind: str, values: Sequence[Any]) -> None:
        if values[-1] == 'empty' and robot.begun('charge') is None:
            self.emptied.append(Emptied(now_ns, robot.name, robot.at, self.doing(robot)))

    @staticmethod
    def doing(robot: Robot) -> str:
        """Return what the robot does, in words: its state, and where and since when it waits or works."""
        state = NAMES[robot.state]
        what, word = {'waiting': (WAITS, 'for'), 'working': (WORKS, 'at')}.get(state, ('', ''))
        stays = sorted((number, where, since_ns) for (one, where), (since_ns, _, number) in robot.stays.items()
                       if one == what)
        places = ', '.join('{} since {:.1f} s'.format(where, since_ns / _S) for _, where, since_ns in stays if where)
        return '{} {} {}'.format(state, word, places) if places else state

    def _charge(self, _now_ns: int, robot: Robot, _kind: str, values: Sequence[Any]) -> None:
        charge, energy, since = float(values[0]), float(values[1]), values[2]
        change = (charge - robot.charge) * energy if robot.charge is not None and since != 'set' else 0.0
        if since == 'charged':
            robot.charged += change
        else:
            robot.used -= change
        robot.charge = charge


def owner(name: str, robots: Container[str]) -> Optional[str]:
    """Return the one of ``robots`` whose name this is, or in whose namespace it lies, or None."""
    parts = name.strip('/').split('/')
    above = ('/'.join(parts[:count]) for count in range(len(parts), 0, -1))
    return next((one for one in (*above, name) if one in robots), None)


def _name(cause: Cause, values: Sequence[Any]) -> Any:
    """Return the name of what a row begins or ends, None: it has none."""
    return values[0] if cause.named and values else None
