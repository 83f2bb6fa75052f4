"""The processes of a run: they are forked from this one, in groups of their own, and end when this one ends.

The process that calls this must have one thread. A forked child either becomes another program (exec), or goes on as a
Python program that has already imported everything.
"""
from __future__ import annotations

import atexit
import contextlib
import ctypes
import gc
import os
import signal
import subprocess
import sys
import threading
import time
import traceback
from typing import Any, Callable, Collection, Dict, Iterator, List, Mapping, Optional, Set

from . import errors

PR_SET_PDEATHSIG, PR_SET_NAME, PR_SET_CHILD_SUBREAPER = 1, 15, 36
_PR_SET_MM, _PR_SET_MM_ARG_END = 35, 9
_LIBC = ctypes.CDLL(None, use_errno=True)
_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3  # parameters of mallopt(3)
_MOST_TRIMMED, _MOST_MAPPED = 2 ** 30, 2 ** 25  # bytes; glibc allows no more for the latter
_POLL_S = 0.05  # wall
_SHORT_POLL_S = 0.005  # wall
_ARGUMENTS = slice(45, 47)  # fields of /proc/PID/stat after the name: addresses of begin and end of the command line
_KILL_ROUNDS = 200
_TASKS = '/proc/self/task'
#: whether this process is a user's program, whose objects finish() destroys as Python does: files are written out
end_as_program = False
#: set for all programs of a trial, because trials run side by side, and sums must not depend on the number of cores
ONE_THREAD = {'OMP_NUM_THREADS': '1', 'OPENBLAS_NUM_THREADS': '1', 'MKL_NUM_THREADS': '1'}
_THREAD_LIMIT = 'OMP_THREAD_LIMIT'


def for_one_thread(environment: Mapping[str, str]) -> Dict[str, str]:
    """Return the variables that an environment lacks by which OpenMP and libraries for sums use one thread.

    Also programs that ask for more threads in their code get one, unless the environment has a number of threads.
    """
    added = {name: value for name, value in ONE_THREAD.items() if name not in environment}
    if _THREAD_LIMIT not in environment and environment.get('OMP_NUM_THREADS', '1') == '1':
        added[_THREAD_LIMIT] = '1'
    return added


def assert_one_thread() -> None:
    """Raise RuntimeError if this process has a second thread, whose locks would stay locked after a fork."""
    count = len(os.listdir(_TASKS)) if os.path.isdir(_TASKS) else threading.active_count()
    if count != 1:
        raise RuntimeError(f'{count} threads at a fork; allowed: one ({[one.name for one in threading.enumerate()]})')


def adopt_orphans() -> None:
    """Make this process adopt its descendants whose parent has ended, so that none is left at the end."""
    _LIBC.prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def keep_memory() -> None:
    """Make this process, and its forks, keep freed memory instead of returning it each time.

    This is for processes that end soon. Otherwise numpy's temporary arrays cost a page fault for each of their pages,
    again and again, which is a third of the CPU time of a short trial. It has an effect with glibc only.
    """
    mallopt = getattr(_LIBC, 'mallopt', lambda _parameter, _value: 0)
    mallopt(_M_TRIM_THRESHOLD, _MOST_TRIMMED)
    mallopt(_M_MMAP_THRESHOLD, _MOST_MAPPED)


@contextlib.contextmanager
def importing() -> Iterator[None]:
    """Collect no garbage in the with block, nor later among the objects that exist at its end: imported ones stay."""
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()


def die_with(parent: int, ends_by: int = signal.SIGKILL) -> None:
    """Make the kernel send the signal ``ends_by`` to this process when its parent, the process ``parent``, ends."""
    _LIBC.prctl(PR_SET_PDEATHSIG, ends_by, 0, 0, 0)
    if os.getppid() != parent:
        os._exit(1)


def fork(body: Callable[[], Any], output: Optional[str] = None, cwd: Optional[str] = None,
         new_session: bool = False, ends_by: int = signal.SIGKILL) -> int:
    """Start a child that calls body() and ends with its exit code; return its process id.

    ``output``: the path of a file for what it prints. The child leads a process group of its own.
    ``ends_by``: the signal that it gets when this process ends; 0: none.

    :raises RuntimeError: if this process has a second thread.
    """
    code, pid = 1, fork_on(new_session, ends_by)
    if pid:
        return pid
    try:
        if output is not None:
            redirect(output)
        if cwd is not None:
            os.chdir(cwd)
        code = errors.exit_code_of(body)
    except BaseException:
        traceback.print_exc()
    finally:
        finish(code)
    return pid  # never reached: finish() does not return


def fork_on(new_session: bool = False, ends_by: int = signal.SIGKILL, handle: Any = signal.SIG_DFL) -> int:
    """Start a child as fork() does, which goes on here, with 0, and handles TERM and HUP so; return its process id."""
    assert_one_thread()
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    parent = os.getpid()
    # If an interrupt raised an error in Python's own work around a fork, its locks would stay locked.
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGTERM))
    try:
        pid = os.fork()
        if pid and not new_session:
            with contextlib.suppress(OSError):  # parent and child both do it, so that neither must wait for the other
                os.setpgid(pid, pid)
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
    if pid == 0:
        die_with(parent, ends_by)
        os.setsid() if new_session else os.setpgid(0, 0)
        _take_defaults(handle)
    return pid


def execute(words: List[str], environment: Mapping[str, str], output: str, cwd: str) -> int:
    """Start a program; return its process id. If it cannot be started, its output says so, and its exit code is 127."""
    return fork(lambda: become(words, environment), output, cwd)


def become(words: List[str], environment: Mapping[str, str]) -> None:
    """Become another program. If that cannot be, say so, and end with the exit code 127."""
    try:
        os.execvpe(words[0], words, environment)
    except OSError as error:
        os.write(2, f'{words[0]}: cannot be started: {error.strerror}\n'.encode())
        os._exit(127)


class Forked:
    """A forked or adopted child, with the attributes of subprocess.Popen."""

    def __init__(self, pid: int) -> None:
        self.pid = pid
        self.returncode: Optional[int] = None
        self._lock = threading.Lock()

    def poll(self) -> Optional[int]:
        """Return its exit code; if a signal ended it, the signal's negative number; None while it runs."""
        with self._lock:
            if self.returncode is None:
                self.returncode = self._look()
            return self.returncode

    def _look(self) -> Optional[int]:
        try:
            found, status = os.waitpid(self.pid, os.WNOHANG)
        except ChildProcessError:  # its status has been taken elsewhere
            return -signal.SIGKILL
        return code_of(status) if found else None

    def wait(self, timeout: Optional[float] = None) -> Optional[int]:
        """Wait for its end; return its exit code. :raises subprocess.TimeoutExpired: after ``timeout`` [s, wall]."""
        deadline = None if timeout is None else time.monotonic() + timeout
        while self.poll() is None:
            if deadline is not None and time.monotonic() > deadline:
                raise subprocess.TimeoutExpired(f'process {self.pid}', timeout or 0.0)
            time.sleep(_SHORT_POLL_S)
        return self.returncode


class Held(Forked):
    """A child that keeps its process id after its end, until :meth:`release`.

    So a signal to it, or to the group that it leads, never reaches another process that has got the same id later.
    """

    def __init__(self, process: Any) -> None:
        """``process``: a subprocess.Popen or a Forked, which must not be polled or waited for elsewhere."""
        super().__init__(process.pid)
        self._process = process
        self._is_released = False

    def _look(self) -> Optional[int]:
        try:
            found = os.waitid(os.P_PID, self.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT)
        except ChildProcessError:
            self._is_released = True
            return -signal.SIGKILL
        if found is None:
            return None
        return found.si_status if found.si_code == os.CLD_EXITED else -found.si_status

    def send_signal(self, number: int) -> None:
        """Send a signal to the process, unless it was released."""
        self._send(os.kill, number)

    def signal_group(self, number: int) -> None:
        """Send a signal to the process group that it leads, if there is one left, unless it was released."""
        self._send(os.killpg, number)

    def _send(self, how: Callable[[int, int], None], number: int) -> None:
        with self._lock:
            if not self._is_released:
                with contextlib.suppress(ProcessLookupError):
                    how(self.pid, number)

    def terminate(self) -> None:
        """Send SIGTERM to the process."""
        self.send_signal(signal.SIGTERM)

    def kill(self) -> None:
        """Send SIGKILL to the process."""
        self.send_signal(signal.SIGKILL)

    def release(self) -> None:
        """Wait for its end and give its process id back. From then on no signals are sent."""
        self.wait()
        with self._lock:
            self._process.wait()
            self._is_released = True


def show_name(name: str, *words: str) -> None:
    """Set the name and arguments that `ps` and /proc show for this process, as far as there is room."""
    _LIBC.prctl(PR_SET_NAME, os.fsencode(name)[:15], 0, 0, 0)
    with open('/proc/self/stat', 'rb') as stream:
        begin, end = map(int, stream.read().rpartition(b')')[2].split()[_ARGUMENTS])
    text = b'\0'.join(map(os.fsencode, words))[:end - begin - 1]
    ctypes.memmove(begin, text.ljust(end - begin, b'\0'), end - begin)
    # This is not allowed everywhere. Without it, empty words follow.
    _LIBC.prctl(_PR_SET_MM, _PR_SET_MM_ARG_END, ctypes.c_ulong(begin + len(text) + 1), 0, 0)


def finish(code: int) -> None:
    """End this process with exit code ``code``, as Python does at its end; objects are destroyed only for programs.

    Destroying them may take half a second. A process that was forked from within other functions cannot return.
    """
    core: Any = sys.modules.get('rospy.core')
    if core is not None and not core.is_initialized():
        atexit.unregister(core._ros_atexit)  # it would take 0.1 s, for nothing, in a process that is not a node
    own_threads: Any = threading
    try:
        own_threads._shutdown()
        atexit._run_exitfuncs()
    except BaseException:
        code = code or 1
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(Exception):
            stream.flush()
    if end_as_program:
        ctypes.pythonapi.Py_Exit(code)
    os._exit(code)


def await_child(seconds: float) -> None:
    """Wait until a child has ended, or ``seconds`` [s, wall]; SIGCHLD must be blocked (see block_child_signal)."""
    signal.sigtimedwait({signal.SIGCHLD}, seconds)


def end(pids: Collection[int], polite: int, grace: float, statuses: Dict[int, int],
        pause: Callable[[float], None] = await_child) -> None:
    """End children and their groups: by the signal ``polite``, and by SIGKILL after ``grace`` [s, wall].

    ``statuses`` gets {pid: exit status of waitpid} of all children that end meanwhile. ``pause``: see await_ends.
    """
    for number in (polite, signal.SIGKILL):
        left = [pid for pid in pids if pid not in statuses]  # other processes may have the ids of the rest by now
        for pid in left:
            signal_group(pid, number)
        await_ends(set(left), grace, statuses, pause)


def await_ends(waiting: Set[int], seconds: float, statuses: Dict[int, int],
               pause: Callable[[float], None] = await_child) -> None:
    """Wait until all children ``waiting`` (pids) have ended, at most ``seconds`` [s, wall]; fill ``statuses``.

    ``pause(seconds)`` waits meanwhile, at most so long [s, wall].
    """
    deadline = time.monotonic() + seconds
    while waiting - set(statuses):
        if reap(statuses):
            continue
        left = deadline - time.monotonic()
        if left <= 0.0:
            break
        pause(min(left, _POLL_S))


def block_child_signal() -> None:
    """Block SIGCHLD, so that :func:`await_child` can wait for it."""
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGCHLD})


def reap(statuses: Dict[int, int]) -> bool:
    """Put the statuses of all children that have ended into ``statuses``; return whether there was one."""
    found = False
    while True:
        try:
            pid, status = os.waitpid(-1, os.WNOHANG)
        except ChildProcessError:
            return found
        if pid == 0:
            return found
        statuses[pid] = status
        found = True


def end_all_children() -> None:
    """Kill all children of this process, adopted ones too, until there are none."""
    for _ in range(_KILL_ROUNDS):
        for pid in children():
            signal_group(pid, signal.SIGKILL)
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        try:
            while os.waitpid(-1, os.WNOHANG)[0]:
                pass
        except ChildProcessError:
            return
        time.sleep(0.005)


def children(of: str = 'self') -> List[int]:
    """Return the process ids of this process's children, or of those of another one, adopted ones too."""
    found: List[int] = []
    for task in os.listdir(f'/proc/{of}/task'):
        with contextlib.suppress(OSError), open(f'/proc/{of}/task/{task}/children') as stream:
            found += [int(word) for word in stream.read().split()]
    return found


def signal_group(pid: int, number: int) -> None:
    """Send a signal to the process group that a child leads, otherwise to the child; never to our own group."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        if os.getpgid(pid) == pid:
            os.killpg(pid, number)
        else:
            os.kill(pid, number)


def code_of(status: int) -> int:
    """Return the exit code in a status of waitpid; if a signal ended the process, its negative number."""
    return -os.WTERMSIG(status) if os.WIFSIGNALED(status) else os.WEXITSTATUS(status)


def _take_defaults(handle: Any) -> None:
    """Handle signals as a newly started program does, but SIGTERM and SIGHUP by ``handle``."""
    signal.set_wakeup_fd(-1)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    for number in (signal.SIGTERM, signal.SIGCHLD, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL if number == signal.SIGCHLD else handle)
    signal.pthread_sigmask(signal.SIG_SETMASK, set())


def redirect(output: str) -> None:
    """Append the output of this process to a file, and make its standard input empty."""
    descriptor = os.open(output, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o666)
    nothing = os.open(os.devnull, os.O_RDONLY)
    for target, source in ((0, nothing), (1, descriptor), (2, descriptor)):
        os.dup2(source, target)
    os.close(descriptor)
    os.close(nothing)
    streams: Any = (sys.stdout, sys.stderr)
    for stream in streams:
        stream.reconfigure(line_buffering=True, write_through=True)


def interpreter_of(path: str) -> str:
    """Return the path of the Python in the first line of a script, or '' if it is not a Python script."""
    try:
        with open(path, 'rb') as stream:
            first = stream.readline(500)
    except OSError:
        return ''
    words = first[2:].split() if first.startswith(b'#!') else []
    return os.fsdecode(words[-1]) if words and b'python' in words[-1] and b'/' in words[-1] else ''
