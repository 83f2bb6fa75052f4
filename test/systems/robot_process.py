"""Starts an executable of this package in a process of its own, with parameters; has its output and its end."""
import os
import signal
import subprocess
import threading
import time

import rospy
from robot_harness import GUARD

from move_base_abstract_ros.loopback import find_executable


class RobotProcess:
    """An executable of this package in a process of its own."""

    def __init__(self, executable, parameters, arguments, namespace):
        self.namespace = namespace
        self.private = '{}/move_base'.format(self.namespace)
        if parameters is not None:
            rospy.set_param(self.private, parameters)
        command = [find_executable(executable), *arguments, '__ns:=' + (self.namespace or '/'), '__name:=move_base']
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                         env=dict(os.environ, PYTHONUNBUFFERED='1'))
        self._lines = []
        self._more = threading.Condition()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        for line in self._process.stdout:
            with self._more:
                self._lines.append(line)
                self._more.notify_all()

    @property
    def output(self):
        """All lines of output so far."""
        with self._more:
            return ''.join(self._lines)

    def wait_for_line(self, text):
        """Wait for the first line that holds ``text``, and return it."""
        deadline = time.monotonic() + GUARD
        with self._more:
            while True:
                for line in self._lines:
                    if text in line:
                        return line
                left = deadline - time.monotonic()
                assert left > 0.0, 'no line with {!r} in:\n{}'.format(text, ''.join(self._lines))
                self._more.wait(left)

    def exit_code(self):
        """Wait for the end, and return the exit code."""
        return self._process.wait(GUARD)

    def end(self, with_signal=signal.SIGINT):
        """End the process by a signal, and wait for its end."""
        if self._process.poll() is None:
            self._process.send_signal(with_signal)
        return self.exit_code()
