"""The end of a process: SIGINT and SIGTERM end it at any moment, whatever its threads do.

rospy's own handlers run in the main thread, between two of its lines, and unregister at the ROS master there. But the
interrupted line may hold a lock, and the ROS master may be gone. Here a signal wakes a thread that waits for nothing
else, and that thread shuts rospy down. If the process has not ended soon after, it is ended.

This module imports only the standard library, so that a program can import it first.
"""
from __future__ import annotations

import os
import signal
import socket
import sys
import threading
import time
from typing import Any, Callable, Optional

GRACE_S = 5.0  # wall, from the signal to the end of the process while it starts
GRACE_OF_NODE_S = 12.0  # wall; roslaunch waits for 15 s, and a thousand robots have much to unregister
LAST_GRACE_S = 2  # wall, a whole number; after that the kernel ends the process
SIGNALS = (signal.SIGINT, signal.SIGTERM)


class ProcessEnd:
    """Handles SIGINT and SIGTERM from now on. Make it once, in the main thread.

    ``on_signal(name)`` is called at the first signal, in a thread of its own. If it is None, other code handles the
    signals, and this only makes sure that the process ends.
    """

    def __init__(self, name: str, on_signal: Optional[Callable[..., Any]] = None) -> None:
        self._name = name
        self._on_signal = on_signal
        self._grace_s = GRACE_S
        self.asked = threading.Event()  # a signal has come
        self.over = threading.Event()  # on_signal has returned
        self._receive, self._wake = socket.socketpair()
        self._receive.settimeout(None)  # whatever the process has set for all its new sockets
        self._wake.setblocking(False)
        if on_signal is not None:
            for number in SIGNALS:
                signal.signal(number, lambda _number, _frame: None)
        # The handler of the C library writes there, even while the main thread waits for a lock or for the disk.
        signal.set_wakeup_fd(self._wake.fileno(), warn_on_full_buffer=False)
        threading.Thread(target=self._await_signal, name='process_end', daemon=True).start()

    @property
    def is_in_service(self) -> bool:
        """Whether the node has started, and other nodes may use it."""
        return self._grace_s >= GRACE_OF_NODE_S

    def enter_service(self) -> None:
        """Note that the node has started. Its end may take longer from now on, since it has much to unregister."""
        self._grace_s = GRACE_OF_NODE_S

    def _await_signal(self) -> None:
        while True:
            number = self._receive.recv(1)
            if number and number[0] in SIGNALS:
                break
        grace_s = self._grace_s
        self.hasten(grace_s)
        signal.alarm(int(grace_s) + LAST_GRACE_S)  # in case Python's threads no longer run
        self.asked.set()
        if self._on_signal is not None:
            self._on_signal(signal.Signals(number[0]).name)
        self.over.set()

    def hasten(self, seconds: float) -> None:
        """End the process after ``seconds`` [wall], unless it has ended by then. For any thread."""
        threading.Thread(target=self._end_at_last, args=(seconds,), daemon=True).start()

    def _end_at_last(self, grace_s: float) -> None:
        time.sleep(grace_s)
        leave(1, '{}: did not end within {:g} s of a signal; it is ended'.format(self._name, grace_s))


def leave(code: int, text: str = '') -> None:
    """End the process now with the exit ``code``, after printing ``text``, without waiting for its threads.

    Threads may hold locks for ever.
    """
    try:
        if text:
            os.write(sys.stderr.fileno(), (text + '\n').encode('utf-8', 'backslashreplace'))
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
    except (OSError, ValueError, AttributeError):
        pass  # the output is closed
    os._exit(code)

