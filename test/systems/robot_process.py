"""Starts an executable of this package in a process of its own, with parameters; has its output and its end."""
import os
import signal
import tempfile
import time

import rospy
import warm
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
        descriptor, self._path = tempfile.mkstemp(suffix='.out')
        with open(descriptor, 'wb') as output:
            self._process = warm.start(command, output, dict(os.environ, PYTHONUNBUFFERED='1'))

    @property
    def output(self):
        """All lines of output so far."""
        with open(self._path, errors='replace') as stream:
            return stream.read()

    def wait_for_line(self, text):
        """Wait for the first line that holds ``text``, and return it."""
        deadline = time.monotonic() + GUARD
        while True:
            for line in self.output.splitlines(True):
                if text in line and line.endswith('\n'):
                    return line
            assert time.monotonic() < deadline, 'no line with {!r} in:\n{}'.format(text, self.output)
            time.sleep(0.01)

    def exit_code(self):
        """Wait for the end, and return the exit code."""
        code = self._process.wait(GUARD)
        self._process.release()
        return code

    def end(self, with_signal=signal.SIGINT):
        """End the process by a signal, and wait for its end."""
        if self._process.poll() is None:
            self._process.send_signal(with_signal)
        return self.exit_code()
