"""The orders of a run, from its event log alone: how they ended, and how long they took."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, List, NamedTuple, Optional, Sequence

#: the kinds of rows that OrderAccount takes
ORDER_ROWS = ('order_arrived', 'order_refused', 'order_assigned', 'order_stop', 'order_returned', 'order_done')
_S = 1e9  # dividing by it rounds once


@dataclass
class _Order:
    arrived_ns: int
    deadline_ns: int
    assigned_ns: Optional[int] = None
    code: str = ''
    flow_ns: int = 0
    lateness_ns: Optional[int] = None
    returned: int = 0
    where: str = 'no robot has begun it'


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


class OrderAccount:
    """The account of the orders of a run: give it the rows of orders by :meth:`take`."""

    def __init__(self) -> None:
        self._orders: Dict[str, _Order] = {}
        self._refused = 0

    def take(self, now_ns: int, name: str, row: Sequence[Any]) -> None:
        """Take a row (kind, value, ...) of the robot ``name``, or of the dispatcher, at ``now_ns`` [ns].

        :raises KeyError: if the order of the row never arrived.
        """
        kind = row[0]
        if kind == 'order_refused':
            self._refused += 1
        elif kind == 'order_arrived':
            self._orders.setdefault(row[1], _Order(now_ns, int(row[3])))
        else:
            getattr(self, '_' + kind)(now_ns, name, self._orders[row[1]], row)

    @property
    def times(self) -> OrderTimes:
        """The numbers and times of the orders so far."""
        orders = list(self._orders.values())
        done = [one for one in orders if one.code in ('done', 'late')]
        return OrderTimes(
            len(orders), len(done), sum(one.code == 'late' for one in done),
            sum(one.code == 'failed' for one in orders), sum(not one.code for one in orders),
            sum(one.returned for one in orders), [one.flow_ns / _S for one in done],
            [(one.assigned_ns - one.arrived_ns) / _S for one in done if one.assigned_ns is not None],
            [max(0, one.lateness_ns) / _S for one in done if one.lateness_ns is not None], self._refused)

    @property
    def undone(self) -> Dict[str, str]:
        """{open order: a text that says where it is}, in the order of arrival."""
        return {name: one.where for name, one in self._orders.items() if not one.code}

    @property
    def has_deadlines(self) -> bool:
        """Whether any order has a deadline."""
        return any(one.deadline_ns for one in self._orders.values())

    @staticmethod
    def _order_assigned(now_ns: int, name: str, order: _Order, _row: Sequence[Any]) -> None:
        order.where = 'with {}'.format(name)
        if order.assigned_ns is None:
            order.assigned_ns = now_ns

    @staticmethod
    def _order_stop(_now_ns: int, name: str, order: _Order, row: Sequence[Any]) -> None:
        order.where = 'with {}, stop {}: {}'.format(name, *row[2:4])

    @staticmethod
    def _order_returned(_now_ns: int, name: str, order: _Order, row: Sequence[Any]) -> None:
        order.returned += 1
        order.where = 'came back from {}: {}'.format(name, row[2])

    @staticmethod
    def _order_done(_now_ns: int, _name: str, order: _Order, row: Sequence[Any]) -> None:
        order.code, order.flow_ns = str(row[2]), int(row[3])
        order.lateness_ns = int(row[4]) if len(row) > 4 else None
