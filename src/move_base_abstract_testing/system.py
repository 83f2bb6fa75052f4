"""The processes of one test's run (ROS master, time master, robots, the user's nodes), and how they ended.

They are children of this process. A node is forked if that has the same effect as starting it. This process has a
single thread until all of them are started.
"""
import contextlib
import math
import os
import signal
import time
from typing import Any, Iterator, List
from xml.sax.saxutils import quoteattr

from roslaunch.core import Param, RLException

from move_base_abstract.common import processes
from move_base_abstract.common.errors import ConfigurationError, SimulatorError
from move_base_abstract.common.options import parameters_of
from move_base_abstract.common.own_files import whole_file
from move_base_abstract.config.settings import read_settings
from move_base_abstract.radio import network
from move_base_abstract.runs import ends
from move_base_abstract_ros.debugging import MASTER_NOTE
from move_base_abstract_ros.launching import adoption, look_ups, plan, roles
from move_base_abstract_ros.launching.outputs import Files
from move_base_abstract_ros.launching.run import Patience, Run, enter
from move_base_abstract_ros.loopback import PACKAGE

from . import debugged
from .failing import DECISIONS
from .settings import DEPARTURE, Settings

TEST = '/test'  # the name of the test's own node
_OVER_S = 30.0  # wall; the time master may take so long to end a run that ends with its test
_AGAIN_S = 0.5  # wall
_BY_THEMSELVES_S, _AFTER_SIGNAL_S = 3.0, 1.0  # wall; how long processes may take when the run is over


class System:
    """The processes of a run. They are started by the constructor, and ended by :meth:`end`."""

    def __init__(self, settings: Settings, folder: str) -> None:
        """Start all processes. ``folder`` is an empty folder, into which the run writes all its files.

        :raises SimulatorError: if a process cannot be started.
        """
        self._debugged = debugged.asked()
        self.log = self._debugged.log if self._debugged else os.path.join(folder, 'events.jsonl')
        self._folder, self._settings = folder, settings
        self._ends: List[ends.End] = []
        enter(folder, folder)
        made = self._plan()
        #: the names of the nodes whose programs are not of this package
        self.nodes_of_user = [roles.name_of(node) for node in made.config.nodes if node.package != PACKAGE]
        #: the paths of launch files and programs
        self.files = [*made.config.roslaunch_files, *plan.programs_of(made)]
        self._run = Run(made, self.log, Files(folder), Patience(_BY_THEMSELVES_S, _AFTER_SIGNAL_S), folder)
        self._run.start()
        if self._debugged:
            with whole_file(os.path.join(self._debugged.notes, MASTER_NOTE)) as stream:
                stream.write(self._run.uri)

    def _plan(self) -> Any:
        path = os.path.join(self._folder, 'test.launch')
        with open(path, 'x', encoding='utf-8') as stream:
            stream.write(_launch_text(self._settings))
        look_ups.remember()
        plan.name_anonymous_ones_alike()
        settings = self._settings
        try:
            config = plan.read([path], settings.tolerant or settings.adopt)
            named = plan.TIME_MASTER + '/participants'
            others = config.params[named].value if named in config.params else ()
            config.params[named] = Param(named, [*others, TEST])
            decisions = {'chaos_decisions': os.path.join(self._folder, DECISIONS)} if settings.chaos_seed else {}
            end = {'end_with': [TEST]} if settings.until == DEPARTURE else settings.end
            options = plan.launch_options(settings, {
                **network.resolve(parameters_of(settings), settings.folder), 'event_log': self.log,
                'log_messages': settings.log_messages, **end, **decisions, **settings.time_master,
                **(self._debugged.parameters if self._debugged else {})}, no_respawn=True)
            if settings.adopt:
                options = adoption.adopted(config, options, read_settings)
            return plan.plan_of(config, options)
        except RLException as error:
            raise ConfigurationError(str(error)) from None

    @contextlib.contextmanager
    def watched(self) -> Iterator[None]:
        """Give a context in which the main thread gets an error if the time master or a participant ends.

        Without it time would wait for ever for a participant that has ended before the start.

        :raises SimulatorError: with the name of the process, and the last lines that it has printed.
        """
        def look(*_signal: Any) -> None:
            gone = self._run.gone()
            if gone:
                if os.fork() == 0:  # its end is the next signal, if somebody catches all exceptions and waits on
                    time.sleep(_AGAIN_S)
                    os._exit(0)
                name, code, lines = gone
                raise SimulatorError('\n'.join(['{} ended ({}) before time started; it printed last:'.format(
                    name, ends.described(code)), *lines]))
        before = signal.signal(signal.SIGCHLD, look)
        try:
            look()
            yield
        finally:
            signal.signal(signal.SIGCHLD, before)

    def end(self) -> List[ends.End]:
        """Wait until the time master has written the log, end all processes, and return how each of them ended.

        A run that ends by itself takes as long as it takes, within the test's ``wall_limit``.
        """
        if not self._ends:
            is_soon = self._settings.until == DEPARTURE and not self._debugged
            self._run.await_end(_OVER_S if is_soon else math.inf)
            self._ends = ends.judge(self._run.end(), ends.read_log(self.log))
        processes.end_all_children()
        return self._ends


def _launch_text(settings: Settings) -> str:
    """Return the launch file as XML. It starts the robots and nodes, and includes the test's own launch file."""
    lines = ['<launch>']
    if settings.scenario:
        lines += ['  <node pkg="move_base_abstract" type="fleet" name="fleet">',
                  '    <param name="scenario" value={}/>'.format(quoteattr(settings.scenario)), '  </node>']
    for number, words in enumerate(settings.nodes):
        kind, _, args = words.partition(' ')
        package, name = kind.split('/')
        others = [one for one in settings.nodes[:number] if one.split()[0] == kind]
        lines.append('  <node pkg={} type={} name={}{}/>'.format(
            quoteattr(package), quoteattr(name),
            quoteattr(name.partition('.')[0] + ('_{}'.format(len(others) + 1) if others else '')),
            ' args=' + quoteattr(args) if args.strip() else ''))
    if settings.launch:
        lines.append('  <include file={}>'.format(quoteattr(settings.launch)))
        lines += ['    <arg name={} value={}/>'.format(quoteattr(name), quoteattr(_word(value)))
                  for name, value in settings.args.items()]
        lines.append('  </include>')
    return '\n'.join([*lines, '</launch>', ''])


def _word(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
