"""Checks of the arguments of calls from outside, so that a value of the wrong kind is an error at once."""
from __future__ import annotations

import numbers
import operator
from typing import Dict

from .errors import ConfigurationError, TimeError
from .shown import shown
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
    raise ConfigurationError('{}: got {}; allowed: a number'.format(name, shown(value)))


def as_ns(value: object, name: str) -> int:
    """Return the time ``value`` [ns] as an int.

    :raises ConfigurationError: if it is not a whole number (also for the float 1e9); the text begins with ``name``.
    """
    try:
        if not isinstance(value, bool):
            return operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        pass
    raise ConfigurationError('{}: got {}; allowed: a whole number [ns]'.format(name, shown(value)))


def as_instant(value: object, name: str) -> int:
    """Return the instant ``value`` [ns] of simulated time as an int.

    :raises ConfigurationError: if it is not a whole number.
    :raises TimeError: if simulated time ends before; the text begins with ``name``.
    """
    time_ns = as_ns(value, name)
    try:
        check_reachable(time_ns, name)
    except ValueError as error:
        raise TimeError(str(error)) from None
    return time_ns


def check_kind(value: object, kind: type, name: str) -> None:
    """Check that ``value`` is an instance of ``kind``.

    :raises ConfigurationError: if it is not; the text begins with ``name``.
    """
    if not isinstance(value, kind):
        raise ConfigurationError('{}: got {}; allowed: {}'.format(name, shown(value), _KINDS.get(kind, kind.__name__)))


_KINDS: Dict[type, str] = {str: 'a text'}
