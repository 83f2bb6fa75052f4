"""A program's memory lies at the same addresses in each run, so that an order by addresses is the same, too.

Otherwise the system chooses the addresses at random for each process. The environment variable
``MOVE_BASE_ABSTRACT_ADDRESS_LAYOUT`` chooses between the two: ``fixed`` or ``random``. ``MOVE_BASE_ABSTRACT_ARENAS``,
``on`` or ``off`` (the default), says whether Python's objects lie in the order in which they are made (machine/arenas).
"""
from __future__ import annotations

import ctypes
from typing import Any

from move_base_abstract.common.shown import shown

VARIABLE = 'MOVE_BASE_ABSTRACT_ADDRESS_LAYOUT'
FIXED, RANDOM = 'fixed', 'random'
ARENAS = 'MOVE_BASE_ABSTRACT_ARENAS'
_OFF, _ON = 'off', 'on'
#: the label of a run if the system does not allow a fixed layout
LABEL = ('the system does not let addresses be the same in each run (in a container: docker run --security-opt '
         'seccomp=unconfined; or set {}={} if nothing depends on them)'.format(VARIABLE, RANDOM))
_ASK = 0xffffffff
_NO_RANDOMIZE = 0x0040000  # of personality(2)
_KERNEL = '/proc/sys/kernel/randomize_va_space'


def wanted(environment: Any) -> str:
    """Return the layout that the environment asks for: FIXED (the default) or RANDOM.

    :raises ValueError: if the variable has another value.
    """
    return _one_of(environment, VARIABLE, FIXED, RANDOM)


def wants_arenas(environment: Any) -> bool:
    """Return whether the environment asks for arenas.

    :raises ValueError: if the variable has another value than ``on`` and ``off``.
    """
    return _one_of(environment, ARENAS, _OFF, _ON) == _ON


def _one_of(environment: Any, variable: str, default: str, other: str) -> str:
    value: str = environment.get(variable, default)
    if value not in (default, other):
        raise ValueError("the environment's {} must be '{}' or '{}', got {}".format(variable, default, other,
                                                                                      shown(value)))
    return value


def choose(environment: Any) -> bool:
    """Give the wanted layout to the programs that this process becomes or starts. Return whether that is a change.

    :raises ValueError: as :func:`wanted` does.
    """
    wants_arenas(environment)  # an error is one at once
    layout, now = wanted(environment), _personality(_ASK)
    new = now | _NO_RANDOMIZE if layout == FIXED else now & ~_NO_RANDOMIZE
    return now >= 0 and new != now and _personality(new) >= 0


def is_as_wanted(environment: Any) -> bool:
    """Return False if the layout should be fixed, and is not."""
    if environment.get(VARIABLE, FIXED) == RANDOM or _personality(_ASK) & _NO_RANDOMIZE:
        return True
    try:
        with open(_KERNEL) as setting:
            return setting.read().strip() == '0'
    except OSError:
        return False


def _personality(number: int) -> int:
    """Set the process's personality, and return the one before; -1 if the system does not allow it."""
    try:
        return ctypes.CDLL(None, use_errno=True).personality(ctypes.c_ulong(number))
    except (OSError, AttributeError):
        return -1

