"""A guard of a program that starts processes: another process, so that nothing outlives the program, even if it dies.

The program goes on in a child of the guard. If it is killed, all that it has started gets the guard as parent, which
ends them and removes the program's folders. If the guard is killed, the program gets SIGTERM, ends as ever, and does
the guard's work last. If both are killed at once, the guard of the next program removes the folders.
"""
from __future__ import annotations

import atexit
import contextlib
import os
import signal
import sys
import time
from types import SimpleNamespace
from typing import Collection, Dict, List, NoReturn

from . import processes, temporary

_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_LOOK_S = 0.02  # wall
#: (signal, wall time [s] that follows) for what a killed program has started; 0: the kernel has sent SIGINT
_STEPS = ((0, 1.0), (signal.SIGINT, 2.0))
#: the process ids of the guard, 0 without one, and of the program
_state = SimpleNamespace(pid=0, program=0)


def stand(name: str) -> None:
    """Make this process the guard, and return in a child of it, which is the program from now on.

    The guard exits with the program's code. INT, TERM and HUP go on to the program, where TERM and HUP exit at once,
    with a line that says why, until it handles them. SIGHUP stays ignored if it is, as under nohup. ``name`` is that of
    the program, for messages.

    :raises RuntimeError: if this process has a second thread.
    """
    _sweep(name)
    processes.adopt_orphans()
    handled = signals()
    signal.pthread_sigmask(signal.SIG_BLOCK, {*handled, signal.SIGCHLD})
    _state.pid = os.getpid()
    pid = processes.fork_on(ends_by=signal.SIGTERM, handle=lambda number, _frame: _exit(name, number))
    if pid == 0:
        if signal.SIGHUP not in handled:
            signal.signal(signal.SIGHUP, signal.SIG_IGN)
        _state.program = os.getpid()
        atexit.register(_stand_in, name)
        os.register_at_fork(after_in_child=lambda: atexit.unregister(_stand_in))  # a node would ask for its number
        return
    temporary.let_go()
    code = _await(pid, handled)
    if code < 0:
        _say(name, 'its process {} was ended by {}; all that it has started is ended'.format(
            pid, signal.Signals(-code).name))
    _clear(name)
    os._exit(code if code >= 0 else 1)


def _stand_in(name: str) -> None:
    """Do at the end of the program what its guard does then, if that has been killed."""
    if has_lost():
        temporary.let_go()
        _clear(name)


def _clear(name: str) -> None:
    _end_orphans()
    _sweep(name)


def signals() -> List[signal.Signals]:
    """Return the signals that end a program: without SIGHUP if that is ignored, as under nohup."""
    return [number for number in _SIGNALS if (number, signal.getsignal(number)) != (signal.SIGHUP, signal.SIG_IGN)]


def _sweep(name: str) -> None:
    """Remove the folders of programs that were killed."""
    temporary.remove_left()
    temporary.clear_left(lambda line: _say(name, line))


def _say(name: str, line: str) -> None:
    with contextlib.suppress(OSError):
        os.write(2, '{}: {}\n'.format(name, line).encode('utf-8', 'backslashreplace'))


def _exit(name: str, number: int) -> NoReturn:
    for other in (signal.SIGTERM, signal.SIGHUP):  # they must not interrupt the end itself
        signal.signal(other, signal.SIG_IGN)
    tell(name, number)
    sys.exit(128 + number)


def tell(name: str, number: int) -> None:
    """Say why the program ``name`` ends by a signal. A handler of signals may call it."""
    _say(name, why(number))


def why(number: int) -> str:
    """Return why the program ends by a signal, as a text."""
    return 'its guard has ended; it ends' if has_lost() else 'ended by {}'.format(signal.Signals(number).name)


def has_lost() -> bool:
    """Return whether this process is a program that had a guard, which has ended."""
    return bool(os.getpid() == _state.program and os.getppid() != _state.pid)


def is_there() -> bool:
    """Return whether this process is a program with a guard, or a fork of one."""
    return bool(_state.pid)


def _await(pid: int, handled: Collection[signal.Signals]) -> int:
    """Wait for the end of the program; return its exit code."""
    statuses: Dict[int, int] = {}
    while pid not in statuses:
        number = signal.sigwait({*handled, signal.SIGCHLD})
        if number in handled:
            os.kill(pid, number)
        processes.reap(statuses)
    return processes.code_of(statuses[pid])


def _end_orphans() -> None:
    for number, seconds in _STEPS:
        deadline = time.monotonic() + seconds
        for pid in processes.children() if number else ():
            processes.signal_group(pid, number)
        while processes.children() and time.monotonic() < deadline:
            processes.reap({})
            time.sleep(_LOOK_S)
    processes.end_all_children()
