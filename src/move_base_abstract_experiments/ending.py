"""How a command of this package ends: errors of users are a line, and what ends a program is what Ctrl-C is."""
from __future__ import annotations

import contextlib
import signal
import sys
from typing import Any, Callable, Iterator

from move_base_abstract.common.errors import SimulatorError

CANNOT, INTERRUPTED = 2, 130


def exit_code(program: str, act: Callable[[], int]) -> int:
    """Return what ``act()`` returns, or say in the name of ``program`` what is wrong, and return the code of that."""
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
    """Have SIGTERM and SIGHUP (unless it is ignored, as under nohup) end what runs meanwhile as Ctrl-C does."""
    numbers = [number for number in (signal.SIGTERM, signal.SIGHUP) if signal.getsignal(number) == signal.SIG_DFL]

    def interrupt(_number: int, _frame: Any) -> None:
        for number in numbers:  # what ends is ended once
            signal.signal(number, signal.SIG_IGN)
        raise KeyboardInterrupt
    for number in numbers:
        signal.signal(number, interrupt)
    try:
        yield
    finally:
        for number in numbers:
            signal.signal(number, signal.SIG_DFL)
