"""Start a node as a program, or, if the result is the same, as a fork of this process, which has all imports done.

A fork is possible for our launcher of Python programs and for this package's own nodes, if the node's environment asks
for the settings with which this process was started. Everything else is started as a program.
"""
import builtins
import contextlib
import functools
import importlib
import os
import re
import sys
import tempfile
import types

from move_base_abstract.common import processes

_FIXED = ('PYTHON', 'LD_', 'MALLOC_', 'GLIBC_', 'OMP_', 'OPENBLAS_', 'MKL_', 'BLIS_', 'NUMEXPR_', 'LC_', 'LANG', 'TZ',
          'MOVE_BASE_ABSTRACT_ADDRESS_LAYOUT')
_HASH_SEED = 'PYTHONHASHSEED'
_LOG_SETTINGS = 'ROS_PYTHON_LOG_CONFIG_FILE'
_NODES = 'move_base_abstract_ros.nodes'
_OWN_NODE = re.compile(rb"^start\('(\w+)'\)", re.MULTILINE)
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


def start(words, environment, output, cwd, launcher, own_folder, is_warm=True):
    """Start a node; return (process id, whether it is a fork).

    words: program and arguments. environment: {name: value}. output: the path of a file for its output. cwd: the
    working folder. launcher: path of our launcher; own_folder: that of this package's programs. is_warm: whether a fork
    is allowed.
    """
    environment = with_log_settings(environment)
    if is_warm and is_fit(words, environment, launcher, own_folder):
        return processes.fork(lambda: become(words, environment), output, cwd), True
    return processes.execute(words, environment, output, cwd), False


def is_fit(words, environment, launcher, own_folder):
    """Return whether a fork of this process may become the Python program of a command line in an environment."""
    is_own = words[0] != launcher
    if is_own and os.path.dirname(words[0]) != own_folder:
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
    return environment.get(_HASH_SEED, own_seed) == own_seed and all(
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


def import_for(path, own_folder):
    """Import beforehand what the script at ``path`` imports: for our own programs all, for others those of MODULES."""
    with contextlib.suppress(OSError), open(path, 'rb') as stream:
        _import_for(stream.read(_LARGEST), os.path.dirname(path) == own_folder)


def _import_for(text, is_own):
    own = _OWN_NODE.search(text) if is_own else None
    names = [f'{_NODES}.{own.group(1).decode()}'] if own else [
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


def be_or_start(words, environment, launcher):
    """Become the program of a command line, in a fork. If a fork cannot be the same, execute the program."""
    environment = with_log_settings(environment)
    if words[0] == launcher:
        environment = {_HASH_SEED: os.environ[_HASH_SEED], **environment}  # otherwise the launcher would start again
    if is_fit(words, environment, launcher, os.path.dirname(launcher)):
        become(words, environment)
    else:
        os.execvpe(words[0], words, environment)


def become(words, environment):
    """Become the Python program of a command line, as if Python had been started with it."""
    import rospy.names
    from rosgraph.names import get_ros_namespace, load_mappings
    os.environ.clear()
    os.environ.update(environment)
    path = words[0]
    sys.argv = list(words)
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
