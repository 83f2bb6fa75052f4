"""How a command of this package ends: a user's error is printed as one line, and a signal acts like Ctrl-C."""
from __future__ import annotations

import contextlib
import signal
import sys
from typing import Any, Callable, Iterator

from move_base_abstract.common import guard
from move_base_abstract.common.errors import SimulatorError

CANNOT, INTERRUPTED = 2, 130


def exit_code(program: str, act: Callable[[], int]) -> int:
    """Return the result of ``act()``. On an error, print it in the name of ``program`` and return its exit code."""
    try:
        with _ended_as_by_ctrl_c(program):
            return act()
    except (SimulatorError, OSError) as error:
        print(f'{program}: {error}', file=sys.stderr)
        return CANNOT
    except KeyboardInterrupt:
        print(f'{program}: interrupted', file=sys.stderr)
        return INTERRUPTED


@contextlib.contextmanager
def _ended_as_by_ctrl_c(program: str) -> Iterator[None]:
    """Let the signals that end a program act like Ctrl-C inside the context; say which one has come."""
    numbers = [number for number in guard.signals() if number != signal.SIGINT]
    before = {number: signal.getsignal(number) for number in numbers}

    def interrupt(sent: int, _frame: Any) -> None:
        for number in numbers:  # further signals must not interrupt the end itself
            signal.signal(number, signal.SIG_IGN)
        guard.tell(program, sent)
        raise KeyboardInterrupt
    for number in numbers:
        signal.signal(number, interrupt)
    try:
        yield
    finally:
        for number in numbers:
            signal.signal(number, before[number])
