"""Rows of the event log that a dispatcher writes: the kind of each, to which robot it belongs, and its values.

=================  ==========  =====================================================================================
kind               of          values
=================  ==========  =====================================================================================
order_arrived      DISPATCHER  order, priority, deadline [ns, an instant; 0: none], per stop: place ('': none),
                               x, y [m], action
order_refused      DISPATCHER  order, text that says what is wrong with it
policy_failed      DISPATCHER  text that says what is wrong with the policy's choice; no robot got an order then
order_assigned     robot       order, number of the attempt (from 1 on)
order_stop         robot       order, number of the stop (from 1 on), DRIVES, WORKS or DONE
order_returned     robot       order, reason, number of the stop that comes next
order_done         robot       order, code (DONE, LATE, FAILED), ns since it arrived, ns after its deadline (only if it
                               has one; negative: before it)
charge_assigned    robot       charger, reason: LOW or IDLE
charge_awaited     robot       LOW: all chargers are taken
charge_over        robot       charger that it leaves
=================  ==========  =====================================================================================
"""
from __future__ import annotations

from typing import Any, Tuple

#: the owner of rows that belong to no robot; no name of a robot begins with a slash
DISPATCHER = '/dispatcher'
DRIVES, WORKS, DONE, LATE, FAILED = 'drives', 'works', 'done', 'late', 'failed'
LOW, IDLE = 'low', 'idle'
#: the reasons for which an order came back
ROBOT_FAILED, ROBOT_EMPTY, TAKEN = 'robot failed', 'battery empty', 'robot taken'


Row = Tuple[Any, ...]
