"""One run of a launch file or a command in lockstep, from its start to its end; called in a process of its own.

There is no `roslaunch` process. roslaunch's own loader reads the file, the package `launching` changes it, and its
nodes are started from here. When run() returns, everything that was started has ended.
"""
from __future__ import annotations

import contextlib
import itertools
import json
import os
import re
import shlex
import signal
import time
from typing import Any, Dict, List, NamedTuple, Optional, Set, Tuple

from move_base_abstract.common import processes
from move_base_abstract.runs import ends
from move_base_abstract_ros.launching import ros_master, warm_nodes
from move_base_abstract_ros.launching.conditions import Condition

from ..description.job import Job
from . import run_plan, termination
from .metrics import Starts
from .run_folders import Folders
from .run_plan import Run
from .termination import RunError

Statuses = Dict[int, int]  # {pid: status as of os.waitpid()}
_END_RECORD_BYTES = 1 << 16  # the last line of a log is shorter
_ONLOOKER_GRACE_S = 5.0  # wall
_OWN_END_S = 6.0  # wall; the time in which participants may end by themselves when the run is over
_LOOK_S = 0.02  # wall
_BEFORE_START_S = 5.0  # wall; the time in which the time master must answer
_NODE_FILE = re.compile(r'[^\w.-]+', re.ASCII)


class Ended(NamedTuple):
    """A run that has ended.

    ``starts``: where robots stood at the start, as far as parameters say it. ``processes``: how each ended.
    ``problem``: why the run failed, or None.
    """

    starts: Starts
    processes: List[ends.Process]
    problem: Optional[RunError]


class _Process(NamedTuple):
    name: str
    pid: int
    takes_part: bool
    is_required: bool
    output: str  # the path of the file for its prints
    has_last_words: bool = True  # whether it may have something to do when the run is over
    names: Tuple[str, ...] = ()  # for a command: the names of the participants that it may start
    is_command: bool = False  # whether it is a command and no node of a launch file
    is_shell: bool = False  # whether it is a shell that starts the node


def run(job: Job, folders: Folders, condition: Optional[Condition] = None) -> Ended:
    """Run a Job's launch file or command to its end.

    condition: the condition of a second run, in which each node is started as a program; None: the first run.
    :raises SimulatorError: if it cannot be started.
    """
    this = Run(job, folders, condition)
    processes.adopt_orphans()
    processes.block_child_signal()
    try:
        _enter(folders)
        master, uri = ros_master.start(os.path.join(folders.logs, 'rosmaster.txt'))
        os.environ['ROS_MASTER_URI'] = uri
        config, taking = run_plan.plan_of(this)
        ros_master.set_parameters(uri, [(param.key, param.value) for param in config.params.values()])
        statuses: Statuses = {}
        started = _start_all(config, taking, uri, this, statuses)
        ended = Ended(run_plan.starts_of(config), *_await_end(master, started, this, statuses))
        _tell_bags(this)
        return ended
    finally:
        processes.end_all_children()


def _enter(folders: Folders) -> None:
    """Let this process, and all that it starts, use 127.0.0.1 and the run's folders."""
    for name in ('ROS_HOSTNAME', 'ROS_NAMESPACE'):
        os.environ.pop(name, None)
    os.environ.update(ROS_IP='127.0.0.1', ROS_LOG_DIR=folders.logs, ROS_HOME=folders.files,
                      PYTHONUNBUFFERED='1', ROSCONSOLE_STDOUT_LINE_BUFFERED='1', **processes.ONE_THREAD)


def _tell_bags(run: Run) -> None:
    """Write the digests of the bags that participants have written into the event log."""
    from move_base_abstract_ros.launching import bags
    bags.add_to_log(run.folders.log, bags.written(run.path(run_plan.BAG_NOTES)))


def _start_all(config: Any, taking: List[str], uri: str, run: Run, statuses: Statuses) -> List[_Process]:
    """Start the time master and all nodes; return them as _Process objects, the time master first.

    ``statuses`` gets the processes that have ended meanwhile.
    """
    from roslaunch.core import setup_env
    from roslaunch.node_args import NodeParamsException, create_local_process_args

    from move_base_abstract_ros.launching import roles
    from move_base_abstract_ros.loopback import find_executable
    launcher, folders = find_executable('lockstep'), run.folders
    started = []
    for node in sorted(config.nodes, key=lambda node: not roles.is_time_master(node)):
        name = roles.name_of(node)
        if node.machine_name and node.machine_name not in ('localhost', 'local'):
            continue
        stem = _NODE_FILE.sub('-', name.strip('/'))
        try:
            words = create_local_process_args(node, node.machine)
        except (NodeParamsException, ValueError) as error:
            raise RunError(f'{name} cannot be started: {error}') from None
        words.append('__log:=' + os.path.join(folders.logs, stem + '.log'))
        cwd = os.path.dirname(words[0]) if node.cwd == 'node' else folders.files
        output = os.path.join(folders.logs, stem + '.txt')
        pid, _ = warm_nodes.start(words, setup_env(node, node.machine, uri), output, cwd, launcher,
                                  os.path.dirname(launcher), run.job.is_warm and run.condition is None)
        started.append(_Process(name, pid, name in taking, bool(node.required), output,
                                roles.has_last_words(node), is_shell=roles.is_shell(node)))
        if run.is_reversed and name in taking:
            ros_master.await_registered(uri, pid, name, statuses)
    command = run.job.trial.command
    for number, words in enumerate(words for words in (command, list(run.job.onlooker)) if words):
        output = os.path.join(folders.logs, f'command_{number}.txt')
        pid = processes.execute(words, dict(os.environ), output, folders.files)
        started.append(_Process('the command ' + shlex.quote(words[0]), pid, words is command, False, output,
                                names=run.experiment.participants or () if words is command else (), is_command=True))
    return started


def _await_end(master: int, started: List[_Process], run: Run,
               statuses: Statuses) -> Tuple[List[ends.Process], Optional[RunError]]:
    """Wait until the time master has ended, then end all others; return (ends.Processes, why it failed or None)."""
    time_master, folders, limit = started[0], run.folders, run.experiment.time_limit
    deadline = time.monotonic() + limit
    seen: Set[int] = set()
    problem: Optional[RunError] = None
    while problem is None and time_master.pid not in statuses and not is_over(folders):
        if not processes.reap(statuses):
            processes.await_child(_LOOK_S)
        for process in started:
            if process.pid in statuses and process.pid not in seen and process is not time_master:
                seen.add(process.pid)
                problem = problem or _judge(process, statuses, run)
        if master in statuses:
            problem = problem or RunError(
                f'the ROS master ended: {ends.described(processes.code_of(statuses[master]))}')
        if time.monotonic() > deadline:
            problem = problem or RunError(f'it was not over after {limit:g} s of wall time (time_limit)',
                                          termination.TIME_LIMIT)
    early = set(statuses)
    shown = {one.pid: _shown_by(one.output) for one in started if not one.takes_part}
    if problem is None:
        if time_master.pid not in statuses:
            processes.end([time_master.pid], signal.SIGKILL, 1.0, statuses)
            statuses[time_master.pid] = 0
        code = processes.code_of(statuses[time_master.pid])
        problem = None if code == 0 else RunError('the run did not end as wished: the time master: '
                                                  + ends.described(code))
    else:
        processes.end([time_master.pid], signal.SIGINT, _ONLOOKER_GRACE_S, statuses)
    told = _end_others(started, statuses)
    return [_ended(one, statuses, early, told, shown) for one in started], problem


def _ended(one: _Process, statuses: Statuses, early: Set[int], told: Set[int],
           shown: Dict[int, Tuple[str, ...]]) -> ends.Process:
    """Return the ends.Process of a _Process that has ended, or could not be ended."""
    code = processes.code_of(statuses[one.pid]) if one.pid in statuses else None
    return ends.Process(one.name, one.takes_part, code, one.pid in early, one.pid in told,
                        _last_lines(one.output) if code else (), shown.get(one.pid, ()), names=one.names,
                        is_shell=one.is_shell)


def _last_lines(path: str) -> Tuple[str, ...]:
    """Return the last lines of a process's output."""
    with contextlib.suppress(OSError), open(path, 'rb') as stream:
        stream.seek(max(0, os.fstat(stream.fileno()).st_size - _END_RECORD_BYTES))
        lines = stream.read().decode('utf-8', 'replace').splitlines()
        return tuple([line for line in lines if line.strip()][-ends.LAST_LINES:])
    return ()


def _shown_by(path: str) -> Tuple[str, ...]:
    """Return the first lines of a process's output that show uncaught exceptions."""
    with contextlib.suppress(OSError), open(path, encoding='utf-8', errors='replace') as stream:
        return tuple(itertools.islice(filter(ends.shows_uncaught, stream), ends.LAST_LINES))
    return ()


def is_over(folders: Folders) -> bool:
    """Return whether a run has ended without a fault and its event log is complete.

    The time master has nothing more to do then, and may be killed; roscpp's own end takes a third of a second.
    """
    try:
        with open(folders.log, 'rb') as stream:
            stream.seek(max(0, os.fstat(stream.fileno()).st_size - _END_RECORD_BYTES))
            end = json.loads(stream.read().splitlines()[-1])['end']
    except (OSError, ValueError, LookupError, TypeError):
        return False
    return not end.get('by_fault')


def _judge(process: _Process, statuses: Statuses, run: Run) -> Optional[RunError]:
    """Return the error if a process must not end while the run goes on, or None."""
    code = processes.code_of(statuses[process.pid])
    if process.is_required and not process.takes_part:
        return RunError(f'{process.name}, which is required and looks on, ended (exit code {code})')
    if process.takes_part and not os.path.exists(run.path(run_plan.START_NOTE)):
        if process.is_command:
            return RunError(f'{process.name} ended with exit code {code}') if code else None
        names = _not_there_yet(statuses)
        if names is not None and process.name not in names:
            return RunError(f'{process.name} ended (exit code {code}) before it took part, so time never starts')
    return None


def _not_there_yet(statuses: Statuses) -> Optional[List[str]]:
    """Return the participants that are there while the time master waits for others.

    None if time has started, or if the time master does not answer. Another process asks, because this one must not
    have threads.
    """
    read, write = os.pipe()

    def ask() -> None:
        from move_base_abstract_ros.launching.runner import ask_state
        state = ask_state(_BEFORE_START_S)
        is_waiting = state is not None and state.phase == 'waiting_for_participants'
        os.write(write, json.dumps([one.name for one in state.participants] if is_waiting else None).encode())
    pid = processes.fork(ask, os.devnull)
    os.close(write)
    with os.fdopen(read, 'rb') as stream:
        text = stream.read()
    processes.end([pid], signal.SIGKILL, 1.0, statuses)
    return json.loads(text) if text else None


def _end_others(started: List[_Process], statuses: Statuses) -> Set[int]:
    """End the onlookers by SIGINT, and give the participants time to end by themselves.

    Return the process IDs that got a signal.
    """
    onlookers = [one.pid for one in started if not one.takes_part and one.pid not in statuses]
    for pid in onlookers:
        processes.signal_group(pid, signal.SIGINT)
    killed = [one.pid for one in started if not one.has_last_words and one.pid not in statuses]
    for pid in killed:
        processes.signal_group(pid, signal.SIGKILL)
    taking = [one.pid for one in started if one.takes_part and one.pid not in statuses]
    processes.await_ends({*taking, *onlookers}, _OWN_END_S, statuses)
    left = [pid for pid in (*taking, *onlookers) if pid not in statuses]
    if left:
        processes.end(left, signal.SIGINT, 1.0, statuses)
    return {*onlookers, *killed, *left}
