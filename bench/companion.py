#!/usr/bin/env python3
"""A process beside the benchmark: records every /clock message and answers pings (stock rospy).

It reads commands from standard input, one per line: `start` clears the record, and `stop` prints its summary as a JSON
line. It ends with its input. It must start while /use_sim_time is false: otherwise rospy itself subscribes to /clock
with a queue of one, which would hide messages from any other subscriber of the process.
"""

import json
import sys
import threading
import time

import rospy
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Empty


class ClockRecord:
    """Counts /clock messages, and keeps the first one, the last one, and the largest step between two of them."""

    def __init__(self):
        self._lock = threading.Lock()
        self.restart()
        rospy.Subscriber('/clock', Clock, self._add, queue_size=None, tcp_nodelay=True)

    def restart(self):
        """Clear the record."""
        with self._lock:
            self._first = self._last = None
            self._count = 0
            self._largest_ns = 0

    def summary(self):
        """Return the achieved factor, the largest step [simulated s], the rate [Hz] and the wall time [s].

        None if there were fewer than two messages.
        """
        with self._lock:
            if self._count < 2:
                return None
            wall_s = self._last[0] - self._first[0]
            return {'achieved_factor': (self._last[1] - self._first[1]) / 1e9 / wall_s,
                    'largest_step_s': self._largest_ns / 1e9, 'rate_hz': (self._count - 1) / wall_s, 'wall_s': wall_s}

    def _add(self, message):
        now = time.monotonic(), message.clock.to_nsec()
        with self._lock:
            if self._last is None:
                self._first = now
            else:
                self._largest_ns = max(self._largest_ns, now[1] - self._last[1])
            self._last = now
            self._count += 1


def main():
    """Serve until the input ends."""
    rospy.init_node('bench_companion', disable_signals=True)
    record = ClockRecord()
    pong = rospy.Publisher('/bench/pong', Empty, queue_size=10, tcp_nodelay=True)
    rospy.Subscriber('/bench/ping', Empty, pong.publish, queue_size=10, tcp_nodelay=True)
    print('ready', flush=True)
    for line in sys.stdin:
        if line.strip() == 'start':
            record.restart()
        else:
            print(json.dumps(record.summary()), flush=True)


if __name__ == '__main__':
    main()
