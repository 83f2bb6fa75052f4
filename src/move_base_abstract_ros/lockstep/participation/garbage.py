"""Python's collector of cyclic garbage works after so many rounds, and not when so many objects have been made.

How many there are depends on what threads of rospy's do by the wall clock, and with it when `__del__` of an object in a
cycle, or the callback of a weak reference, is called. Rounds are the same in each run.
"""
import gc
from types import SimpleNamespace

from ...replacing.replaced import replace

#: after this many rounds: which generation, the oldest first
_EVERY = ((16384, 2), (1024, 1), (64, 0))

_state = SimpleNamespace(is_ours=False, is_wanted=True, rounds=0)


def install():
    """Have garbage collected in rounds from now on; the program can go on to switch that off and on."""
    gc.disable()
    _state.is_ours = True
    replace('gc.disable', lambda _disable: _stop)
    replace('gc.enable', lambda _enable: _go_on)


def due():
    """Return what is to be done in the round that begins: nothing, or to collect."""
    if not _state.is_ours:
        return []
    _state.rounds += 1
    if _state.rounds % _EVERY[-1][0] or not _state.is_wanted:
        return []
    generation = next(generation for rounds, generation in _EVERY if _state.rounds % rounds == 0)
    return [lambda: gc.collect(generation)]


def _stop():
    """Stands for gc.disable."""
    _state.is_wanted = False


def _go_on():
    """Stands for gc.enable."""
    _state.is_wanted = True
