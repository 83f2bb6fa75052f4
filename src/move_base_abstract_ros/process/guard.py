"""A guard of a program that starts processes: another process, so that nothing outlives the program, even if it dies.

The program goes on in a child of the guard. If it is killed, all that it has started gets the guard as parent, which
ends them and removes the program's folders. If the guard is killed, the program gets SIGTERM, and ends as ever.
"""
from __future__ import annotations

import contextlib
import os
import shutil
import signal
import sys
import tempfile
import time
from types import SimpleNamespace
from typing import Dict, NoReturn

from move_base_abstract.common import processes
from move_base_abstract.common.temporary_folder import clear_left

_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_AWAITED = {*_SIGNALS, signal.SIGCHLD}
_LOOK_S, _DRAIN_S = 0.02, 10.0  # wall
_OWN, _OF_RUN, _NONE = '+', '~', '-'  # what the guard is told about a folder
#: (signal, wall time [s] that follows) for what a killed program has started; 0: the kernel has sent SIGINT
_STEPS = ((0, 1.0), (signal.SIGINT, 2.0))
#: in the program: the guard's process id, 0 without a guard, and the descriptor by which it is told of folders
_state = SimpleNamespace(pid=0, write=-1)


def stand(name: str) -> None:
    """Make this process the guard, and return in a child of it, which is the program from now on.

    The guard exits with the program's code. INT, TERM and HUP go on to the program, where TERM and HUP exit at once,
    with a line that says why, until it handles them. ``name`` is that of the program, for messages.

    :raises RuntimeError: if this process has a second thread.
    """
    processes.adopt_orphans()
    read, write = os.pipe()
    for end in (read, write):
        os.set_blocking(end, False)
    signal.pthread_sigmask(signal.SIG_BLOCK, _AWAITED)
    guard = os.getpid()
    pid = processes.fork_on(ends_by=signal.SIGTERM)
    if pid == 0:
        os.close(read)
        _state.pid, _state.write = guard, write
        for number in (signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, lambda number, _frame: _exit(name, number))
        return
    os.close(write)
    folders: Dict[str, str] = {}
    code = _await(pid, read, folders)
    if code < 0:
        print('{}: its process {} was ended by {}; all that it has started is ended'.format(
            name, pid, signal.Signals(-code).name), file=sys.stderr)
    _end_orphans()
    for path, what in folders.items():
        if what == _OWN:
            shutil.rmtree(path, ignore_errors=True)
        elif what == _OF_RUN:
            clear_left(path, lambda line: print('{}: {}'.format(name, line), file=sys.stderr))
    processes.finish(code if code >= 0 else 1)


def _exit(name: str, number: int) -> NoReturn:
    with contextlib.suppress(OSError):
        os.write(2, '{}: {}\n'.format(name, why(number)).encode())
    sys.exit(128 + number)


def why(number: int) -> str:
    """Return why the program ends by a signal, as a text."""
    return 'its guard has ended; it ends' if has_lost() else 'ended by {}'.format(signal.Signals(number).name)


def has_lost() -> bool:
    """Return whether this program had a guard that has ended."""
    return is_there() and os.getppid() != _state.pid


def is_there() -> bool:
    """Return whether this process is a program with a guard, or a fork of one."""
    return _state.pid != 0


def folder(prefix: str) -> str:
    """Return the path of a new temporary folder, which the guard removes at the end unless :func:`keep` is called."""
    path = tempfile.mkdtemp(prefix=prefix)
    _tell(_OWN, path)
    return path


def clears(path: str) -> None:
    """Let the guard clear, at the end, a folder of ``temporary_folder``."""
    _tell(_OF_RUN, path)


def keep(path: str) -> None:
    """Let the guard not remove a folder."""
    _tell(_NONE, path)


def _tell(what: str, path: str) -> None:
    if is_there():
        os.write(_state.write, (what + path + '\0').encode('utf-8', 'surrogateescape'))


def _await(pid: int, read: int, folders: Dict[str, str]) -> int:
    """Wait for the end of the program; return its exit code. ``folders``: get its folders."""
    statuses: Dict[int, int] = {}
    told = b''
    while pid not in statuses:
        found = signal.sigtimedwait(_AWAITED, _DRAIN_S)
        if found is not None and found.si_signo in _SIGNALS:
            os.kill(pid, found.si_signo)
        processes.reap(statuses)
        told = _take(told, read, folders)
    return processes.code_of(statuses[pid])


def _take(told: bytes, read: int, folders: Dict[str, str]) -> bytes:
    """Read what the program has told; return what is not whole yet."""
    try:
        told += os.read(read, 1 << 16)
    except BlockingIOError:
        return told
    *lines, told = told.split(b'\0')
    for line in lines:
        text = line.decode('utf-8', 'surrogateescape')
        folders[text[1:]] = text[:1]
    return told


def _end_orphans() -> None:
    for number, seconds in _STEPS:
        deadline = time.monotonic() + seconds
        for pid in processes.children() if number else ():
            processes.signal_group(pid, number)
        while processes.children() and time.monotonic() < deadline:
            processes.reap({})
            time.sleep(_LOOK_S)
    processes.end_all_children()
