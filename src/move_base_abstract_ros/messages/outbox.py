"""Answers in order, none of them sooner than promised.

A stock SimpleActionClient puts a goal on the wire before it notes the goal's handle; a final answer that comes in
between is dropped, and the client waits for ever. So final answers wait for a short time of the wall clock, and
whatever follows them waits behind them.
"""
import heapq
import itertools
import threading
import time
from collections import deque

import rospy


class _Waker:
    """One daemon thread for all outboxes of the process; it sleeps unless something is held back."""

    def __init__(self):
        self._condition = threading.Condition()
        self._heap = []
        self._order = itertools.count()
        self._thread = None

    def call_at(self, wall, function):
        """Call ``function`` at ``wall`` [s, time.monotonic]."""
        with self._condition:
            heapq.heappush(self._heap, (wall, next(self._order), function))
            if self._thread is None:
                self._thread = threading.Thread(target=self._run, name='outbox', daemon=True)
                self._thread.start()
            self._condition.notify()

    def _run(self):
        while True:
            with self._condition:
                while not self._heap or self._heap[0][0] > time.monotonic():
                    self._condition.wait(max(0.0, self._heap[0][0] - time.monotonic()) if self._heap else None)
                _, _, function = heapq.heappop(self._heap)
            function()


_WAKER = _Waker()


class Outbox:
    """A first-in first-out line of messages, packers for an Outlet, each with the earliest wall time of its leaving."""

    def __init__(self):
        self._lock = threading.Lock()
        self._waiting = deque()

    def send(self, outlet, pack, not_before=0.0):
        """Send ``pack`` to ``outlet`` when all earlier ones are out and ``not_before`` [s, time.monotonic] has come."""
        with self._lock:
            if not (self._waiting or not_before):
                _send(outlet, pack)
                return
            self._waiting.append((not_before, outlet, pack))
            if len(self._waiting) == 1:
                self._drain()

    def flush(self):
        """Publish all that waits, now."""
        with self._lock:
            while self._waiting:
                _send(*self._waiting.popleft()[1:])

    def _drain(self):
        while self._waiting:
            not_before, outlet, pack = self._waiting[0]
            if not_before > time.monotonic():
                _WAKER.call_at(not_before, self._resume)
                return
            self._waiting.popleft()
            _send(outlet, pack)

    def _resume(self):
        with self._lock:
            self._drain()


def _send(outlet, pack):
    try:
        outlet.send(pack)
    except rospy.ROSException:
        pass  # the node is going down and has closed the topic
