"""The processes of one run of a Plan: the ROS master, the time master, nodes, and how they ended.

They are children of this process, which has one thread until all of them are started. A Python node is a fork of this
process if that is the same as a start (see warm_nodes).
"""
import json
import math
import os
import select
import signal
import subprocess
import sys
import time
from typing import NamedTuple, Tuple

import rospkg
from roslaunch.core import is_machine_local, setup_env
from roslaunch.node_args import NodeParamsException

from move_base_abstract.common import processes
from move_base_abstract.common.errors import SimulatorError
from move_base_abstract.runs import ends

from ..loopback import find_executable
from ..process.ros_master_watch import is_answering
from . import roles, ros_master, warm_nodes
from .plan import TIME_MASTER, keep_to_this_user

#: kinds of a Problem: a required onlooker has ended, a participant before time started, the ROS master, the wall time
REQUIRED, ABSENT, MASTER, LIMIT = 'required', 'absent', 'master', 'limit'
_LAST_BYTES = 1 << 16  # the last line of a log is shorter
_LOOK_S = 0.02  # wall
_AGAIN_S = 0.1  # wall; a node with respawn is not started more often
_ASK_EVERY_S, _SILENT_S = 5.0, 3.0  # wall; the ROS master is asked whether it answers
_BEFORE_START_S = 5.0  # wall; the time in which the time master must answer
_TIME_MASTER_S = 5.0  # wall; the time in which it must end after a signal


class Problem(NamedTuple):
    """Why a run did not come to its end, in words. ``name``, ``code``: of the process that has ended, or ''."""

    kind: str
    text: str
    name: str = ''
    code: int = 0


class Patience(NamedTuple):
    """How long processes may take when the run is over [s, wall]: to end by themselves, and after a signal."""

    by_themselves: float
    after_signal: float


class Command(NamedTuple):
    """A program that is started beside the nodes. ``names``: the participants that it may start."""

    name: str
    words: list
    takes_part: bool
    names: Tuple[str, ...] = ()


class _Process:
    """A node or a Command, and each of its starts."""

    def __init__(self, name, takes_part, output, node=None, command=None):
        self.name, self.takes_part, self.output, self.node, self.command = name, takes_part, output, node, command
        self.pids, self.words = [], []
        self.early = ()  # the process ids that had ended when the run was over
        self.shown = ()  # lines printed by then that show uncaught exceptions
        self.is_told = False  # whether it got a signal from us
        self.due = math.inf  # when it is started again; time.monotonic()

    def tell(self, number):
        """Send a signal to the process and to its group."""
        if not self.is_told:
            self.output.told()
        self.is_told = True
        processes.signal_group(self.pids[-1], number)

    def ended(self, statuses):
        """Return its ends.Process when it has ended, or could not be ended. ``statuses``: {pid: status of waitpid}."""
        codes = {pid: processes.code_of(statuses[pid]) for pid in self.pids if pid in statuses}
        code = next((codes[pid] for pid in self.early if codes[pid]), codes.get(self.pids[-1]))
        return ends.Process(self.name, self.takes_part, code, bool(self.early), self.is_told,
                            self.output.printed() if code else (), self.shown,
                            names=self.command.names if self.command is not None else (),
                            is_shell=self.node is not None and roles.is_shell(self.node),
                            looks_on=not self.takes_part and self.name != TIME_MASTER,
                            only_displays=self.node is not None and roles.is_display(self.node))


class Run:
    """The processes of a run of ``plan``. ``log``: the path of its event log; ``outputs``: outputs.Files or .Screen.

    ``own``: a folder that this run alone has; a run with a ROS master of its own has its secret there.
    ``note``: the path of the file that the time master writes when time starts. ``is_warm``: whether nodes may be
    forks. ``is_quick``: whether the time master is killed when its log is complete, instead of waiting for its end.
    ``heeds_onlookers``: whether a node that is required and looks on ends the run.
    """

    def __init__(self, plan, log, outputs, patience, own, note='', is_warm=True, is_quick=True,
                 heeds_onlookers=True):
        self._plan, self._log, self._outputs, self._patience, self._own = plan, log, outputs, patience, own
        self._note, self._is_warm, self._is_quick = note, is_warm, is_quick
        self._heeds_onlookers = heeds_onlookers
        self._pause = outputs.pause
        self._statuses = {}  # {pid: status as of os.waitpid()}
        self._looked_at = set()  # process ids
        self._processes = []  # the time master first
        self._launcher = find_executable('lockstep')
        self._master = None  # process id of the ROS master
        self._is_asked = False
        self._ask_at = time.monotonic() + _ASK_EVERY_S
        self.uri = ''

    def start(self, uri='', commands=()):
        """Start a ROS master, unless there is one at ``uri``; set the parameters; start all nodes, then Commands.

        :raises SimulatorError: if something cannot be started.
        """
        processes.adopt_orphans()
        if not uri:
            keep_to_this_user(self._plan, self._own)
            self._master, uri = ros_master.start(self._outputs.of_master)
        self.uri = os.environ['ROS_MASTER_URI'] = uri
        self._outputs.begun(uri)
        config = self._plan.config
        for one in config.executables:  # of <rosparam command="delete"> and "dump"
            subprocess.run([one.command, *one.args], check=False)
        words = self._words_of_nodes()
        ros_master.set_parameters(uri, [(one.key, one.value) for one in config.params.values()], config.clear_params)
        for node in sorted(config.nodes, key=lambda node: not roles.is_time_master(node)):
            if self._is_asked:
                return
            name = roles.name_of(node)
            if name in words:
                output = self._outputs.of(name, node)
                self._add(_Process(name, name in self._plan.participants, output, node), words[name])
        for number, command in enumerate(commands):
            output = self._outputs.of('command_{}'.format(number))
            self._add(_Process(command.name, command.takes_part, output, command=command), command.words)

    def _words_of_nodes(self):
        """Return {name: words of its command} of each node that is started here."""
        found = {}
        for node in self._plan.config.nodes:
            if is_machine_local(node.machine):
                try:
                    found[roles.name_of(node)] = roles.command_of(node)
                except (NodeParamsException, ValueError) as error:  # plan_of() has refused it, so it has just gone
                    raise SimulatorError('{} cannot be started: {}'.format(roles.name_of(node), error)) from None
        return found

    def _add(self, one, words):
        one.words = words if one.node is None else [*words, '__log:=' + one.output.log]
        self._processes.append(one)
        self._begin(one)
        if self._plan.is_reversed and one.takes_part and one.node is not None:
            ros_master.await_registered(self.uri, one.pids[-1], one.name, self._statuses)

    def _begin(self, one):
        environment, cwd, node = dict(os.environ), rospkg.get_ros_home(), one.node
        if node is not None:
            environment = setup_env(node, node.machine, self.uri)
            cwd = roles.folder_of(node, one.words, self._launcher) if node.cwd == 'node' else cwd
        os.makedirs(cwd, exist_ok=True)
        one.output.prepare()
        one.pids.append(warm_nodes.start(one.words, environment, one.output.enter, cwd, self._launcher,
                                         self._is_warm and node is not None))
        one.output.started(one.pids[-1])

    def stop(self):
        """End the waiting of wait(): the user asks for the end. A handler of signals may call this."""
        self._is_asked = True

    def wait(self, limit=math.inf):
        """Wait until the run is over; return None, or a Problem that ends it before. ``limit``: [s, wall]."""
        deadline = time.monotonic() + limit
        processes.block_child_signal()
        while not self._is_asked and not self.is_over():
            self._look()
            self._tell_of_silence()
            if self._master in self._statuses:
                return Problem(MASTER, 'the ROS master ended: ' + ends.described(self._code(self._master)))
            problems = [self._problem_of(one) for one in self._news()]
            if time.monotonic() > deadline:
                problems.append(Problem(LIMIT, 'it was not over after {:g} s of wall time'.format(limit)))
            problem = next(filter(None, problems), None)
            if problem is not None:
                return problem
        return None

    def _tell_of_silence(self):
        """Say once that our ROS master does not answer: nodes that start, or ask it, wait for it without a word."""
        if self._master is None or not self._note or time.monotonic() < self._ask_at:
            return
        self._ask_at = time.monotonic() + _ASK_EVERY_S
        if not is_answering(self.uri, 'lockstep', _SILENT_S):
            self._ask_at = math.inf
            print('lockstep: the ROS master at {} has not answered for {:g} s; the nodes that start or ask it wait for '
                  'it'.format(self.uri, _SILENT_S), file=sys.stderr, flush=True)

    def await_end(self, limit):
        """Wait until the run is over, whatever ends meanwhile, at most ``limit`` [s, wall]."""
        deadline = time.monotonic() + limit
        while self._processes and not self.is_over() and time.monotonic() < deadline:
            self._look()

    def is_over(self):
        """Return whether the time master has ended; or has no more to do, because its log is complete (is_quick)."""
        return self._time_master in self._statuses or self._is_quick and _is_complete(self._log)

    @property
    def _time_master(self):
        return self._processes[0].pids[-1]

    def gone(self):
        """Return (name, exit code, last lines) of the time master or a participant that has ended, or None."""
        processes.reap(self._statuses)
        for one in self._processes:
            if (one.takes_part or one is self._processes[0]) and one.pids[-1] in self._statuses:
                return one.name, self._code(one.pids[-1]), one.output.printed()
        return None

    def end(self, patience=None):
        """End all, time first: no node goes on by the clock. Return ends.Processes. ``patience``: not the run's own."""
        self._patience = patience or self._patience
        self._news()
        self._pause(0.0)
        for one in self._processes:
            one.early = [pid for pid in one.pids if pid in self._statuses]
            one.shown = () if one.takes_part else one.output.shown()
            one.due = math.inf
        if self._processes:
            self._end_time_master()
            self._end_others()
        return [one.ended(self._statuses) for one in self._processes]

    def _end_time_master(self):
        if self._time_master in self._statuses:
            return
        if self._is_quick and _is_complete(self._log):
            processes.end([self._time_master], signal.SIGKILL, 1.0, self._statuses)
            self._statuses[self._time_master] = 0
        else:
            processes.end([self._time_master], signal.SIGINT, _TIME_MASTER_S, self._statuses, self._pause)

    def _end_others(self):
        """Tell onlookers to end, and give participants time to end by themselves; then tell those that are left."""
        left = [one for one in self._processes if one.pids[-1] not in self._statuses]
        for one in left:
            if not one.takes_part:
                one.tell(signal.SIGINT)
            elif one.node is not None and not roles.has_last_words(one.node):
                one.tell(signal.SIGKILL)
        processes.await_ends({one.pids[-1] for one in left}, self._patience.by_themselves, self._statuses, self._pause)
        if not self._is_asked:
            self._news()
        left = [one for one in left if one.pids[-1] not in self._statuses]
        for one in left:
            one.tell(signal.SIGINT)
        processes.await_ends({one.pids[-1] for one in left}, self._patience.after_signal, self._statuses, self._pause)
        processes.end([one.pids[-1] for one in left], signal.SIGKILL, 1.0, self._statuses, self._pause)
        self._pause(0.0)

    @property
    def has_failed(self):
        """Whether the time master says that the run did not end as wished. To be called after end()."""
        return not self._processes or self._code(self._time_master) != 0

    @property
    def code_of_time_master(self):
        """The exit code of the time master, in words. To be called after end()."""
        return ends.described(self._code(self._time_master))

    def printed(self, name):
        """Return the last lines that a process has printed."""
        self._pause(0.0)  # it may have ended since the last look
        return next(one.output.printed() for one in self._processes if one.name == name)

    def _look(self):
        """Note which processes have ended, start those again that the launch file says; wait a little if there is none.

        Only this starts nodes while others run, and it reads what they print. So all nodes that are started before have
        the same memory in each run.
        """
        if not processes.reap(self._statuses):
            self._pause(_LOOK_S)
        for one in self._processes:
            if one.due <= time.monotonic():
                one.due = math.inf
                self._begin(one)

    def _news(self):
        """Return the processes that have ended since the last call, without the time master; say so."""
        found = []
        for one in self._processes:
            pid = one.pids[-1]
            if pid in self._statuses and pid not in self._looked_at:
                self._looked_at.add(pid)
                if not one.is_told:
                    self._say_end(one, pid)
                if one.node is not None and one.node.respawn and not one.node.required:
                    one.due = time.monotonic() + max(_AGAIN_S, one.node.respawn_delay)
                if one.name != TIME_MASTER:
                    found.append(one)
        return found

    def _say_end(self, one, pid):
        """Say that a process has ended. One that ended with the run has not died, unless the run is to end with it."""
        is_required = one.name != TIME_MASTER and one.node is not None and one.node.required and not (
            roles.is_deputy(one.node))
        is_over = self._time_master in self._statuses or _is_complete(self._log)
        if is_required or one.name == TIME_MASTER or not is_over:
            one.output.ended(pid, self._code(pid), one.words, is_required)
        else:
            one.output.told()

    def _problem_of(self, one):
        """Return the Problem if a process must not end while the run goes on, or None."""
        code = self._code(one.pids[-1])
        if one.node is not None and one.node.required and not one.takes_part and self._heeds_onlookers:
            return Problem(REQUIRED, '{}, which is required and looks on, ended (exit code {})'.format(one.name, code),
                           one.name, code)
        if not one.takes_part or os.path.exists(self._note):
            return None
        if one.command is not None:
            text = '{} ended with exit code {}'.format(one.name, code)
            return Problem(ABSENT, text, one.name, code) if code else None
        names = _not_there_yet(self._statuses)
        if names is not None and one.name not in names:
            return Problem(ABSENT, '{} ended (exit code {}) before it took part, so time never starts'.format(
                one.name, code), one.name, code)
        return None

    def _code(self, pid):
        return processes.code_of(self._statuses[pid])


def _not_there_yet(statuses):
    """Return the participants that are there while the time master waits for others. ``statuses``: of processes.

    None if time has started, or if the time master does not answer. Another process asks, because this one must not
    have threads.
    """
    read, write = os.pipe()

    def ask():
        os.write(write, json.dumps(_present(_BEFORE_START_S)).encode())
    pid = processes.fork(ask, os.devnull)
    os.close(write)
    with os.fdopen(read, 'rb') as stream:  # without a ROS master, rospy would ask for one without end
        text = stream.read() if select.select([read], [], [], 2.0 * _BEFORE_START_S)[0] else b''
    processes.end([pid], signal.SIGKILL, 1.0, statuses)
    return json.loads(text) if text else None


def enter(logs, home):
    """Make this process, and all that it starts, use 127.0.0.1, one thread for sums, and these folders of ROS."""
    for name in ('ROS_HOSTNAME', 'ROS_NAMESPACE'):
        os.environ.pop(name, None)
    os.environ.update(ROS_IP='127.0.0.1', ROS_LOG_DIR=logs, ROS_HOME=home, PYTHONUNBUFFERED='1',
                      ROSCONSOLE_STDOUT_LINE_BUFFERED='1', **processes.ONE_THREAD)


def _is_complete(path):
    """Return whether a run has ended without a fault and its event log is complete.

    The time master has nothing more to do then, and may be killed; roscpp's own end takes a third of a second.
    """
    try:
        with open(path, 'rb') as stream:
            stream.seek(max(0, os.fstat(stream.fileno()).st_size - _LAST_BYTES))
            end = json.loads(stream.read().splitlines()[-1])['end']
    except (OSError, ValueError, LookupError, TypeError):
        return False
    return not end.get('by_fault')


def _present(timeout):
    """Return the names of the participants if the time master waits for more; None if not.

    :param timeout: how long it may take to answer [s, wall]; its state is latched.
    """
    import rospy

    from move_base_abstract.msg import TimeState
    rospy.init_node('run', anonymous=True, disable_rostime=True, disable_signals=True, disable_rosout=True)
    try:
        state = rospy.wait_for_message(TIME_MASTER + '/state', TimeState, timeout)
    except (rospy.ROSException, OSError):
        return None
    return [one.name for one in state.participants] if state.phase == 'waiting_for_participants' else None
