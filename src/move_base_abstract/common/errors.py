"""The errors of the simulator's core, and how a program ends on one: in one line, in its own name, with an exit code.

Every text says who complains, what was got, what is allowed, and where.
"""
from __future__ import annotations

import contextlib
import sys
from typing import Any, Callable, Iterator, Tuple, Type


class SimulatorError(Exception):
    """The base class of all errors that this package raises on purpose."""


class ConfigurationError(SimulatorError, ValueError):
    """A parameter, a file or an argument cannot be used."""


class FrameError(SimulatorError):
    """The coordinate frame of a pose cannot be related to the global frame."""


class TimeError(SimulatorError, ValueError):
    """An instant is not allowed, for example because it is before the present."""


@contextlib.contextmanager
def telling(program: str, *others: Type[BaseException], code: int = 2) -> Iterator[None]:
    """Exit with ``code`` on an error of ours, or one of the ``others``, and print it in the name of ``program``.

    From now on all that is printed can be shown: names and logs may contain bytes that are not text.
    """
    streams: Any = (sys.stdout, sys.stderr)
    for stream in streams:
        stream.reconfigure(errors='backslashreplace')
    kinds: Tuple[Type[BaseException], ...] = (SimulatorError, *others)
    try:
        yield
    except kinds as error:
        print(f'{program}: {error}', file=sys.stderr)
        sys.exit(code)


def exit_code_of(body: Callable[[], Any]) -> int:
    """Return the code with which ``body()`` exits; 0 if it returns. A text instead of a code is printed."""
    try:
        body()
    except SystemExit as error:
        if error.code is None or isinstance(error.code, int):
            return error.code or 0
        print(error.code, file=sys.stderr)
        return 1
    return 0
