"""A series of runs in lockstep: each ROSLaunchParent that a script starts becomes one, on a ROS master of its own."""
import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
import threading
from multiprocessing.connection import Connection

from roslaunch.core import RLException

from move_base_abstract.common import temporary
from move_base_abstract.common.errors import ConfigurationError

from .deputised_rospy import Deputised

_LOOK_S = 0.1  # wall
_END_S = 60.0  # wall, for a run to end after it was asked to


class Series:
    """The runs of one script, one after the other. ``code``: the worst exit code of lockstep_launch so far.

    ``program``: the path of lockstep_launch; ``options``: its options; ``folder``: for the event logs; ``name``: the
    name of the deputy, the node that takes part for the script.
    """

    def __init__(self, program, options, folder, name):
        self._program, self._options, self._folder, self._name = program, list(options), folder, name
        self._number = 0
        self._process = None
        self.deputised = Deputised()
        self.code = 0
        os.makedirs(folder, exist_ok=True)

    def start(self, files):
        """Start a run of ``files`` [(path, arguments)]; return when the deputy takes part.

        :raises RLException: if the run does not begin, another run is under way, or its event log exists already.
        """
        if self._process is not None and not self.deputised.is_under_way:
            self.finish()  # the last run has ended by itself, and the script goes on to the next
        if self._process is not None:
            raise RLException('another run is under way; each ROSLaunchParent of a script is a run of its own')
        self._number += 1
        log = os.path.join(self._folder, 'run_{:03d}.jsonl'.format(self._number))
        if os.path.lexists(log):
            raise RLException('{}: exists already; a series needs a folder without its logs'.format(log))
        print('lockstep_launch: run {}: {}; event log {}'.format(
            self._number, ' '.join(word for path, words in files for word in (path, *words)), log), flush=True)
        self._begin(files, log)

    def _begin(self, files, log):
        folder = temporary.make('series_')
        address = os.path.join(folder, 'deputy')
        with contextlib.ExitStack() as stack:
            stack.callback(temporary.remove, folder)
            door = stack.enter_context(socket.socket(socket.AF_UNIX))
            door.bind(address)
            door.listen(1)
            asked = json.dumps({'files': files, 'deputy': (self._name, address)})
            words = [sys.executable, self._program, *self._options, '--event-log', log, '--series', asked]
            if threading.current_thread() is threading.main_thread():  # the signal comes when its thread has ended
                words = ['setpriv', '--pdeathsig', 'TERM', '--', *words]
            process = self._process = subprocess.Popen(words, stdin=subprocess.DEVNULL)
            accepted = self._accept(door, process)
            accepted.settimeout(None)  # a script may have set a time limit for all its new sockets
            self.deputised.begin(Connection(accepted.detach()))

    def _accept(self, door, process):
        door.settimeout(_LOOK_S)
        while True:
            try:
                return door.accept()[0]
            except socket.timeout:
                if process.poll() is not None:
                    raise RLException('run {} did not begin: exit code {}'.format(
                        self._number, process.returncode)) from None

    def close(self):
        """Call the functions of on_shutdown and end the run that is under way: the script has come to its end."""
        self.deputised.run_hooks()
        self.finish(is_asked=True)

    def finish(self, is_asked=False):
        """Make the script leave its run, if there is one, wait for its end, and print its exit code.

        ``is_asked``: end the run by a signal if its deputy is not there yet or does what it was asked for, as it then
        does not notice that the script leaves; kill the run if it does not end in time.
        """
        process, self._process = self._process, None
        if process is None:
            return
        is_heard = self.deputised.is_under_way and not self.deputised.is_waiting
        if is_asked and not is_heard and not self.deputised.is_over and process.poll() is None:
            process.send_signal(signal.SIGINT)
        self.deputised.end()
        try:
            process.wait(_END_S if is_asked else None)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        self.code = max(self.code, abs(process.returncode))
        print('lockstep_launch: run {}: exit code {}'.format(self._number, process.returncode), flush=True)


class Parent:
    """Takes the place of roslaunch's ROSLaunchParent: start, spin, spin_once and shutdown of one run."""

    def __init__(self, series, run_id, roslaunch_files, *_args, roslaunch_strs=None, **_kwds):
        if roslaunch_strs:
            raise RLException('ROSLaunchParent: got roslaunch_strs; allowed in a series: files')
        self.run_id, self.roslaunch_files = run_id, roslaunch_files
        self._series = series
        self._has_run = False

    def start(self, _auto_terminate=True):
        """Begin the run; return when simulated time has begun."""
        self._series.start([_file(one) for one in self.roslaunch_files])
        self._has_run = True

    def spin_once(self):
        """Do nothing: the run needs no help from the script."""

    def spin(self):
        """Wait for the end of the run, in which the script does nothing any more."""
        try:
            self._series.deputised.ask('spin')
        except Exception as error:
            if self._series.deputised.is_under_way:
                raise ConfigurationError('the run cannot be waited for: {}'.format(error)) from error
        self.shutdown()

    def shutdown(self):
        """Leave the run, which ends at this instant of simulated time."""
        if self._has_run:
            self._has_run = False
            self._series.finish()


def _file(one):
    """Return (absolute path, arguments) of a launch file as roslaunch takes it: a path or (path, arguments)."""
    path, words = (one, []) if isinstance(one, str) else (one[0], list(one[1]))
    return os.path.abspath(path), words
