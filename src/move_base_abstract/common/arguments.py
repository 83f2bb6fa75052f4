"""Checks of the arguments of calls from outside, so that a value of the wrong kind is an error at once."""
from __future__ import annotations

import numbers
import operator
import os
from typing import Dict, Optional

from .errors import TimeError
from .kinds import error
from .units import check_reachable


def as_float(value: object, name: str) -> float:
    """Return the number ``value`` as a float, which may be NaN or infinite.

    :raises ConfigurationError: if it is not a number, or too large for a float; the text begins with ``name``.
    """
    if type(value) is float:  # nearly always true; the check for all kinds of numbers takes ten times as long
        return value
    try:
        if isinstance(value, numbers.Real) and not isinstance(value, bool):
            return float(value)
    except OverflowError:
        pass
    raise error(name, value, 'a number')


def as_ns(value: object, name: str) -> int:
    """Return the time ``value`` [ns] as an int.

    :raises ConfigurationError: if it is not a whole number (also for the float 1e9); the text begins with ``name``.
    """
    try:
        if not isinstance(value, bool):
            return operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        pass
    raise error(name, value, 'a whole number [ns]')


def as_instant(value: object, name: str) -> int:
    """Return the instant ``value`` [ns] of simulated time as an int.

    :raises ConfigurationError: if it is not a whole number.
    :raises TimeError: if simulated time ends before; the text begins with ``name``.
    """
    time_ns = as_ns(value, name)
    try:
        check_reachable(time_ns, name)
    except ValueError as fault:
        raise TimeError(str(fault)) from None
    return time_ns


def check_kind(value: object, kind: type, name: str, allowed: Optional[str] = None) -> None:
    """Check that ``value`` is an instance of ``kind``; ``allowed``: that in words, with a way to get one.

    :raises ConfigurationError: if it is not; the text begins with ``name``.
    """
    if not isinstance(value, kind):
        raise error(name, value, allowed or _KINDS.get(kind, kind.__name__))


_KINDS: Dict[type, str] = {str: 'a text', bool: 'True or False'}


def check_path(value: object, name: str) -> None:
    """Check that ``value`` is the path of a file. :raises ConfigurationError: if not; the text begins with ``name``."""
    if not isinstance(value, (str, os.PathLike)):
        raise error(name, value, 'the path of a file')


def check_function(value: object, call: str) -> None:
    """Check that ``value`` can be called; ``call``: how it is called, 'name(argument, ...)', for the error.

    :raises ConfigurationError: if it cannot be called.
    """
    if not callable(value):
        raise error(call.partition('(')[0], value, f'a function that is called as {call}')


def check_method(value: object, method: str, name: str, allowed: str) -> None:
    """Check that ``value`` is an object with this ``method``, and not a class; ``allowed``: that in words.

    :raises ConfigurationError: if it is not; the text begins with ``name``.
    """
    if isinstance(value, type) or not callable(getattr(value, method, None)):
        raise error(name, value, allowed)
