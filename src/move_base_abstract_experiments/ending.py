"""How a command of this package ends: a user's error is printed as one line, and a signal acts like Ctrl-C."""
from __future__ import annotations

import contextlib
import signal
import sys
from typing import Any, Callable, Iterator

from move_base_abstract.common.errors import SimulatorError

CANNOT, INTERRUPTED = 2, 130


def exit_code(program: str, act: Callable[[], int]) -> int:
    """Return the result of ``act()``. On an error, print it in the name of ``program`` and return its exit code."""
    try:
        with _ended_as_by_ctrl_c():
            return act()
    except (SimulatorError, OSError) as error:
        print(f'{program}: {error}', file=sys.stderr)
        return CANNOT
    except KeyboardInterrupt:
        print(f'{program}: interrupted', file=sys.stderr)
        return INTERRUPTED


@contextlib.contextmanager
def _ended_as_by_ctrl_c() -> Iterator[None]:
    """Let SIGTERM and SIGHUP act like Ctrl-C inside the context. SIGHUP stays ignored if it is, as under nohup."""
    before = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGHUP)}
    numbers = [number for number, handler in before.items() if handler != signal.SIG_IGN]

    def interrupt(_number: int, _frame: Any) -> None:
        for number in numbers:  # further signals must not interrupt the end itself
            signal.signal(number, signal.SIG_IGN)
        raise KeyboardInterrupt
    for number in numbers:
        signal.signal(number, interrupt)
    try:
        yield
    finally:
        for number in numbers:
            signal.signal(number, before[number])
