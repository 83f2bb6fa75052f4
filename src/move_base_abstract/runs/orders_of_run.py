"""The orders of a run, from its rows: how they ended, how long they took, and which robot had them when."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple

#: the kinds of rows that Orders takes
ORDER_ROWS = ('order_arrived', 'order_refused', 'order_assigned', 'order_stop', 'order_returned', 'order_done')
FAILED, LATE = 'failed', 'late'
_S = 1e9  # dividing by it rounds once
_STOP = 4  # values of a stop in `order_arrived`: place, x, y, action
_HEAD = 3  # values before the stops


class Phase(NamedTuple):
    """From ``begin_ns`` to ``end_ns`` an order is with ``robot`` ('': with none), and ``stop`` (from 1 on) is next."""

    begin_ns: int
    end_ns: int
    robot: str
    stop: int
    is_open: bool = False  # whether the run ended before the phase


@dataclass
class Order:
    """An order. ``stops``: (x, y) of each [m], as the row has them; ``ended_ns`` [ns]: None while it is open."""

    name: str
    arrived_ns: int
    deadline_ns: int
    stops: List[Tuple[Any, Any]]
    phases: List[Phase] = field(default_factory=list)
    assigned_ns: Optional[int] = None
    ended_ns: Optional[int] = None
    code: str = ''
    flow_ns: int = 0
    lateness_ns: Optional[int] = None
    returned: int = 0
    where: str = 'no robot has begun it'
    now: Tuple[int, str, int] = (0, '', 1)  # (since [ns], robot, stop) of the present phase

    def go_on(self, now_ns: int, robot: str, stop: Any) -> None:
        """Begin a phase, unless the present one goes on; ``stop``: the number of the next stop."""
        stop = min(max(stop, 1), max(len(self.stops), 1)) if isinstance(stop, int) else 1
        if self.now[1:] != (robot, stop):
            self.end_phase(now_ns)
            self.now = now_ns, robot, stop

    def end_phase(self, now_ns: int, is_open: bool = False) -> None:
        """End the present phase; ``is_open``: because the run has ended."""
        if now_ns > self.now[0]:
            self.phases.append(Phase(self.now[0], now_ns, *self.now[1:], is_open))


class OrderTimes(NamedTuple):
    """The numbers of orders that arrived, were done, late, failed, ..., and the times of the orders that were done [s].

    ``late`` counts orders among those done; ``returned`` counts how often an order came back from a robot. ``flow``:
    from arrival to the end; ``wait``: from arrival until a robot gets the order.
    """

    arrived: int
    done: int
    late: int
    failed: int
    open: int
    returned: int
    flow: List[float]
    wait: List[float]
    lateness: List[float]  # of orders with a deadline; 0 if an order is in time
    refused: int


class Orders:
    """The orders of a run, ``all`` of them in the order of arrival: give it the rows of orders by :meth:`take`."""

    def __init__(self) -> None:
        self.all: Dict[str, Order] = {}
        #: when orders were refused [ns]
        self.refused: List[int] = []

    def take(self, now_ns: int, name: str, kind: str, values: Sequence[Any]) -> None:
        """Take a row of the robot ``name``, or of the dispatcher, at ``now_ns`` [ns].

        :raises KeyError: if the order of the row never arrived. :raises TypeError, ValueError, IndexError: if the row
            has another form.
        """
        if kind == 'order_refused':
            self.refused.append(now_ns)
        elif kind == 'order_arrived':
            stops = [(values[place + 1], values[place + 2]) for place in range(_HEAD, len(values) - _STOP + 1, _STOP)]
            order = Order(values[0], now_ns, int(values[2]), stops, now=(now_ns, '', 1))
            self.all.setdefault(values[0], order)
        elif self.all[values[0]].ended_ns is None:
            getattr(self, '_' + kind)(now_ns, name, self.all[values[0]], values)

    def close(self, end_ns: int) -> None:
        """End the phases of the orders that are open at the end of the run, at ``end_ns`` [ns]."""
        for order in self.all.values():
            if order.ended_ns is None:
                order.end_phase(end_ns, True)

    @property
    def times(self) -> OrderTimes:
        """The numbers and times of the orders so far."""
        orders = list(self.all.values())
        done = [one for one in orders if one.code and one.code != FAILED]
        return OrderTimes(
            len(orders), len(done), sum(one.code == LATE for one in done),
            sum(one.code == FAILED for one in orders), sum(not one.code for one in orders),
            sum(one.returned for one in orders), [one.flow_ns / _S for one in done],
            [(one.assigned_ns - one.arrived_ns) / _S for one in done if one.assigned_ns is not None],
            [max(0, one.lateness_ns) / _S for one in done if one.lateness_ns is not None], len(self.refused))

    @property
    def undone(self) -> Dict[str, str]:
        """{open order: a text that says where it is}, in the order of arrival."""
        return {name: one.where for name, one in self.all.items() if not one.code}

    @property
    def has_deadlines(self) -> bool:
        """Whether any order has a deadline."""
        return any(one.deadline_ns for one in self.all.values())

    @staticmethod
    def _order_assigned(now_ns: int, name: str, order: Order, _values: Sequence[Any]) -> None:
        order.where = 'with {}'.format(name)
        if order.assigned_ns is None:
            order.assigned_ns = now_ns
        order.go_on(now_ns, name, order.now[2])

    @staticmethod
    def _order_stop(now_ns: int, name: str, order: Order, values: Sequence[Any]) -> None:
        order.where = 'with {}, stop {}: {}'.format(name, *values[1:3])
        order.go_on(now_ns, name, values[1])

    @staticmethod
    def _order_returned(now_ns: int, name: str, order: Order, values: Sequence[Any]) -> None:
        order.returned += 1
        order.where = 'came back from {}: {}'.format(name, values[1])
        order.go_on(now_ns, '', values[2] if len(values) > 2 else 1)

    @staticmethod
    def _order_done(now_ns: int, _name: str, order: Order, values: Sequence[Any]) -> None:
        order.lateness_ns = int(values[3]) if len(values) > 3 else None
        order.code, order.flow_ns, order.ended_ns = str(values[1]), int(values[2]), now_ns
        order.end_phase(now_ns)
