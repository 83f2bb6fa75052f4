"""A queue that sends answers in order, each not before its earliest wall time.

A stock SimpleActionClient puts a goal on the wire before it notes the goal's handle. A final answer that comes in
between is dropped, and the client waits for ever. So final answers wait for a short wall time, and all later messages
wait behind them.
"""
from __future__ import annotations

import heapq
import itertools
import threading
import time
from collections import deque
from typing import TYPE_CHECKING, Any, Callable, List

import rospy

if TYPE_CHECKING:
    from .outlets import Outlet
    from .packing import Pack


class _Waker:
    """One daemon thread for all outboxes of the process. It sleeps unless a message is held back."""

    def __init__(self) -> None:
        self._condition = threading.Condition()
        self._heap: List[Any] = []
        self._order = itertools.count()
        self._thread: Any = None

    def call_at(self, wall: float, function: Callable[[], object]) -> None:
        """Call ``function`` at ``wall`` [s, time.monotonic]."""
        with self._condition:
            heapq.heappush(self._heap, (wall, next(self._order), function))
            if self._thread is None:
                self._thread = threading.Thread(target=self._run, name='outbox', daemon=True)
                self._thread.start()
            self._condition.notify()

    def _run(self) -> None:
        while True:
            with self._condition:
                while not self._heap or self._heap[0][0] > time.monotonic():
                    self._condition.wait(max(0.0, self._heap[0][0] - time.monotonic()) if self._heap else None)
                _, _, function = heapq.heappop(self._heap)
            function()


_WAKER = _Waker()


class Outbox:
    """A first-in first-out queue of messages. Each has an Outlet, a packer, and the earliest wall time to send it.

    Any thread may call the methods.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._waiting: Any = deque()

    def send(self, outlet: Outlet, pack: Pack, not_before: float = 0.0) -> None:
        """Send ``pack`` to ``outlet`` after all earlier messages, not before ``not_before`` [s, time.monotonic]."""
        with self._lock:
            if not (self._waiting or not_before):
                _send(outlet, pack)
                return
            self._waiting.append((not_before, outlet, pack))
            if len(self._waiting) == 1:
                self._drain()

    def is_waiting(self) -> bool:
        """Return whether a message is held back."""
        return bool(self._waiting)

    def flush(self) -> None:
        """Send all waiting messages now."""
        with self._lock:
            while self._waiting:
                _send(*self._waiting.popleft()[1:])

    def _drain(self) -> None:
        while self._waiting:
            not_before, outlet, pack = self._waiting[0]
            if not_before > time.monotonic():
                _WAKER.call_at(not_before, self._resume)
                return
            self._waiting.popleft()
            _send(outlet, pack)

    def _resume(self) -> None:
        with self._lock:
            self._drain()


def _send(outlet: Outlet, pack: Pack) -> None:
    try:
        outlet.send(pack)
    except rospy.ROSException:
        pass  # the node is going down and has closed the topic
