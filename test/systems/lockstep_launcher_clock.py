#!/usr/bin/env python3
"""Have the time master run until argv[1] [s, simulated]; print its state as JSON when the run is over or idle.

argv[2] [s, wall] is the longest time to wait.
"""

import json
import sys
import time

import rospy

from move_base_abstract.msg import TimeState
from move_base_abstract_ros.time_master_client import TimeMasterClient

_OVER = ('deadlock', 'zero_delay_loop', 'ended')
# states in a row, since a run may be idle for a moment before its end; with a speed limit it is on its way to argv[1]
_IDLE = 10


def main():
    until, limit = float(sys.argv[1]), float(sys.argv[2])
    rospy.init_node('launcher_clock', disable_rostime=True)
    TimeMasterClient().run_until(until)
    deadline = time.monotonic() + limit
    idle = 0
    while True:
        state = rospy.wait_for_message('/time_master/state', TimeState)
        idle = idle + 1 if state.phase == 'idle' and not state.wanted_factor else 0
        is_over = (state.phase == 'paused' and state.sim_time.to_sec() >= until or state.phase in _OVER
                   or idle >= _IDLE)
        is_stuck = any('before rospy.init_node' in one.owes for one in state.waiting_for)  # a program has gone for good
        if is_over or is_stuck or time.monotonic() > deadline:
            break
        time.sleep(0.02)
    print(json.dumps({
        'is_over': is_over, 'phase': state.phase, 'time': state.sim_time.to_sec(),
        'reason': state.reason, 'waiting_for': ['{} owes {}'.format(one.name, one.owes) for one in state.waiting_for],
        'repeatable': state.repeatable, 'not_repeatable_because': state.not_repeatable_because,
        'degraded_because': state.degraded_because}))


if __name__ == '__main__':
    main()
