"""The end of a process: SIGINT and SIGTERM end it at any moment, whatever its threads do.

rospy's own handlers run in the main thread, between two lines of whatever that does, and tell the ROS master goodbye
there: under locks that the interrupted line may hold, and with a master that may be gone. Here a signal wakes a thread
that waits for nothing else. That one shuts rospy down; what has not ended soon after, is ended.

Imports nothing but the standard library, so that a program can begin with it.
"""
import os
import signal
import socket
import sys
import threading
import time

GRACE_S = 5.0  # wall, from the signal to the end of the process while it starts
GRACE_OF_NODE_S = 12.0  # wall; roslaunch waits for 15 s, and a thousand robots have much to unregister
LAST_GRACE_S = 2  # wall, whole: after that the kernel ends it
SIGNALS = (signal.SIGINT, signal.SIGTERM)


class ProcessEnd:
    """Takes the signals from now on. To be made once, in the main thread.

    ``on_signal(name)`` is called at the first signal, in a thread of its own; with ``None`` somebody else handles the
    signals, and here is only seen to it that the process ends.
    """

    def __init__(self, name, on_signal=None):
        self._name = name
        self._on_signal = on_signal
        self._grace_s = GRACE_S
        self.asked = threading.Event()  # a signal has come
        self.over = threading.Event()  # on_signal has returned
        self._receive, self._wake = socket.socketpair()
        self._wake.setblocking(False)
        if on_signal is not None:
            for number in SIGNALS:
                signal.signal(number, lambda _number, _frame: None)
        # The handler of the C library writes there, even while the main thread waits for a lock or for the disk.
        signal.set_wakeup_fd(self._wake.fileno(), warn_on_full_buffer=False)
        threading.Thread(target=self._await_signal, name='process_end', daemon=True).start()

    @property
    def is_in_service(self):
        """Whether the node is there for others."""
        return self._grace_s >= GRACE_OF_NODE_S

    def enter_service(self):
        """The node is there for others: its end may take longer from now on, as it has to say goodbye."""
        self._grace_s = GRACE_OF_NODE_S

    def _await_signal(self):
        while True:
            number = self._receive.recv(1)
            if number and number[0] in SIGNALS:
                break
        grace_s = self._grace_s
        self.hasten(grace_s)
        signal.alarm(int(grace_s) + LAST_GRACE_S)  # should the threads of Python no longer run
        self.asked.set()
        if self._on_signal is not None:
            self._on_signal(signal.Signals(number[0]).name)
        self.over.set()

    def hasten(self, seconds):
        """End the process in ``seconds`` [wall], if it has not ended by then. From any thread."""
        threading.Thread(target=self._end_at_last, args=(seconds,), daemon=True).start()

    def _end_at_last(self, grace_s):
        time.sleep(grace_s)
        leave(1, '{}: did not end within {:g} s of a signal; it is ended'.format(self._name, grace_s))


def leave(code, text=''):
    """End the process now, without waiting for threads: what they hold may never be given back."""
    try:
        if text:
            os.write(sys.stderr.fileno(), (text + '\n').encode('utf-8', 'backslashreplace'))
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
    except (OSError, ValueError, AttributeError):
        pass  # nobody reads it
    os._exit(code)

