"""Starts programs in processes of their own; has their output and their end."""
import os
import signal
import tempfile

import rospy
import warm
from waiting import GUARD, wait_for

from move_base_abstract_ros.loopback import find_executable


class Started:
    """A program that runs, with its output so far and its end."""

    def __init__(self, command, environment=None, cwd=None):
        """Start it; environment, cwd: this process's own if None."""
        descriptor, self._path = tempfile.mkstemp(suffix='.out')
        with open(descriptor, 'wb') as output:
            self._process = warm.start(command, output, dict(environment or os.environ, PYTHONUNBUFFERED='1'), cwd)

    @property
    def output(self):
        """All lines of output so far."""
        with open(self._path, errors='replace') as stream:
            return stream.read()

    def wait_for_line(self, text):
        """Wait for the first line that holds ``text``, and return it."""
        return wait_for(lambda: 'a line with {!r} in:\n{}'.format(text, self.output), lambda: next(
            (line for line in self.output.splitlines(True) if text in line and line.endswith('\n')), None))

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


class RobotProcess(Started):
    """An executable of this package that is a robot, with parameters."""

    def __init__(self, executable, parameters, arguments, namespace):
        self.namespace = namespace
        self.private = '{}/move_base'.format(self.namespace)
        if parameters is not None:
            rospy.set_param(self.private, parameters)
        super().__init__([find_executable(executable), *arguments, '__ns:=' + (self.namespace or '/'),
                          '__name:=move_base'])
