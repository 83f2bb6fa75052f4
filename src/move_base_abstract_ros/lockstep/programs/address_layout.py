"""Where a program's memory lies: at the same addresses in each run, so that what is ordered by them is the same too.

The system otherwise chooses them at random for each process. ``MOVE_BASE_ABSTRACT_ADDRESS_LAYOUT`` says which it is.
"""
import ctypes

from move_base_abstract.common.shown import shown

VARIABLE = 'MOVE_BASE_ABSTRACT_ADDRESS_LAYOUT'
FIXED, RANDOM = 'fixed', 'random'
#: why a run is not repeatable where the system does not let the layout be fixed
LABEL = ('the system does not let addresses be the same in each run (in a container: docker run --security-opt '
         'seccomp=unconfined; or set {}={} if nothing depends on them)'.format(VARIABLE, RANDOM))
_ASK = 0xffffffff
_NO_RANDOMIZE = 0x0040000  # of personality(2)
_KERNEL = '/proc/sys/kernel/randomize_va_space'


def wanted(environment):
    """Return which layout the environment asks for: FIXED (the default) or RANDOM.

    :raises ValueError: if it is something else.
    """
    layout = environment.get(VARIABLE, FIXED)
    if layout not in (FIXED, RANDOM):
        raise ValueError("the environment's {} must be '{}' or '{}', got {}".format(VARIABLE, FIXED, RANDOM,
                                                                                      shown(layout)))
    return layout


def choose(environment):
    """Have the programs that this process becomes, or starts, get the layout asked for. Return whether that is new.

    :raises ValueError: as :func:`wanted`.
    """
    layout, now = wanted(environment), _personality(_ASK)
    new = now | _NO_RANDOMIZE if layout == FIXED else now & ~_NO_RANDOMIZE
    return now >= 0 and new != now and _personality(new) >= 0


def is_as_wanted(environment):
    """Return False if the layout is to be fixed, and is not."""
    if environment.get(VARIABLE, FIXED) == RANDOM or _personality(_ASK) & _NO_RANDOMIZE:
        return True
    try:
        with open(_KERNEL) as setting:
            return setting.read().strip() == '0'
    except OSError:
        return False


def _personality(number):
    """Set the process's personality, and return what it was; -1: the system does not let us."""
    try:
        return ctypes.CDLL(None, use_errno=True).personality(ctypes.c_ulong(number))
    except (OSError, AttributeError):
        return -1

