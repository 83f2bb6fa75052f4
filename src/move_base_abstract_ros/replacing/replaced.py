"""The one table of everything that is replaced in rospy, actionlib, rosgraph and Python's library, and how to do it.

Code that replaces something names its row here. A name without a row is an error. Each replacement was made for certain
sources of the original function, which are known by their digests. If a function has another source, a warning at the
start names it (:func:`unknown`). docs/replaced_names.md shows the table.
"""
from __future__ import annotations

import functools
import hashlib
import importlib
import inspect
import io
import sys
import textwrap
import tokenize
from contextlib import contextmanager
from typing import Any, Callable, Iterator, List, NamedTuple, Tuple

#: the first and the last version of Python in which these names are as the replacements need them
PYTHON = (3, 8), (3, 13)
#: the packages and versions whose digests are known
SOURCES = 'rospy and rosgraph 1.14.13 to 1.16.0 (Noetic; Debian 11 and 12), actionlib 1.12.0 to 1.14.0'

ALWAYS, START = 'each node of this package', 'a node of this package, while its topics are made'
NODES = 'each node of this package, and each program by the launcher, when it starts'
ROBOTS = 'move_base and fleet'
LOCKSTEP, THREADS = 'lockstep.join', 'lockstep.join, unless own_threads=False'
LAUNCHER = 'the launcher of unmodified programs'
OLD_LAUNCHER = 'the launcher of unmodified programs, before Python 3.11'
NEW_LAUNCHER = 'the launcher of unmodified programs, from Python 3.13 on'
SQLITE = 'the launcher of unmodified programs, when a program imports sqlite3'
LOOPS = 'the launcher of unmodified programs, when a program imports asyncio'
OLD_LOOPS = LOOPS + ', before Python 3.11'
NEW_LOOPS = LOOPS + ', from Python 3.12 on'
WARM = '`lockstep_launch`, and the warm process of an experiment and what it forks'
FUTURES = 'lockstep.join, when a program uses concurrent.futures'
PROCESSES = 'the launcher of unmodified programs, when a program imports multiprocessing'
POOLS = 'lockstep.join, when a program uses multiprocessing.pool'
SERIES = '`lockstep_launch --script`, for its script'


class Row(NamedTuple):
    """A replacement: the dotted name, where it is made, what it does, and the digests of the sources that it fits."""

    name: str
    where: str
    why: str
    digests: Tuple[str, ...] = ()


_WAIT = 'gives the turn away and ends at its instant'
_LOOK = 'is counted, so that time goes on in a loop that waits by looking'
_MASTER = ('makes parameters take effect with their rounds, and names nodes and topics in one order, after the other '
           'participants have done their work of this instant')
_CLOCK = 'goes on with simulated time, for the program'
_CHANCE = "follows from the run's seed and the node's name, for the program"
_ASKED = 'reports the file to the time master, as one that is read'
_SORTED = 'sorts the entries, which the file system gives in any order'
_ROUNDS = 'switches the collection of garbage, which comes after a number of rounds, on or off'
_TOLD = 'labels the run if the program calls it'
_IN_KERNEL = 'labels the run if the program waits there; a wait in vain counts as a sleep'
_HEARS = 'tells the time master whether feedback has any effect on an action client'
_NUMBERED = 'is hashed by number, so that sets of them have one order'
_TASKS = 'makes tasks of coroutines in the order in which they are given'
_UNCAUGHT = 'writes an exception that nothing catches into the event log'
_UNASKED = 'writes an exception of a job into the event log, if the program never asks for its outcome'
_CORES = 'returns 4 on every computer'
_OWN_CORES = 'works with the cores that the program itself may use, even if the time master keeps it on one of them'
_SQLITE = "makes the database's random numbers and dates those of the run"
_LOCK = 'gives the turn away if another thread of the program holds it'

def _rows(where: str, why: str, *names: str) -> Tuple[Row, ...]:
    return tuple(Row(name, where, why) for name in names)


_ROWS = (
    Row('rospy.timer.sleep', LOCKSTEP, _WAIT, ('6d1b0eff1e91',)),
    Row('rospy.client.spin', LOCKSTEP, _WAIT, ('4e9c93ad54d9',)),
    Row('rospy.client.wait_for_message', LOCKSTEP, _WAIT, ('7e61baa7221f',)),
    Row('rospy.impl.tcpros_service.wait_for_service', LOCKSTEP, _WAIT, ('0a8ab81f2f2e',)),
    Row('rospy.impl.tcpros_service.ServiceImpl.spin', LOCKSTEP, _WAIT, ('1a60155df3cc',)),
    Row('actionlib.action_client.ActionClient.wait_for_server', LOCKSTEP, _WAIT, ('7946c8265700', '294ce1de0c21',)),
    Row('actionlib.simple_action_client.SimpleActionClient.wait_for_result', LOCKSTEP, _WAIT, ('68a4d74e57db',)),
    Row('rospy.core.is_shutdown', LOCKSTEP, _LOOK, ('c4d7059b4598',)),
    Row('rospy.client.get_param', LOCKSTEP, _LOOK, ('4425b7119229',)),
    Row('rospy.client.has_param', LOCKSTEP, _LOOK, ('a34f14a3b5c3',)),
    Row('rospy.topics.Topic.get_num_connections', LOCKSTEP, _LOOK, ('a1d3c0d704d2',)),
    Row('rospy.rostime.get_rostime', LOCKSTEP, _LOOK, ('1ca9b068228d',)),
    Row('actionlib.simple_action_client.SimpleActionClient.get_state', LOCKSTEP, _LOOK, ('8ddbf0582784',)),
    Row('actionlib.action_client.ClientGoalHandle.get_comm_state', LOCKSTEP, _LOOK, ('fe126509fb64',)),
    Row('actionlib.action_client.ClientGoalHandle.get_goal_status', LOCKSTEP, _LOOK, ('13f65d38fe63',)),
    Row('rospy.topics._TopicManager._add', LOCKSTEP, 'tells the time master of a new topic', ('800cac69e502',)),
    Row('rospy.topics._TopicManager._remove', LOCKSTEP,
        'tells the time master that a topic is gone', ('de96b0e81978',)),
    Row('rospy.topics._SubscriberImpl.receive_callback', LOCKSTEP,
        'makes messages from outside wait for the next grant', ('8edd5c500e8a',)),
    Row('rospy.topics._PublisherImpl.add_connection', LOCKSTEP,
        'refuses connections between participants, and hides onlookers from the program', ('11f18204b563',)),
    Row('rospy.topics._PublisherImpl.publish', LOCKSTEP,
        'counts the messages of participants only, so that no onlooker changes a header', ('9486c44240ef',)),
    Row('rospy.topics._PublisherImpl.remove_connection', LOCKSTEP,
        'tells the program if a participant stops listening, not if an onlooker does', ('10b24a0193f3',)),
    Row('rospy.topics._SubscriberImpl.add_callback', LOCKSTEP, _HEARS, ('90f7f53760a6',)),
    Row('rospy.topics._SubscriberImpl.remove_callback', LOCKSTEP, _HEARS, ('228e3a0979b0',)),
    Row('actionlib.action_client.GoalManager.init_goal', LOCKSTEP, _HEARS, ('275ffe4ed965',)),
    Row('actionlib.simple_action_client.SimpleActionClient.feedback_cb', LOCKSTEP, _HEARS),
    Row('rospy.impl.tcpros_pubsub.TCPROSHandler.create_transport', LOCKSTEP,
        'makes no connections to participants', ('d7554043c626',)),
    Row('rospy.topics._TopicImpl.get_num_connections', LOCKSTEP,
        'counts each participant that listens, and no onlooker', ('f6d31ffea7a9',)),
    Row('rospy.topics._TopicImpl.has_connection', LOCKSTEP,
        'counts participants as connected; a goal topic of a large fleet never connects to itself', ('7dc485b6c037',)),
    Row('rospy.service.ServiceManager.register', LOCKSTEP,
        'tells the time master of a new service', ('954957f90e11',)),
    Row('rospy.service.ServiceManager.unregister', LOCKSTEP,
        'tells the time master that a service is gone', ('ec6728198a41',)),
    Row('rospy.impl.tcpros_service.ServiceImpl._handle_request', LOCKSTEP,
        'makes calls from outside wait for the next grant', ('0a5516683f10',)),
    Row('rospy.impl.tcpros_service.ServiceProxy.call', LOCKSTEP,
        'calls participants through the time master', ('5a5320897053', 'd9e4cd94b92c',)),
    Row('xmlrpc.client.ServerProxy._ServerProxy__request', LOCKSTEP, _MASTER),
    Row('rospy.core._LockedServerProxy._ServerProxy__request', LOCKSTEP, _MASTER, ('0167df407a53',)),
    Row('rospy.msproxy.MasterProxy.get_param_cached', LOCKSTEP,
        'asks the ROS master each time, because updates from the ROS master come by the wall clock', ('e537fa3e8378',)),
    Row('rospy.impl.simtime._set_rostime', LOCKSTEP,
        'does nothing: time comes with the grants, not on /clock', ('1d47ac6f2d40',)),
    Row('rospy.core.signal_shutdown', LOCKSTEP,
        'tells the time master first, if a signal or another node ends this one', ('1be84b9b1b33', '51e015a07699')),
    Row('os.kill', LOCKSTEP, 'tells the time master first, if the process ends itself'),
    Row('rospy.topics._SubscriberImpl._invoke_callback', LOCKSTEP, _UNCAUGHT, ('81c97c7de4c4',)),
    Row('rospy.impl.tcpros_service.ServiceImpl.error_handler', LOCKSTEP, _UNCAUGHT, ('0c79cd978086',)),
    *_rows(LOCKSTEP, _UNCAUGHT, 'actionlib.simple_action_server.SimpleActionServer.__init__',
           'actionlib.simple_action_server.SimpleActionServer.register_goal_callback',
           'actionlib.simple_action_server.SimpleActionServer.register_preempt_callback', 'threading.excepthook',
           'sys.unraisablehook'),
    *_rows(FUTURES, _UNASKED, 'concurrent.futures._base.Future.set_exception',
           'concurrent.futures._base.Future.result', 'concurrent.futures._base.Future.exception'),
    Row('concurrent.futures._base.Future.add_done_callback', FUTURES, _UNCAUGHT),
    *_rows(POOLS, _UNASKED, 'multiprocessing.pool.ApplyResult._set', 'multiprocessing.pool.MapResult._set',
           'multiprocessing.pool.ApplyResult.get', 'multiprocessing.pool.IMapIterator._set',
           'multiprocessing.pool.IMapUnorderedIterator._set', 'multiprocessing.pool.IMapIterator.next',
           'multiprocessing.pool.IMapIterator.__next__'),
    *_rows(LOCKSTEP, 'makes the process leave in its last round', 'threading._shutdown', 'os._exit'),
    Row('sys.excepthook', LOCKSTEP,
        _UNCAUGHT + '; keeps quiet about the end of lockstep, which is not an error of the program'),
    *_rows(THREADS, _LOCK, 'threading._allocate_lock', 'threading.Lock', 'threading.RLock', '_thread.allocate_lock',
           '_thread.allocate'),
    Row('queue.SimpleQueue', THREADS, 'is made of locks that give the turn away'),
    Row('threading._time', THREADS, "is simulated for time-outs of the program's threads"),
    Row('queue.time', THREADS, "is simulated for time-outs of the program's threads"),
    Row('threading.Thread.start', THREADS, 'makes a new thread wait for its first turn'),
    Row('_thread.start_new_thread', THREADS, "starts one of Python's threads for the program, which is followed"),
    Row('_thread.start_new', THREADS, "starts one of Python's threads for the program, which is followed"),
    Row('threading.Thread.join', THREADS, _WAIT),
    Row('threading.Thread.is_alive', THREADS, "returns False as soon as the thread's last turn is over"),
    Row('rospy.init_node', LAUNCHER, 'joins when the program has become a node', ('f5a98156fc52',)),
    Row('rospy.client.init_node', LAUNCHER, 'joins when the program has become a node', ('f5a98156fc52',)),
    Row('time.sleep', LAUNCHER, 'names once the place where the program sleeps, and is simulated if --sleep says so'),
    *_rows(LAUNCHER, _CLOCK, 'time.time', 'time.time_ns', 'time.monotonic', 'time.monotonic_ns', 'time.perf_counter',
           'time.perf_counter_ns', 'time.process_time', 'time.process_time_ns', 'time.thread_time',
           'time.thread_time_ns', 'time.clock_gettime', 'time.clock_gettime_ns', 'time.localtime', 'time.gmtime',
           'time.ctime', 'time.asctime', 'time.strftime'),
    *_rows(LAUNCHER, _CHANCE, 'os.urandom', 'random._urandom', 'random.Random.seed', 'random.seed', 'uuid.uuid1',
           'tempfile._get_candidate_names', 'os.getrandom'),
    Row('os.listdir', LAUNCHER, _SORTED),
    Row('os.scandir', LAUNCHER, _SORTED),
    Row('concurrent.futures._base.Future.__hash__', LAUNCHER, 'is a number, so that sets of futures have one order'),
    Row('gc.enable', LAUNCHER, _ROUNDS),
    Row('gc.disable', LAUNCHER, _ROUNDS),
    *_rows(LAUNCHER, _TOLD, 'os.getpid', 'os.getppid', 'os.times', 'os.getloadavg', 'resource.getrusage',
           'signal.setitimer', 'signal.alarm', 'signal.sigtimedwait',
           '_posixsubprocess.fork_exec', 'os.getpgrp', 'os.uname', 'os.sched_getaffinity', 'os.path.getmtime',
           'os.path.getctime', 'os.path.getatime', 'shutil.disk_usage', 'socket.gethostname', 'socket.getfqdn',
           'platform.node', 'getpass.getuser', 'uuid.getnode', 'threading.get_native_id', 'threading.active_count',
           'threading.enumerate'),
    *_rows(LAUNCHER, _IN_KERNEL, 'select.select', 'select.poll', 'select.epoll', 'selectors.SelectSelector.select',
           'selectors.PollSelector.select', 'selectors.EpollSelector.select', 'socket.socket.accept',
           'socket.socket.recv', 'socket.socket.recv_into', 'socket.socket.recvfrom', 'socket.socket.recvfrom_into'),
    Row('multiprocessing.connection.wait', PROCESSES, _IN_KERNEL),
    Row('multiprocessing.synchronize.SemLock._make_methods', PROCESSES,
        'makes locks wait as those of threading do, as long as the process has no children'),
    Row('rospy.get_node_uri', LAUNCHER, _TOLD),
    Row('os.readlink', LAUNCHER, 'labels the run for what lies in /dev, /proc and /sys'),
    *_rows(LAUNCHER, _ASKED, 'os.stat', 'os.lstat', 'os.access'),
    Row('traceback.TracebackException.__init__', LAUNCHER, 'leaves frames of lockstep out of tracebacks'),
    Row('logging.Formatter.__init__', LAUNCHER, 'labels the run if the log shows the number of a process or thread'),
    Row('threading.Thread.ident', LAUNCHER, 'labels the run if the program shows it, or orders anything by it'),
    Row('threading.Thread.native_id', LAUNCHER, _TOLD),
    *_rows(PROCESSES, _TOLD, 'multiprocessing.process.BaseProcess.ident', 'multiprocessing.process.BaseProcess.pid'),
    Row('os.sched_setaffinity', LAUNCHER, _OWN_CORES),
    Row('_imp.create_dynamic', LAUNCHER, _OWN_CORES),
    Row('rospy.msproxy.MasterProxy.__getitem__', LAUNCHER,
        'labels the run if the program asks for a value that roslaunch makes anew for each run'),
    Row('rosgraph.masterapi.Master.getParam', LAUNCHER,
        'labels the run if the program asks for a value that roslaunch makes anew for each run'),
    Row('os.sched_yield', LAUNCHER, 'is a sleep of 0 s'),
    Row('os.cpu_count', LAUNCHER, _CORES),
    Row('os.process_cpu_count', NEW_LAUNCHER, _CORES),
    Row('threading._newname', LAUNCHER, 'counts the threads that the program makes, without those of rospy'),
    Row('logging._logRecordFactory', LAUNCHER, "gives records of the program's log simulated time"),
    Row('importlib.machinery.SourceFileLoader.get_code', LAUNCHER,
        "compiles the program's own modules with calls that tell lockstep what it must know"),
    Row('importlib.machinery.SourceFileLoader.exec_module', LAUNCHER,
        "hashes objects of the module's classes by number, so that sets of them have one order"),
    *_rows(LAUNCHER, 'has zeros in it', 'numpy.empty', 'numpy.empty_like'),
    Row('sqlite3.connect', SQLITE, _SQLITE),
    Row('sqlite3.dbapi2.connect', SQLITE, _SQLITE),
    Row('pathlib._NormalAccessor.listdir', OLD_LAUNCHER, _SORTED),
    Row('pathlib._NormalAccessor.scandir', OLD_LAUNCHER, _SORTED),
    *_rows(OLD_LAUNCHER, _ASKED, 'pathlib._NormalAccessor.stat', 'pathlib._NormalAccessor.lstat'),
    Row('asyncio.base_events.BaseEventLoop.time', LOOPS, _CLOCK),
    Row('asyncio.selector_events.BaseSelectorEventLoop.__init__', LOOPS,
        'makes the loop wait in a selector that gives the turn away'),
    Row('asyncio.selector_events.BaseSelectorEventLoop._write_to_self', LOOPS,
        'wakes a loop that waits in such a selector'),
    Row('asyncio.unix_events._UnixSelectorEventLoop._handle_signal', LOOPS, 'labels the run'),
    Row('asyncio.events.TimerHandle.__init__', LOOPS, 'puts equal timers in the order in which they were made'),
    Row('asyncio.tasks.Task', LOOPS, _NUMBERED + '; ' + _UNASKED),
    Row('asyncio.futures.Future', LOOPS, _NUMBERED + '; ' + _UNASKED),
    Row('asyncio.base_events.BaseEventLoop.default_exception_handler', LOOPS, _UNCAUGHT),
    Row('asyncio.tasks._GatheringFuture.set_exception', LOOPS, _UNASKED),
    Row('asyncio.tasks.__sleep0', LOOPS, _LOOK),
    Row('asyncio.tasks.as_completed', LOOPS, _TASKS),
    Row('asyncio.tasks.wait', OLD_LOOPS, _TASKS),
    Row('asyncio.unix_events.can_use_pidfd', NEW_LOOPS, 'returns False, so that a thread waits for a child'),
    Row('roslib.packages.find_node', WARM, 'begins with the programs that were found before', ('11281a34f8c5',)),
    Row('multiprocessing.pool.Pool._wait_for_updates', POOLS, _WAIT),
    Row('roslaunch.parent.ROSLaunchParent', SERIES, 'is a run in lockstep on a ROS master of its own'),
    Row('roslaunch.scriptapi.ROSLaunch', SERIES,
        'is refused, because it starts nodes one by one, without a launch file'),
    Row('threading.Thread.isAlive', ALWAYS,
        'exists again in Python 3.9 and later, which have removed it: rospy of Debian 11 calls it'),
    Row('logging.Handler.handleError', ALWAYS, 'says once, in a line, that a log cannot be written'),
    Row('rosgraph.network.get_bind_address', NODES,
        'is the address that ROS announces, also if that is not a loopback address', ('023e614c77a8',)),
    Row('rospy.impl.init.time', NODES,
        'sleeps 1 ms between two checks whether the node is registered'),
    Row('rospy.impl.tcpros_base.TCPServer.run', NODES,
        'ends without an error if rospy shuts down before this thread has run its first line'),
    Row('rospy.impl.masterslave.ROSHandler._connect_topic', ROBOTS,
        'makes one connection to a publisher; rospy may make two and lose messages on the first', ('6b2504f73639',)),
    Row('rospy.impl.statistics.SubscriberStatisticsLogger.is_enabled', START,
        'asks the ROS master once, not for each topic', ('15476f9da7bc',)),
    Row('rospy.topics.Poller', START,
        'opens a file for a topic when its first connection comes'),
    Row('rospy.topics._TopicManager.check_all', START, 'skips topics without connections', ('0b251c450202',)),
)
ROWS = {row.name: row for row in _ROWS}
_done: List[str] = []
_unknown: List[str] = []


def replace(name: str, make: Callable[..., Any], on: Any = None) -> Any:
    """Put ``make(original)`` in the place of ``name``, in the one object ``on`` if given; return the original.

    :raises KeyError: if the table has no row of this name.
    """
    owner, attribute = _place(name)
    original = getattr(owner if on is None else on, attribute, None)
    note(name, original)
    setattr(owner if on is None else on, attribute, make(original))
    return original


@contextmanager
def replaced(name: str, make: Callable[..., Any], on: Any = None) -> Iterator[None]:
    """Do the same as :func:`replace` inside a context, and undo it at the end."""
    owner, attribute = _place(name)
    target = owner if on is None else on
    before = inspect.getattr_static(target, attribute) if on is None else getattr(target, attribute)
    replace(name, make, on)
    try:
        yield
    finally:
        setattr(target, attribute, before)


def note(name: str, original: Any) -> None:
    """Note that ``name`` is about to be replaced, and whether ``original`` is known.

    :raises KeyError: if the table has no row of this name.
    """
    row = ROWS[name]
    if name not in _done:
        _done.append(name)
        if row.digests and digest(original) not in row.digests:
            _unknown.append(name)


def look_up() -> None:
    """Compute the digests that :func:`note` needs of imported modules, for processes that are forked from this one."""
    for row in _ROWS:
        if row.digests and any(row.name.startswith(module + '.') for module in sys.modules):
            owner, attribute = _place(row.name)
            digest(getattr(owner, attribute, None))


def name_of(function: Callable[..., Any]) -> str:
    """Return the dotted name of a function or method."""
    return '{}.{}'.format(function.__module__, function.__qualname__)


def done() -> Tuple[str, ...]:
    """Return the names that have been replaced in this process, in the order of the replacements."""
    return tuple(_done)


def unknown() -> str:
    """Return a text that names the replaced functions with an unknown source, and an unknown Python; '' if none."""
    found = list(_unknown)
    if not PYTHON[0] <= sys.version_info[:2] <= PYTHON[1]:
        found.append('Python {}.{}'.format(*sys.version_info[:2]))
    if not found:
        return ''
    return ('{} {} not known to this version of move_base_abstract, which replaces them: the results of our tests '
            'may not hold. Known: {}; Python {}.{} to {}.{}'.format(
                ', '.join(found), 'is' if len(found) == 1 else 'are', SOURCES, *PYTHON[0], *PYTHON[1]))


@functools.lru_cache(maxsize=None)
def digest(function: Callable[..., Any]) -> str:
    """Return a digest of a function's source without comments, docstring and white space; '' if there is no source."""
    try:
        source = textwrap.dedent(inspect.getsource(inspect.unwrap(function)))
        tokens = list(_words(source))
    except (OSError, TypeError, SyntaxError, tokenize.TokenError):
        return ''
    return hashlib.sha256(' '.join(tokens).encode('utf-8')).hexdigest()[:12]


_SILENT = frozenset((tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT,
                     tokenize.ENDMARKER))


def _words(source: str) -> Iterator[str]:
    before = ''
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type in _SILENT:
            continue
        is_docstring = token.type == tokenize.STRING and before == ':' and token.line.lstrip()[:1] in '"\''
        before = token.string
        if not is_docstring:
            yield token.string


@functools.lru_cache(maxsize=None)
def _place(name: str) -> Tuple[Any, str]:
    """Return (the object that has the last part of a dotted name, that part)."""
    *path, attribute = name.split('.')
    for length in range(len(path), 0, -1):
        try:
            owner = importlib.import_module('.'.join(path[:length]))
        except ImportError:
            continue
        return functools.reduce(getattr, path[length:], owner), attribute
    raise ImportError('{}: no such module'.format(name))
