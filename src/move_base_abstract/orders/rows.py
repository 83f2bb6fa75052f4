"""Rows of the event log that a dispatcher writes: of whom, what, and the values.

=================  ==========  =====================================================================================
kind               of          values
=================  ==========  =====================================================================================
order_arrived      DISPATCHER  order, priority, deadline [ns, an instant; 0: none], then of each stop: place ('': none),
                               x, y [m], action
order_refused      DISPATCHER  order, what is wrong with it
policy_failed      DISPATCHER  what is wrong with what the policy did; nobody was given an order then
order_assigned     robot       order, which attempt (from 1 on)
order_stop         robot       order, number of the stop (from 1 on), DRIVES, WORKS or DONE
order_returned     robot       order, why, number of the stop that comes next
order_done         robot       order, code (DONE, LATE, FAILED), ns since it arrived, ns after its deadline (only if it
                               has one; negative: before it)
charge_assigned    robot       charger, why: LOW or IDLE
charge_awaited     robot       LOW: all chargers are taken
charge_over        robot       charger that it leaves
=================  ==========  =====================================================================================
"""
from __future__ import annotations

from typing import Any, Tuple

#: whose rows they are that are of no robot: no robot's name begins so
DISPATCHER = '/dispatcher'
DRIVES, WORKS, DONE, LATE, FAILED = 'drives', 'works', 'done', 'late', 'failed'
LOW, IDLE = 'low', 'idle'
#: why an order came back
ROBOT_FAILED, ROBOT_EMPTY, TAKEN = 'robot failed', 'battery empty', 'robot taken'


Row = Tuple[Any, ...]
