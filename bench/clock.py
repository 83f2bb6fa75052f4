"""Figures of the clock, and the reference round trip, both measured with the companion process."""

import json
import os
import statistics
import subprocess
import sys
import threading
import time

import rospy
from std_msgs.msg import Empty

GUARD = 30.0  # s, wall


class Companion:
    """The companion process as seen from the benchmark."""

    def __init__(self, environment):
        script = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'companion.py')
        self._process = subprocess.Popen([sys.executable, script], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                         env=environment, text=True)
        if self._process.stdout.readline().strip() != 'ready':
            raise RuntimeError('bench/companion.py did not start')

    def close(self):
        """End the process, by closing its input."""
        self._process.stdin.close()
        self._process.wait(GUARD)

    def watch_clock(self, seconds):
        """Watch /clock for ``seconds`` of wall time, and return the summary (see ClockRecord.summary)."""
        self._command('start')
        time.sleep(seconds)
        self._command('stop')
        return json.loads(self._process.stdout.readline())

    def _command(self, word):
        self._process.stdin.write(word + '\n')
        self._process.stdin.flush()


def clock_figures(companion, time_master, factors, runs, seconds):
    """Yield one record per factor, with the medians of its runs of ``seconds`` of wall time each."""
    for factor in factors:
        time_master.set_factor(factor)
        time.sleep(0.2)
        seen = [companion.watch_clock(seconds) for _ in range(runs)]
        middle = {key: statistics.median(run[key] for run in seen) for key in seen[0]}
        yield {'kind': 'clock', 'factor': factor, 'runs': runs, 'seconds_per_run': seconds,
               'achieved_factor': middle['achieved_factor'],
               'achieved_error_percent': 100.0 * (middle['achieved_factor'] / factor - 1.0),
               'largest_step_s': middle['largest_step_s'],
               'largest_step_worst_run_s': max(run['largest_step_s'] for run in seen),
               'largest_step_wall_ms': 1e3 * middle['largest_step_s'] / factor, 'rate_hz': middle['rate_hz']}


def round_trip(count):
    """Return the reference record: round trips of an empty message between two stock rospy nodes."""
    arrived = threading.Event()
    subscriber = rospy.Subscriber('/bench/pong', Empty, lambda _: arrived.set(), tcp_nodelay=True)
    publisher = rospy.Publisher('/bench/ping', Empty, queue_size=10, tcp_nodelay=True)
    deadline = time.monotonic() + GUARD
    while not (publisher.get_num_connections() and subscriber.get_num_connections()):
        if time.monotonic() > deadline:
            raise RuntimeError(f'no connection to bench/companion.py after {GUARD:g} s')
        time.sleep(0.01)
    took = []
    for _ in range(count):
        arrived.clear()
        begin = time.monotonic()
        publisher.publish(Empty())
        arrived.wait(GUARD)
        took.append(1e6 * (time.monotonic() - begin))
    subscriber.unregister()
    publisher.unregister()
    return {'kind': 'reference', 'what': 'round trip of an empty message between two rospy processes', 'count': count,
            'median_us': statistics.median(took), 'p90_us': sorted(took)[int(0.9 * count)]}
