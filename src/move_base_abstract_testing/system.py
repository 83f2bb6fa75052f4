"""The processes of one test's run (ROS master, time master, robots, the user's nodes), and how they ended.

They are children of this process. A node is forked if that has the same effect as starting it. This process has a
single thread until all of them are started.
"""
import contextlib
import itertools
import json
import os
import re
import signal
import sys
import time
from typing import Any, Dict, Iterator, List, NamedTuple

from roslaunch.core import Param, RLException, setup_env
from roslaunch.node_args import NodeParamsException, create_local_process_args

from move_base_abstract.common import processes
from move_base_abstract.common.errors import ConfigurationError, SimulatorError
from move_base_abstract.common.options import parameters_of
from move_base_abstract.radio import network
from move_base_abstract.runs import ends
from move_base_abstract_experiments.description import launch_files
from move_base_abstract_ros.launching import look_ups, plan, roles, ros_master, warm_nodes
from move_base_abstract_ros.loopback import find_executable

from .launch_text import TEST, launch_text
from .settings import DEPARTURE, Settings

_FILE = re.compile(r'[^\w.-]+', re.ASCII)
_LAST_BYTES = 1 << 16
_OVER_S = 30.0  # wall; the time master may take so long to end a run that is over
_OWN_END_S, _POLITE_S = 3.0, 1.0  # wall, for nodes to end by themselves, and after a signal
_LOOK_S = 0.005  # wall


class _Process(NamedTuple):
    name: str
    pid: int
    takes_part: bool
    output: str  # path of the file into which it prints
    is_shell: bool
    has_last_words: bool


class System:
    """The processes of a run. They are started by the constructor, and ended by :meth:`end`."""

    def __init__(self, settings: Settings, folder: str) -> None:
        """Start all processes. ``folder`` is an empty folder, into which the run writes all its files.

        :raises SimulatorError: if a process cannot be started.
        """
        self.log = os.path.join(folder, 'events.jsonl')
        self._folder, self._settings = folder, settings
        self._statuses: Dict[int, int] = {}
        self._processes: List[_Process] = []
        self._ends: List[ends.End] = []
        processes.adopt_orphans()
        _enter(folder)
        self._master, self.uri = ros_master.start(os.path.join(folder, 'rosmaster.txt'))
        os.environ['ROS_MASTER_URI'] = self.uri
        made = self._plan()
        ros_master.set_parameters(self.uri, [(one.key, one.value) for one in made.config.params.values()])
        launcher = find_executable('lockstep')
        for node in sorted(made.config.nodes, key=lambda node: not roles.is_time_master(node)):
            self._start(node, roles.name_of(node) in made.participants, launcher)

    def _plan(self) -> Any:
        path = os.path.join(self._folder, 'test.launch')
        with open(path, 'x', encoding='utf-8') as stream:
            stream.write(launch_text(self._settings))
        look_ups.remember()
        plan.name_anonymous_ones_alike()
        settings = self._settings
        try:
            config = plan.read([path], settings.tolerant or settings.adopt)
            named = plan.TIME_MASTER + '/participants'
            others = config.params[named].value if named in config.params else ()
            config.params[named] = Param(named, [*others, TEST])
            end = {'end_with': [TEST]} if settings.until == DEPARTURE else settings.end
            options = plan.launch_options(settings, {
                **network.resolve(parameters_of(settings), settings.folder), 'event_log': self.log,
                'log_messages': settings.log_messages, **end, **settings.time_master}, no_respawn=True)
            return plan.plan_of(config, launch_files.adopted(config, options) if settings.adopt else options)
        except RLException as error:
            raise ConfigurationError(str(error)) from None

    def _start(self, node: Any, takes_part: bool, launcher: str) -> None:
        name = roles.name_of(node)
        try:
            words = create_local_process_args(node, node.machine)
        except (NodeParamsException, ValueError) as error:
            raise SimulatorError('{} cannot be started: {}'.format(name, error)) from None
        output = os.path.join(self._folder, _FILE.sub('-', name.strip('/')) + '.txt')
        words.append('__log:=' + output[:-len('txt')] + 'log')
        with _python_outputs():
            pid, _ = warm_nodes.start(words, setup_env(node, node.machine, self.uri), output, self._folder, launcher,
                                      os.path.dirname(launcher))
        self._processes.append(_Process(name, pid, takes_part, output, roles.is_shell(node),
                                        roles.has_last_words(node)))

    @contextlib.contextmanager
    def watched(self) -> Iterator[None]:
        """Give a context in which the main thread gets an error if the time master or a participant ends.

        Without it time would wait for ever for a participant that has ended before the start.

        :raises SimulatorError: with the name of the process, and the last lines that it has printed.
        """
        def look(*_signal: Any) -> None:
            processes.reap(self._statuses)
            needed = [*self._processes[:1], *(one for one in self._processes if one.takes_part)]  # the time master
            gone = [one for one in needed if one.pid in self._statuses]
            if gone:
                raise SimulatorError('\n'.join(['{} ended ({}) before time started; it printed last:'.format(
                    gone[0].name, ends.described(processes.code_of(self._statuses[gone[0].pid]))),
                    *_last_lines(gone[0].output)]))
        before = signal.signal(signal.SIGCHLD, look)
        try:
            look()
            yield
        finally:
            signal.signal(signal.SIGCHLD, before)

    def end(self) -> List[ends.End]:
        """Wait until the time master has written the log, end all processes, and return how each of them ended."""
        if self._processes:
            time_master = self._processes[0]
            deadline = time.monotonic() + _OVER_S
            while not self._is_written() and time_master.pid not in self._statuses and time.monotonic() < deadline:
                if not processes.reap(self._statuses):
                    time.sleep(_LOOK_S)
            early = set(self._statuses)
            processes.end([time_master.pid], signal.SIGKILL, _POLITE_S, self._statuses)
            killed = [one.pid for one in self._processes[1:] if not one.has_last_words and one.pid not in early]
            processes.end(killed, signal.SIGKILL, _POLITE_S, self._statuses)
            others = {one.pid for one in self._processes[1:]} - set(self._statuses)
            told = {*killed, *self._end_others(others)}
            made = [self._process(one, early, told) for one in self._processes[1:]]
            self._processes = []
            self._ends = ends.judge(made, ends.read_log(self.log))
        processes.end_all_children()
        return self._ends

    def _end_others(self, others: Any) -> Any:
        """Give the other processes time to end by themselves. Return the pids of those that had to get a signal."""
        processes.await_ends(set(others), _OWN_END_S, self._statuses)
        left = others - set(self._statuses)
        if left:
            processes.end(list(left), signal.SIGINT, _POLITE_S, self._statuses)
        return left

    def _is_written(self) -> bool:
        try:
            with open(self.log, 'rb') as stream:
                stream.seek(max(0, os.fstat(stream.fileno()).st_size - _LAST_BYTES))
                return 'end' in json.loads(stream.read().splitlines()[-1])
        except (OSError, ValueError, LookupError, TypeError):
            return False

    def _process(self, one: _Process, early: Any, told: Any) -> ends.Process:
        code = processes.code_of(self._statuses[one.pid]) if one.pid in self._statuses else None
        return ends.Process(one.name, one.takes_part, code, one.pid in early, one.pid in told,
                            tuple(_last_lines(one.output)) if code else (), is_shell=one.is_shell)


@contextlib.contextmanager
def _python_outputs() -> Iterator[None]:
    """Give a context in which a fork prints into its own file, and not into pytest's capture of a test's output."""
    ours = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = sys.__stdout__, sys.__stderr__
    try:
        yield
    finally:
        sys.stdout, sys.stderr = ours


def _enter(folder: str) -> None:
    """Make this process and its children use the loopback address, and write into the run's folder."""
    for name in ('ROS_HOSTNAME', 'ROS_NAMESPACE'):
        os.environ.pop(name, None)
    os.environ.update(ROS_IP='127.0.0.1', ROS_LOG_DIR=folder, ROS_HOME=folder, PYTHONUNBUFFERED='1',
                      ROSCONSOLE_STDOUT_LINE_BUFFERED='1', **processes.ONE_THREAD)


def _last_lines(path: str) -> List[str]:
    with contextlib.suppress(OSError), open(path, 'rb') as stream:
        stream.seek(max(0, os.fstat(stream.fileno()).st_size - _LAST_BYTES))
        lines = stream.read().decode('utf-8', 'replace').splitlines()
        return list(itertools.islice((line for line in lines if line.strip()), max(0, len(lines) - ends.LAST_LINES),
                                     None))
    return []
