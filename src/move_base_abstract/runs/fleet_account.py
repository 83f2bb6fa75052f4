"""What a fleet did in a run, from its event log alone: the time in each state, waits, orders, and charging.

At each time a robot is in the first of these states that holds: ``failed``, from `failed` to `repaired`; ``driving``,
from `departed` to `stands`; ``working``, while it does a task; ``waiting``, while it stands with a goal, in a queue, or
for a charger; ``charging``, while it stands at a charger; ``idle``. If a robot waits for two areas at once, the wait
counts for each of them.
"""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, Optional, Sequence, Set

from .order_account import ORDER_ROWS, OrderAccount

STATES = ('driving', 'working', 'waiting', 'charging', 'idle', 'failed')
#: the name of the place in :attr:`FleetAccount.waits` for waits for a charger
CHARGERS = 'chargers'
_S = 1e9  # dividing by it rounds once
_KWH = 3.6e6  # J


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


@dataclass
class _Robot:
    since_ns: int
    state: str = 'idle'
    ns: Dict[str, int] = field(default_factory=lambda: dict.fromkeys(STATES, 0))
    flags: Set[str] = field(default_factory=set)  # its order does not matter
    waits: Dict[str, int] = field(default_factory=dict)  # {where: since when [ns]}
    orders: int = 0
    failures: int = 0
    charges: int = 0
    charge: Optional[float] = None  # the last state of charge in the rows, 0..1
    energy: float = 0.0  # J, of a full battery
    used: float = 0.0  # J
    charged: float = 0.0

    def now_in(self) -> str:
        for state in ('failed', 'driving', 'working', 'waiting', 'charging'):
            if state in self.flags or (state == 'waiting' and ('goal' in self.flags or CHARGERS in self.waits)):
                return state
        return 'idle'

    def settle(self, now_ns: int) -> None:
        self.ns[self.state] += now_ns - self.since_ns
        self.state, self.since_ns = self.now_in(), now_ns


class FleetAccount:
    """The account of one fleet: give it the rows of a log by :meth:`take`, then call :meth:`close`.

    ``start_ns`` [ns]: when the run began. ``robots``: names of robots that count even if there is no row of them.
    """

    def __init__(self, start_ns: int, robots: Sequence[str] = ()) -> None:
        self._start_ns = start_ns
        self._robots: Dict[str, _Robot] = {name: _Robot(start_ns) for name in robots}
        #: the account of the orders (OrderAccount)
        self.orders = OrderAccount()
        self._waits: Dict[str, Waits] = {}
        self._areas: Set[str] = set()  # its order does not matter
        self.seconds = 0.0
        self._take: Dict[str, Callable[[int, str, Sequence[Any]], None]] = {
            **dict.fromkeys(_FLAGS, self._flag), 'held': self._held, 'released': self._held,
            'waiting_began': self._queue, 'waiting_ended': self._queue, **dict.fromkeys(
                ('entered', 'places'), lambda _now_ns, _name, row: self._areas.add(row[1])),
            'charge': self._charge, 'charge_awaited': self._for_charger, 'charge_assigned': self._for_charger,
            **dict.fromkeys(ORDER_ROWS, self._order)}

    def take(self, time_ns: int, robot: str, kind: str, values: Sequence[Any]) -> None:
        """Take a row of the log. Since any node may write rows, a row of an unexpected form is left out."""
        taker = self._take.get(kind)
        if taker is not None:
            try:
                taker(time_ns, robot, (kind, *values))
            except (TypeError, ValueError, IndexError, KeyError, OverflowError):
                pass

    def close(self, end_ns: int) -> None:
        """End the account of a run that is over at ``end_ns`` [ns]."""
        for robot in self._robots.values():
            robot.settle(end_ns)
            for where in list(robot.waits):
                self._end_wait(robot, where, end_ns)
        self.seconds = (end_ns - self._start_ns) / _S

    # --- results -----------------------------------------------------------------------------------------------------

    @property
    def robots(self) -> Dict[str, Dict[str, float]]:
        """{robot: {each state: s, 'orders', 'failures', 'charges', 'energy_used', 'energy_charged' [kWh]}}."""
        return {name: {**{state: robot.ns[state] / _S for state in STATES}, 'orders': robot.orders,
                       'failures': robot.failures, 'charges': robot.charges, 'energy_used': robot.used / _KWH,
                       'energy_charged': robot.charged / _KWH}
                for name, robot in sorted(self._robots.items())}

    @property
    def has_energy(self) -> bool:
        """Whether the log has the states of charge of batteries."""
        return any(robot.charge is not None for robot in self._robots.values())

    @property
    def waits(self) -> Dict[str, Waits]:
        """{where: Waits}, the longest sum first; where: 'place NAME', the name of an area, or CHARGERS."""
        found = {where: waits for where, waits in self._waits.items()
                 if where in self._areas or where == CHARGERS or where.startswith('place ')}
        return dict(sorted(found.items(), key=lambda item: (-item[1].total_ns, item[0])))

    def metrics(self) -> Dict[str, Optional[float]]:
        """Return {name: number}, the metrics of a trial, None if a number does not exist; {} if no orders arrived."""
        orders, robots = self.orders.times, self.robots.values()
        if not orders.arrived:
            return {}
        time = math.fsum(one[state] for one in robots for state in STATES)
        found: Dict[str, Optional[float]] = {
            'orders_done': orders.done, 'orders_failed': orders.failed, 'orders_open': orders.open,
            'order_flow': _mean(orders.flow), 'order_wait': _mean(orders.wait)}
        if self.orders.has_deadlines:
            found.update(orders_late=100.0 * orders.late / len(orders.lateness) if orders.lateness else None,
                         order_lateness=_mean(orders.lateness))
        for state in STATES:
            found['share_' + state] = round(100.0 * math.fsum(one[state] for one in robots) / time, 9) if time else None
        found['failures'] = sum(one['failures'] for one in robots)
        if self.has_energy:
            found['charges'] = sum(one['charges'] for one in robots)
            for what in ('energy_used', 'energy_charged'):
                found[what] = round(math.fsum(one[what] for one in robots), 9)
        return found

    # --- rows --------------------------------------------------------------------------------------------------------

    def _of(self, robot: str) -> _Robot:
        if robot not in self._robots:
            self._robots[robot] = _Robot(self._start_ns)
        return self._robots[robot]

    def _flag(self, now_ns: int, name: str, row: Sequence[Any]) -> None:
        kind, robot = row[0], self._of(name)
        begins, ends = _FLAGS[kind]
        robot.flags.difference_update(ends)
        robot.flags.update(begins)
        robot.failures += kind == 'failed'
        robot.charges += kind == 'charging_began'
        robot.settle(now_ns)

    def _end_wait(self, robot: _Robot, where: str, now_ns: int) -> None:
        since_ns = robot.waits.pop(where, None)
        if since_ns is not None and now_ns > since_ns:
            self._waits.setdefault(where, Waits()).add(now_ns - since_ns)

    def _held(self, now_ns: int, name: str, row: Sequence[Any]) -> None:
        robot = self._of(name)
        reasons = [part for reason in row[1:] for part in str(reason).split(', ')]
        for where in list(robot.waits):
            if where not in reasons and where != CHARGERS and not where.startswith('place '):
                self._end_wait(robot, where, now_ns)
        for where in reasons:
            robot.waits.setdefault(where, now_ns)

    def _queue(self, now_ns: int, name: str, row: Sequence[Any]) -> None:
        robot, where = self._of(name), 'place {}'.format(row[2])
        if row[0] == 'waiting_began':
            robot.flags.add('waiting')
            robot.flags.discard('working')
            robot.waits.setdefault(where, now_ns)
        else:
            robot.flags.discard('waiting')
            self._end_wait(robot, where, now_ns)
        robot.settle(now_ns)

    def _for_charger(self, now_ns: int, name: str, row: Sequence[Any]) -> None:
        robot = self._of(name)
        if row[0] == 'charge_awaited':
            robot.waits.setdefault(CHARGERS, now_ns)
        else:
            self._end_wait(robot, CHARGERS, now_ns)
        robot.settle(now_ns)

    def _charge(self, _now_ns: int, name: str, row: Sequence[Any]) -> None:
        robot, charge, energy = self._of(name), float(row[1]), float(row[2])
        if robot.charge is not None and row[3] != 'set':
            change = (charge - robot.charge) * energy
            if row[3] == 'charged':
                robot.charged += change
            else:
                robot.used -= change
        robot.charge = charge

    def _order(self, now_ns: int, name: str, row: Sequence[Any]) -> None:
        self.orders.take(now_ns, name, row)
        if row[0] in ('order_assigned', 'order_done'):
            self._of(name).orders += row[0] == 'order_done' and row[2] != 'failed'


#: {kind: (flags that begin, flags that end)}
_FLAGS = {'departed': (('driving', 'goal'), ()), 'stands': ((), ('driving',)), 'ended': ((), ('goal',)),
          'task_began': (('working',), ('waiting',)), 'task_ended': ((), ('working', 'waiting')),
          'failed': (('failed',), ()), 'repaired': ((), ('failed',)), 'motion': ((), ()),
          'charging_began': (('charging',), ()), 'charging_ended': ((), ('charging',))}


def _mean(values: Sequence[float]) -> Optional[float]:
    return round(math.fsum(values) / len(values), 9) if values else None
