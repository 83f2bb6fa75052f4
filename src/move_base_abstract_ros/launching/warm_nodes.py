"""Start a node as a program, or, if the result is the same, as a fork of this process, which has all imports done.

The process that is forked was started with one order of sets, one layout of memory and our library in front of libc
(wants_start), as the launcher of unmodified programs starts each of them.

A fork is possible for our launcher of Python programs and for this package's own nodes, if the node's environment asks
for the settings with which this process was started. Everything else is started as a program.
"""
import builtins
import contextlib
import functools
import gc
import importlib
import io
import os
import re
import signal
import sys
import tempfile
import types

from move_base_abstract.common import guard, processes

from ..lockstep.programs import address_layout, native_library

_FIXED = ('PYTHON', 'LD_', 'MALLOC_', 'GLIBC_', 'OMP_', 'OPENBLAS_', 'MKL_', 'BLIS_', 'NUMEXPR_', 'LC_', 'LANG', 'TZ',
          'MOVE_BASE_ABSTRACT_ADDRESS_LAYOUT')
_HASH_SEED = 'PYTHONHASHSEED'
_LOG_SETTINGS = 'ROS_PYTHON_LOG_CONFIG_FILE'
_OWN_NODES = 'move_base_abstract_ros.nodes'
_OWN_NODE = re.compile(rb"^ *start\('(\w+)'\)", re.MULTILINE)
_SPACE = ' ' * 4000  # room on the command line, in which each fork shows its own
_NODES = ('rospy', 'move_base_abstract_ros.lockstep.program', 'move_base_abstract_ros.nodes.lockstep_launcher')
_LARGEST = 1 << 20  # bytes of a script that are read
#: modules that are imported before the fork: messages and libraries of others, and our own nodes
MODULES = ('rospy', 'actionlib', 'actionlib_msgs.msg', 'dynamic_reconfigure.server', 'geometry_msgs.msg',
           'move_base_msgs.msg', 'nav_msgs.msg', 'numpy', 'std_msgs.msg', 'std_srvs.srv', 'tf2_msgs.msg', 'tf2_ros',
           'visualization_msgs.msg', 'roslaunch.config', 'roslaunch.node_args', 'roslaunch.substitution_args',
           'rosmaster.master', 'move_base_abstract_ros.launching.plan', 'move_base_abstract_ros.lockstep.program',
           'move_base_abstract_ros.nodes.lockstep_launcher', 'move_base_abstract_ros.nodes.fleet_node',
           'move_base_abstract_ros.nodes.move_base_node', 'move_base_abstract_ros.nodes.task_server_node',
           'move_base_abstract_ros.nodes.task_source_node',
           'move_base_abstract_ros.nodes.end_at_message_node', 'move_base_abstract_ros.nodes.message_recorder_node',
           'move_base_abstract_ros.nodes.property_monitor_node')


def wants_start(environment):
    """Add to the environment what only a new Python can take, so that forks of it can be nodes.

    Return whether there is something, so that this Python must be started again with it.
    """
    is_new = address_layout.choose(environment)
    is_new = _HASH_SEED not in environment or is_new
    is_new = not native_library.is_loaded() and native_library.preload(environment) or is_new
    environment.setdefault(_HASH_SEED, '0')
    return is_new


def start_again():
    """Start this Python again, once, if it wants that, with the same command line, and room to show those of forks."""
    if wants_start(os.environ):
        os.execv(sys.executable, [sys.executable, '-X', _SPACE, *sys.argv])
    processes.show_name(os.path.basename(sys.argv[0]), sys.executable, *sys.argv)


@contextlib.contextmanager
def importing():
    """Import inside the context quickly, and what starts no thread: a process with two of them cannot fork.

    roslaunch asks distutils, which setuptools replaces by its own, for one function. It works without setuptools.
    """
    added = processes.for_one_thread(os.environ)
    os.environ.update(added)
    hack = sys.modules.get('_distutils_hack') if sys.version_info < (3, 12) else None
    if hack is not None:
        hack.remove_shim()
    try:
        yield
    finally:
        if hack is not None:
            hack.add_shim()
        for name in added:
            del os.environ[name]


def import_all():
    """Import the modules, and look up the paths, that nodes and those who start them need."""
    from . import look_ups
    with importing():
        for name in MODULES:
            importlib.import_module(name)
    look_ups.packages()
    look_ups.remember()
    be_ready()


def be_ready(paths=(), own_folder=''):
    """Import what the Python programs at ``paths`` import; of our own ones, in ``own_folder``, all of it."""
    with importing():
        for name in _NODES if paths else ():
            importlib.import_module(name)
        for path in paths:
            _import_for(path, own_folder)
    from ..replacing import replaced
    replaced.look_up()
    log_settings()
    gc.collect()
    gc.freeze()  # so that no garbage collection in a fork touches, and so copies, the present objects


def start(words, environment, enter, cwd, launcher, is_warm=True):
    """Start a node, which leads a session of its own; return its process id.

    words: program and arguments. environment: {name: value}. enter: called first in the new process, to give it its
    outputs. cwd: the working folder. launcher: path of our launcher. is_warm: whether a fork is allowed.
    With a guard, which ends all that is left, it ends by SIGINT if this process dies: its last words are heard.
    """
    environment = with_log_settings(environment)

    def begin():
        enter()
        os.chdir(cwd)
        if is_warm and is_fit(words, environment, launcher):
            become(words, {**processes.for_one_thread(environment), **environment})
        else:
            processes.become(words, environment)
    return processes.fork(begin, new_session=True, ends_by=signal.SIGINT if guard.is_there() else signal.SIGKILL)


def is_fit(words, environment, launcher):
    """Return whether a fork of this process may become the Python program of a command line in an environment."""
    is_own = words[0] != launcher
    if is_own and os.path.dirname(words[0]) != os.path.dirname(launcher):
        return False
    # Own nodes may also run in a virtual environment over their Python; programs of others need their own Python.
    python = processes.interpreter_of(words[0])
    if python != sys.executable and not (python and os.path.realpath(python) == os.path.realpath(sys.executable) and (
            is_own or sys.prefix == sys.base_prefix)):
        return False
    return may_become(words, environment, launcher)


def may_become(words, environment, launcher):
    """Return whether a fork may become a Python program for which otherwise this process's Python would start anew."""
    if getattr(sys.flags, 'safe_path', False) or words[0] == launcher and _is_shadowed(words[1:]):
        return False
    if any(environment.get(name, '1') != '1' for name in processes.ONE_THREAD):
        return False
    # Own nodes do not depend on the hash seed. They have one only if their environment sets it, and then the same.
    own_seed = os.environ.get(_HASH_SEED, '')
    return own_seed != 'random' and environment.get(_HASH_SEED, own_seed) == own_seed and all(
        environment.get(name) == os.environ.get(name) for name in {*environment, *os.environ}
        if name.startswith(_FIXED) and name not in (_HASH_SEED, 'PYTHONUNBUFFERED', *processes.ONE_THREAD))


def _is_shadowed(words):
    """Return whether the folder of the launcher's script has a module with the name of one that is imported here.

    Python itself would import the one in that folder. words: the arguments of the launcher.
    """
    from ..lockstep.programs import command_line
    path = command_line.script_of(words)
    if path is None:
        return False
    folder = os.path.dirname(os.path.realpath(path))
    names = {name.partition('.')[0] for name in sys.modules}
    return any(entry.partition('.')[0] in names and (entry.endswith(('.py', '.so')) or os.path.isfile(
        os.path.join(folder, entry, '__init__.py'))) for entry in os.listdir(folder))


def _import_for(path, own_folder):
    """Import beforehand what the script at ``path`` imports: for our own programs all, for others those of MODULES."""
    text = b''
    with contextlib.suppress(OSError), open(path, 'rb') as stream:
        text = stream.read(_LARGEST)
    own = _OWN_NODE.search(text) if os.path.dirname(path) == own_folder else None
    names = [f'{_OWN_NODES}.{own.group(1).decode()}'] if own else [
        name for name in MODULES if re.search(rb'^[ \t]*(from|import)\b.*\b%b\b' % name.encode(), text, re.MULTILINE)]
    for name in names:
        with contextlib.suppress(Exception):  # the node itself will report the error
            importlib.import_module(name)


@functools.lru_cache(maxsize=None)
def log_settings():
    """Return the path of rospy's log settings for all users, or ''. Otherwise each node would search all packages."""
    import rospkg
    folder = rospkg.get_etc_ros_dir()
    if not _has_settings(folder):
        try:
            folder = os.path.join(rospkg.RosPack().get_path('rosgraph'), 'conf')
        except rospkg.ResourceNotFound:
            return ''
    path = os.path.join(folder, 'python_logging.conf')
    return path if os.path.isfile(path) else ''


def with_log_settings(environment):
    """Return ``environment`` with log_settings() in it, unless it names other settings or its ROS_HOME has some."""
    home = environment.get('ROS_HOME', os.path.expanduser('~/.ros'))
    if environment.get(_LOG_SETTINGS) or _has_settings(os.path.join(home, 'config')) or not log_settings():
        return environment
    return {**environment, _LOG_SETTINGS: log_settings()}


def _has_settings(folder):
    return any(os.path.exists(os.path.join(folder, 'python_logging' + end)) for end in ('.conf', '.yaml'))


def become(words, environment):
    """Become, in a fork, the Python program of a command line, as if Python had been started with it."""
    import rospy.names
    from rosgraph.names import get_ros_namespace, load_mappings
    is_launcher = os.path.basename(words[0]) == 'lockstep'
    processes.show_name(os.path.basename(sys.executable if is_launcher else words[0]), sys.executable, *words)
    be_as_started(environment)
    processes.end_as_program = True
    os.environ.clear()
    os.environ.update(environment)
    path = words[0]
    sys.argv[:] = words  # the list itself, which modules may have kept when they were imported (roslaunch.main)
    if 'orig_argv' in vars(sys):  # from Python 3.10 on
        vars(sys)['orig_argv'] = [sys.executable, *words]
    tempfile.tempdir = None
    sys.path[0] = os.path.dirname(os.path.realpath(path))
    # rospy reads these from the command line and the environment when it is imported.
    rospy.names._mappings = load_mappings(sys.argv)
    rospy.names._caller_namespace = get_ros_namespace()
    rospy.names._caller_id = rospy.names._caller_namespace + 'unnamed'
    with open(path, 'rb') as stream:
        source = stream.read()
    module = types.ModuleType('__main__')
    module.__builtins__ = builtins
    module.__file__ = path
    sys.modules['__main__'] = module
    exec(compile(source, path, 'exec', dont_inherit=True), module.__dict__)


def be_as_started(environment):
    """Make this fork like a Python that has just started: its open files, sys.stdout and sys.stderr, working folder."""
    for name in os.listdir('/proc/self/fd'):
        with contextlib.suppress(OSError):
            if int(name) > 2:
                os.close(int(name))
    is_buffered = not environment.get('PYTHONUNBUFFERED')
    for number, name in enumerate(('stdout', 'stderr'), 1):
        new = _output(getattr(sys, f'__{name}__'), number, is_buffered)
        vars(sys).update({name: new, f'__{name}__': new})
    multiprocessing = sys.modules.get('multiprocessing.process')
    if multiprocessing is not None:
        multiprocessing.ORIGINAL_DIR = os.getcwd()


def _output(old, number, is_buffered):
    raw = io.FileIO(number, 'w', closefd=False)
    raw.name = old.name
    is_by_line = is_buffered and (raw.isatty() or (number == 2 and sys.version_info >= (3, 9)))
    new = io.TextIOWrapper(io.BufferedWriter(raw) if is_buffered else raw, old.encoding, old.errors,
                           line_buffering=is_by_line, write_through=not is_buffered)
    new.mode = 'w'
    return new
