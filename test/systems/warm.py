"""ROS masters and Python nodes as forks of a process that has imported all modules, so that they start sooner.

    from warm import Loopback            # instead of the one of move_base_abstract_ros.loopback

This Loopback starts Python scripts and the launcher as such forks, if that makes no difference for them. A fork has the
environment, files, signals and process group that it would have otherwise. A command that needs another Python, other
options of Python or another environment of Python is started anew. The process to fork from starts when it is first
needed, with the order of sets, the layout of memory and the library with which programs that fork nodes would start
again. `Loopback(is_warm=False)` starts everything anew.

The runner of the tests has started like that. It calls import_all(), and prepare() in each of its forks: the process to
fork from is then a fork, too, which needs no imports.
"""
import functools
import gc
import importlib
import json
import os
import select
import signal
import socket
import subprocess
import sys
import tempfile

from waiting import GUARD

from move_base_abstract.common import processes
from move_base_abstract_experiments.carrying import sockets
from move_base_abstract_ros import loopback
from move_base_abstract_ros.launching import ros_master, warm_nodes
from move_base_abstract_ros.lockstep.programs import native_library

_FORKING = ('lockstep', 'lockstep_launch', 'verify')  # these fork nodes, or are nodes
_HERE = os.path.dirname(os.path.abspath(__file__))
_ROOT = os.path.dirname(os.path.dirname(_HERE))
_MASTER = 'a ROS master'
_CODE = ('import sys; path = sys.path[1:]; sys.path[0] = {!r}; from warm import main; del sys.modules["warm"]; '
         'become = main({}, path); become and become()')
SPACE = ' ' * 4000  # room in the command line, in which each fork shows its own
_standard_path = []  # of Python, without the folder of the program; empty before import_all()


class Loopback(loopback.Loopback):
    """A Loopback whose ROS master and Python nodes are forks."""

    def __init__(self, use_sim_time=True, is_warm=True):
        """Make a Loopback; is_warm: whether processes are forks, otherwise each is started anew."""
        super().__init__(use_sim_time)
        self.is_warm = is_warm

    def close(self, keep_logs=False):
        """End all children. Their logs stay: they are shown if the test fails, and go with the tests' own folder."""
        super().close(keep_logs=True)

    def _start_master(self):
        if not self.is_warm:
            super()._start_master()
            return
        self.uri = ''
        told, tell = os.pipe()
        log_path = self._log_path('rosmaster')
        with open(log_path, 'wb') as log:
            forked = _parent().fork([_MASTER], self.environment, [tell, log.fileno()])
        self._child('rosmaster', forked, log_path)
        os.close(tell)
        with os.fdopen(told) as stream:
            self.uri = stream.read()
        self.check()
        self.set_param('/use_sim_time', self._use_sim_time)

    def _start(self, command, log):
        words = words_of(command) if self.is_warm else None
        if words is None:
            return super()._start(command, log)
        return _parent().fork(words, self.environment, [log.fileno()] * 2)


def start(command, output, environment=None, cwd=None):
    """Start a program, as a fork if that makes no difference; return its processes.Held, which must be released.

    output: a file that is open for writing; environment, cwd: this process's own if None.
    """
    environment = dict(os.environ) if environment is None else environment
    words = words_of(command)
    return processes.Held(_parent().fork(words, environment, [output.fileno()] * 2, cwd) if words else
                          subprocess.Popen(command, env=environment, cwd=cwd, stdin=subprocess.DEVNULL, stdout=output,
                                           stderr=subprocess.STDOUT, start_new_session=True))


def run(command, environment=None, cwd=None, timeout=GUARD):
    """Run a program to its end, as start() does; return a subprocess.CompletedProcess whose stdout is text.

    :raises subprocess.TimeoutExpired: if it has not ended after ``timeout`` [s, wall]; it is killed then.
    """
    with tempfile.TemporaryFile() as output:
        process = start(command, output, environment, cwd)
        try:
            code = process.wait(timeout)
        except subprocess.TimeoutExpired:
            process.signal_group(signal.SIGKILL)
            raise
        finally:
            process.release()
        output.seek(0)
        return subprocess.CompletedProcess(command, code, output.read().decode(errors='replace'))


def words_of(command):
    """Return the words of a command line without Python's, if a fork may become it, or None."""
    if command[0] == sys.executable and os.path.isfile(command[1]):
        return command[1:]
    own = processes.interpreter_of(command[0])
    is_ours = own == sys.executable or own and os.path.dirname(command[0]) == os.path.dirname(launcher())
    return command if is_ours else None


@functools.lru_cache(maxsize=None)
def launcher():
    """Return the path of the launcher."""
    return loopback.find_executable('lockstep')


@functools.lru_cache(maxsize=None)
def _parent():
    return _Parent()


def import_all(path):
    """Import what all processes need. ``path``: Python's first sys.path, without the folder of the program."""
    _standard_path[:] = path
    _import()


def prepare():
    """Fork the process to fork from. Call it after import_all(), before anything else happens."""
    _parent()


class _Parent:
    """A process to fork from. Make it in the main thread, since the kernel ends it with that thread."""

    def __init__(self):
        processes.adopt_orphans()
        self._socket, its = sockets.pair()
        self._socket.settimeout(GUARD)
        if _standard_path:
            processes.fork(lambda: self._be_forked(its), new_session=True)
        else:
            self._start(its)
        its.close()

    def _be_forked(self, its):
        self._socket.close()
        for name in [name for name, module in sys.modules.items() if _is_of_tests(module)]:
            del sys.modules[name]
        become = _serve(its.detach(), list(_standard_path))
        if become:
            become()

    def _start(self, its):
        environment = {'PYTHONHASHSEED': '0', **os.environ, **processes.ONE_THREAD}
        native_library.preload(environment)
        code = _CODE.format(_HERE, its.fileno())
        self._process = subprocess.Popen([sys.executable, '-c', code, SPACE], env=environment,
                                         stdin=subprocess.DEVNULL, pass_fds=[its.fileno()])

    def fork(self, words, environment, outputs, cwd=None):
        """Fork for a command line; return the processes.Forked. outputs: descriptors of this process."""
        paths = ['/proc/{}/fd/{}'.format(os.getpid(), one) for one in outputs]
        self._socket.sendall(json.dumps([words, environment, cwd or os.getcwd(), paths]).encode() + b'\n')
        return processes.Forked(int(self._socket.makefile().readline()))


def main(descriptor, path):
    """Serve until the test ends; in a fork, return the function that it must call. path: Python's own sys.path[1:]."""
    processes.die_with(os.getppid())
    if warm_nodes.wants_start(os.environ):
        with open('/proc/self/cmdline', 'rb') as stream:
            os.execv(sys.executable, stream.read().split(b'\0')[:-1])
    os.setsid()
    _import()
    return _serve(descriptor, path)


def _import():
    for name in warm_nodes.MODULES:
        importlib.import_module(name)
    warm_nodes.be_ready()
    launcher()


def _is_of_tests(module):
    path = getattr(module, '__file__', None) or ''
    return os.path.dirname(path) in (_HERE, os.path.dirname(_HERE), os.path.join(_ROOT, 'tools'))


def _serve(descriptor, path):
    sys.path[1:] = path  # without the entries that imports have added
    own_launcher = launcher()
    return _fork_for_each(socket.socket(fileno=descriptor), lambda *asked: _become(own_launcher, *asked))


def _fork_for_each(client, become):
    """Fork for each request until the client has gone, then return None. In a fork, return the function that it calls.

    Only forks read requests, so that they all begin with the same memory, whatever was started before.
    """
    gc.collect()
    gc.freeze()  # the objects that were made since the imports, too
    while True:
        select.select([client], [], [])
        taken, take = os.pipe()
        if _fork(taken):
            os.close(take)
            is_there = os.read(taken, 1)
            os.close(taken)
            if not is_there:
                return None
            continue
        line = client.makefile().readline()
        if not line:
            os._exit(0)
        os.setsid()  # before the client knows the process to which it may send signals
        os.write(take, b'1')
        words, environment, cwd, outputs = json.loads(line)
        for target, path in zip((1, 2), outputs):
            os.dup2(os.open(path, os.O_WRONLY | os.O_APPEND), target)
        client.sendall(b'%d\n' % os.getpid())
        client.detach()
        os.chdir(cwd)
        return functools.partial(become, words, environment)


def _fork(*not_for_fork):
    """Fork twice; return True in this process and False in the second fork, which goes on once it is an orphan.

    The client adopts it, and so gets its status. The second fork closes the descriptors ``not_for_fork``.
    """
    processes.assert_one_thread()
    gate, opener = os.pipe()
    first = os.fork()
    if first:
        os.waitpid(first, 0)
        os.close(gate)
        os.close(opener)
        return True
    if os.fork():
        os._exit(0)
    os.close(opener)
    with os.fdopen(gate, 'rb') as stream:
        stream.read()
    for descriptor in not_for_fork:
        os.close(descriptor)
    return False


def _become(own_launcher, words, environment):
    """Become the program that was asked for; if a fork cannot be it, start it anew."""
    processes.die_with(os.getppid())
    if words == [_MASTER]:
        _be_master(environment)
        return
    given, environment = environment, warm_nodes.with_log_settings(environment)
    if os.path.dirname(words[0]) == os.path.dirname(own_launcher) and os.path.basename(words[0]) in _FORKING:
        sys.path.insert(1, os.path.dirname(own_launcher))  # our packages put the sources before the program's folder
        environment = {'PYTHONHASHSEED': os.environ['PYTHONHASHSEED'], **environment}  # otherwise it would start again
    if warm_nodes.may_become(words, environment, own_launcher):
        warm_nodes.become(words, environment)
    else:
        os.execve(sys.executable, [sys.executable, *words], given)


def _be_master(environment):
    """Become a ROS master, and write its URI to the standard output, which is then closed."""
    processes.show_name('rosmaster', 'rosmaster', '--core')
    warm_nodes.be_as_started(environment)
    os.environ.clear()
    os.environ.update(environment)

    def tell(uri):
        os.write(1, uri.encode())
        os.dup2(2, 1)
    ros_master.serve(tell)
