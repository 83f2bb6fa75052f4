#!/usr/bin/env python3
"""A participant with only a timer, which measures ticks per second of wall time: lockstep_ticks.py TICKS."""

import json
import sys
import time

import rospy

from move_base_abstract_ros import lockstep


def main():
    """Join the run, count ticks, and print a JSON line."""
    count = int(sys.argv[1])
    rospy.init_node('ticker', disable_signals=True)
    participant = lockstep.join()
    walls = []
    rospy.Timer(rospy.Duration(1), lambda _event: walls.append(time.perf_counter()))
    participant.wait_until(lambda: len(walls) >= count, what='the last tick')
    exact = participant.now_ns == 1_000_000_000 * (count + 1)
    print(json.dumps({'ticks': count, 'ticks_per_s': (count - 1) / (walls[-1] - walls[0]), 'exact': exact}), flush=True)


if __name__ == '__main__':
    main()
