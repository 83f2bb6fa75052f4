"""One run of a launch file or a command in lockstep, from nothing to its end; called in a process of its own.

No `roslaunch` process: the file is read by roslaunch's own loader, changed by the room `launching`, and its nodes are
started from here. Everything that was started is gone when run() returns.
"""
import contextlib
import fnmatch
import itertools
import json
import os
import re
import shlex
import signal
import time
from typing import NamedTuple

from move_base_abstract.common.errors import SimulatorError
from move_base_abstract_ros.launching import ends, processes, ros_master, warm_nodes
from move_base_abstract_ros.loopback import PACKAGE

from ..description import launch_files

LOG_MOTION, PARTICIPANTS = '/log_motion', '/time_master/participants'
END_NODE, RECORDER_NODE = '/experiment_end', '/experiment_recorder'
LOG, MESSAGES = 'events.jsonl', 'messages.jsonl'
_BAG_NOTES = 'bags'  # in which nodes name the bags that they write
_END_RECORD_BYTES = 1 << 16  # a log's last line is shorter
_ONLOOKER_GRACE_S = 5.0  # wall
_OWN_END_S = 6.0  # wall, that participants may take to end by themselves once the run is over
_LOOK_S = 0.02  # wall
_BEFORE_START_S = 5.0  # wall, that the time master may take to be asked
_NODE_FILE = re.compile(r'[^\w.-]+', re.ASCII)


#: this package's own nodes that are done when the run is over: what they know is in the event log, or written already
_WITHOUT_LAST_WORDS = tuple((PACKAGE, kind) for kind in (
    'move_base', 'fleet', 'task_server', 'task_source', 'move_base_abstract_actionserver', 'end_at_message',
    'message_recorder'))


class RunError(SimulatorError):
    """A run that could not be started, or did not come to its end."""


class Wanted(NamedTuple):
    """What is to be run. Words are filled in already."""

    files: list  # [(path, [ARG:=VALUE])] of roslaunch, or empty
    command: tuple
    participants: object  # names, or None: all
    leave_out: tuple
    replace: tuple  # ((package, type), (package, type))
    seed: int
    sleep: str
    until: object  # spec.Until
    record: object  # spec.Record
    time_limit: float  # s, wall
    is_warm: bool = True
    condition: object = None  # of launching.conditions
    speed_limit: float = 0.0  # times real time; 0: none
    lookahead: float = 0.0  # s, simulated; 0: none
    cores: str = ''  # of the time master; '': as the launch file has it
    stored_topics: tuple = ()
    extra: tuple = ()  # words of a program that looks on, such as RViz


class Ended(NamedTuple):
    """Where robots stood first as far as parameters say it, how its processes ended, and why it failed, or None."""

    starts: dict  # {robot: (x, y)} [m]
    processes: list  # of launching.ends.Process
    problem: object


class _Process(NamedTuple):
    name: str
    pid: int
    takes_part: bool
    is_required: bool
    output: str  # path of the file of what it prints
    has_last_words: bool = True  # whether it may have something to do once the run is over
    names: tuple = ()  # of the participants that it may be, if it is a command
    is_shell: bool = False  # which starts the node


def run(wanted, folders):
    """Run it to its end; return an Ended.

    :raises SimulatorError: if it cannot be started.
    """
    processes.adopt_orphans()
    processes.block_child_signal()
    try:
        _enter(folders)
        master, uri = ros_master.start(os.path.join(folders.logs, 'rosmaster.txt'))
        os.environ['ROS_MASTER_URI'] = uri
        config, taking = _plan(wanted, folders)
        ros_master.set_parameters(uri, [(param.key, param.value) for param in config.params.values()])
        statuses = {}
        started = _start_all(config, taking, uri, wanted, folders, statuses)
        ended = Ended(_starts(config), *_await_end(master, started, wanted, folders, statuses))
        _tell_bags(folders)
        return ended
    finally:
        processes.end_all_children()


def _enter(folders):
    """Have this process, and all that it starts, use this computer's own address and the run's folders."""
    for name in ('ROS_HOSTNAME', 'ROS_NAMESPACE'):
        os.environ.pop(name, None)
    os.environ.update(ROS_IP='127.0.0.1', ROS_LOG_DIR=folders.logs, ROS_HOME=folders.files,
                      PYTHONUNBUFFERED='1', ROSCONSOLE_STDOUT_LINE_BUFFERED='1', **warm_nodes.ONE_THREAD)


def _plan(wanted, folders):
    """Return roslaunch's configuration, changed for lockstep, and the names of who takes part."""
    from move_base_abstract_ros.launching import plan
    plan.name_anonymous_ones_alike()
    config = launch_files.read(wanted.files)
    _add_own_nodes(config, wanted, folders)
    wishes = _wishes(plan, config, wanted, folders)
    return config, plan.plan_of(config, wishes).participants


def _add_own_nodes(config, wanted, folders):
    from roslaunch.core import Node, Param
    if wanted.record.motion and LOG_MOTION not in config.params:
        config.params[LOG_MOTION] = Param(LOG_MOTION, True)
    if wanted.command:  # it is no node of a launch file, which would say who takes part
        config.params[PARTICIPANTS] = Param(PARTICIPANTS, list(wanted.participants))

    def add(name, kind, parameters, required):
        node = Node(PACKAGE, kind, name=name.lstrip('/'), required=required)
        node.machine = config.machines['']
        config.nodes.append(node)
        for key, value in parameters.items():
            config.params[f'{name}/{key}'] = Param(f'{name}/{key}', value)
    if wanted.until.topic:
        add(END_NODE, 'end_at_message', {'topic': wanted.until.topic}, True)
    if wanted.record.messages:
        add(RECORDER_NODE, 'message_recorder', {'topics': list(wanted.record.messages),
                                                'path': os.path.join(folders.own, MESSAGES)}, False)


def _wishes(plan, config, wanted, folders):
    from move_base_abstract_ros.launching import bags, roles
    start_s = config.params.get('/time_master/start_time')
    start_s = 1.0 if start_s is None else start_s.value
    parameters = {'event_log': os.path.join(folders.own, LOG), 'log_messages': wanted.record.hashes or None,
                  'end_when_idle': wanted.until.idle or None, 'speed_limit': wanted.speed_limit or None,
                  'lookahead': wanted.lookahead or None, 'cores': wanted.cores or None,
                  'stored_topics': list(wanted.stored_topics) or None,
                  'end_at': start_s + wanted.until.seconds if wanted.until.seconds else None}
    names = [roles.name_of(node) for node in config.nodes]
    forced, kept_out = (), ()
    if wanted.participants is not None and not wanted.command:
        own = [name for name in (END_NODE, RECORDER_NODE) if name in names]
        forced = wanted.participants
        kept_out = tuple(name for node, name in zip(config.nodes, names) if name not in (*forced, *own)
                         and not roles.is_time_master(node))
    condition = wanted.condition
    own_environment = ()
    notes = os.path.join(folders.own, _BAG_NOTES)
    with open(notes, 'xb'):
        pass
    if condition is not None and '--own-hash-seed' in condition.options:
        own_environment = (('PYTHONHASHSEED', condition.options[condition.options.index('--own-hash-seed') + 1]),)
    return plan.Wishes(parameters={key: value for key, value in parameters.items() if value is not None},
                       launcher=('--sleep', wanted.sleep, '--seed', str(wanted.seed)), forced=forced,
                       kept_out=kept_out, left_out=wanted.leave_out, replaced=wanted.replace,
                       environment=((bags.VARIABLE, notes), *(condition.environment if condition is not None else ())),
                       is_reversed=_is_reversed(wanted),
                       own_environment=own_environment)


def _is_reversed(wanted):
    """Return whether nodes start one after another, in the reverse order."""
    return wanted.condition is not None and '--start-order' in wanted.condition.options


def _tell_bags(folders):
    """Write the digests of the bags of those who took part into the event log."""
    from move_base_abstract_ros.launching import bags
    bags.add_to_log(os.path.join(folders.own, LOG), bags.written(os.path.join(folders.own, _BAG_NOTES)))


def _start_all(config, taking, uri, wanted, folders, statuses):
    """Start the time master and all nodes; return them as _Process objects, the time master first.

    Into ``statuses`` go those that have ended meanwhile.
    """
    from roslaunch.core import setup_env
    from roslaunch.node_args import NodeParamsException, create_local_process_args

    from move_base_abstract_ros.launching import roles
    from move_base_abstract_ros.loopback import find_executable
    launcher = find_executable('lockstep')
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
                                  os.path.dirname(launcher), wanted.is_warm)
        started.append(_Process(name, pid, name in taking, bool(node.required), output,
                                (node.package, node.type) not in _WITHOUT_LAST_WORDS, is_shell=roles.is_shell(node)))
        if _is_reversed(wanted) and name in taking:
            ros_master.await_registered(uri, pid, name, statuses)
    for number, words in enumerate(words for words in (wanted.command, wanted.extra) if words):
        output = os.path.join(folders.logs, f'command_{number}.txt')
        pid = processes.execute(list(words), dict(os.environ), output, folders.files)
        started.append(_Process('the command ' + shlex.quote(words[0]), pid, bool(wanted.command), False, output,
                                names=tuple(wanted.participants or ()) if wanted.command else ()))
    return started


def _await_end(master, started, wanted, folders, statuses):
    """Wait until the time master has ended, end everybody; return (ends.Processes, why it failed or None)."""
    time_master = started[0]
    deadline = time.monotonic() + wanted.time_limit
    seen, problem = set(), None
    while problem is None and time_master.pid not in statuses and not is_over(folders):
        if not processes.reap(statuses):
            processes.await_child(_LOOK_S)
        for process in started:
            if process.pid in statuses and process.pid not in seen and process is not time_master:
                seen.add(process.pid)
                problem = problem or _judge(process, statuses, folders)
        if master in statuses:
            problem = problem or f'the ROS master ended: {ends.described(processes.code_of(statuses[master]))}'
        if time.monotonic() > deadline:
            problem = problem or f'it was not over after {wanted.time_limit:g} s of wall time (time_limit)'
    early = set(statuses)
    shown = {one.pid: _shown_by(one.output) for one in started if not one.takes_part}
    if problem is None:
        if time_master.pid not in statuses:
            processes.end([time_master.pid], signal.SIGKILL, 1.0, statuses)
            statuses[time_master.pid] = 0
        code = processes.code_of(statuses[time_master.pid])
        problem = None if code == 0 else 'the run did not end as wished: the time master: ' + ends.described(code)
    else:
        processes.end([time_master.pid], signal.SIGINT, _ONLOOKER_GRACE_S, statuses)
    told = _end_others(started, statuses)
    return [_ended(one, statuses, early, told, shown) for one in started], problem


def _ended(one, statuses, early, told, shown):
    """Return the ends.Process of a _Process that has ended, or was killed in vain."""
    code = processes.code_of(statuses[one.pid]) if one.pid in statuses else None
    return ends.Process(one.name, one.takes_part, code, one.pid in early, one.pid in told,
                        _last_lines(one.output) if code else (), shown.get(one.pid, ()), names=one.names,
                        is_shell=one.is_shell)


def _last_lines(path):
    """Return the last lines of a process's output."""
    with contextlib.suppress(OSError), open(path, 'rb') as stream:
        stream.seek(max(0, os.fstat(stream.fileno()).st_size - _END_RECORD_BYTES))
        lines = stream.read().decode('utf-8', 'replace').splitlines()
        return tuple([line for line in lines if line.strip()][-ends.LAST_LINES:])
    return ()


def _shown_by(path):
    """Return the first lines of a process's output that show exceptions which nobody caught."""
    with contextlib.suppress(OSError), open(path, encoding='utf-8', errors='replace') as stream:
        return tuple(itertools.islice(filter(ends.shows_uncaught, stream), ends.LAST_LINES))
    return ()


def is_over(folders):
    """Return whether the event log of a run that ended as wished is complete: its time master has nothing more to do.

    It may be killed then; roscpp's own end takes a third of a second.
    """
    try:
        with open(os.path.join(folders.own, LOG), 'rb') as stream:
            stream.seek(max(0, os.fstat(stream.fileno()).st_size - _END_RECORD_BYTES))
            end = json.loads(stream.read().splitlines()[-1])['end']
    except (OSError, ValueError, LookupError, TypeError):
        return False
    return not end.get('by_fault')


def _judge(process, statuses, folders):
    """Return what is wrong with the end of a process while the run goes on, or None."""
    code = processes.code_of(statuses[process.pid])
    if process.is_required and not process.takes_part:
        return f'{process.name}, which is required and looks on, ended (exit code {code})'
    if process.takes_part and not _has_started(folders):
        names = _not_there_yet(statuses)
        if names is not None and process.name not in names and not process.name.startswith('the command'):
            return f'{process.name} ended (exit code {code}) before it took part, so that time never starts'
        if process.name.startswith('the command') and code:
            return f'{process.name} ended with exit code {code}'
    return None


def _has_started(folders):
    """Return whether the time master has said that time has started; it says so at once."""
    try:
        with open(os.path.join(folders.logs, 'time_master.txt'), encoding='utf-8', errors='replace') as stream:
            return any('the clock starts at' in line for line in stream)
    except OSError:
        return False


def _not_there_yet(statuses):
    """Return who takes part while the time master waits for others; None once time has started, or if it is mute.

    A process of its own asks: this one has no thread.
    """
    read, write = os.pipe()

    def ask():
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


def _end_others(started, statuses):
    """End who looks on, politely, and give those who take part the time to end by themselves.

    Return who got a signal.
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


def _starts(config):
    """Return {robot: (x, y)} [m] of the robots that parameters name: of a move_base each, or of a fleet."""
    found = {}
    for key, param in config.params.items():
        node, _, name = key.rpartition('/')
        if node.endswith('/move_base'):
            values = [config.params.get(f'{node}/{one}') for one in ('start_x', 'start_y')]
            found[node.rpartition('/')[0].strip('/')] = _place([None if one is None else one.value for one in values])
        elif name == 'robots' and isinstance(param.value, list):
            found.update((one['name'], _place([one.get('start_x'), one.get('start_y')]))
                         for one in param.value if isinstance(one, dict) and isinstance(one.get('name'), str))
    return found


def _place(values):
    with contextlib.suppress(TypeError, ValueError):
        return tuple(0.0 if value is None else float(value) for value in values)
    return None


def names_to_keep(folders, patterns):
    """Return the names in the nodes' working folder that one of the patterns fits, but for folders, sorted."""
    return [name for name in sorted(os.listdir(folders.files))
            if any(fnmatch.fnmatchcase(name, pattern) for pattern in patterns)
            and not os.path.isdir(os.path.join(folders.files, name))]
