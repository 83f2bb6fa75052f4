"""Rows of the event log that a dispatcher writes: their kinds, their owner, and words in them."""
from __future__ import annotations

from typing import Any, Tuple

from ..runs.trace import RowKind

#: the owner of rows that belong to no robot; no name of a robot begins with a slash
DISPATCHER = '/dispatcher'
DRIVES, WORKS, DONE, LATE, FAILED = 'drives', 'works', 'done', 'late', 'failed'
LOW, IDLE = 'low', 'idle'
#: the reasons for which an order came back
ROBOT_FAILED, ROBOT_EMPTY, TAKEN, SHORT = 'robot failed', 'battery empty', 'robot taken', 'charge too low'
#: those of them that are not the order's fault
ROBOTS_FAULTS = ROBOT_FAILED, ROBOT_EMPTY, TAKEN, SHORT

Row = Tuple[Any, ...]
#: the kinds of these rows
ROW_KINDS = (
    RowKind('order_arrived',
            'order, priority, deadline [ns, an instant; 0: none], then for each stop: place (or empty), x, y [m], '
            'action',
            'of `/dispatcher`: an order has come'),
    RowKind('order_refused', 'order, what is wrong with it',
            'of `/dispatcher`: it cannot be done, or the policy fails with it alone'),
    RowKind('policy_failed', 'what is wrong',
            'of `/dispatcher`: the policy failed, or chose what cannot be done; no robot got an order then'),
    RowKind('order_assigned', 'order, how many times it has been given so far (1: the first time)',
            'the robot has got the order'),
    RowKind('order_stop', 'order, number of the stop (from 1 on), `drives`, `works` or `done`',
            'how far the robot is at a stop'),
    RowKind('order_returned', 'order, why, number of the stop that comes next', 'the order came back'),
    RowKind('order_done',
            'order, `done`, `late` or `failed`, ns since its arrival; with a deadline also the ns after it '
            '(negative: before it)',
            'the order is done or given up'),
    RowKind('charge_assigned', 'charger, `low` or `idle`', 'the robot is sent to charge'),
    RowKind('charge_awaited', '`low`', 'all chargers are taken'),
    RowKind('charge_over', 'charger', 'the robot leaves the charger'),
    RowKind('park_assigned', 'place', 'the robot is sent to park'),
)
