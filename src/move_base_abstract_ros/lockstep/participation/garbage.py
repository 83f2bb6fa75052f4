"""Python's collector of cyclic garbage runs after a number of rounds, and not after a number of new objects.

The number of objects depends on what rospy's threads do by the wall clock. So it would depend on the wall clock when
``__del__`` of an object in a cycle, or the callback of a weak reference, is called. Rounds are the same in each run.
"""
from __future__ import annotations

import gc
from types import SimpleNamespace
from typing import Any, Callable, List

from ...replacing.replaced import replace

#: (number of rounds, generation that is collected each time they are over), the oldest first
_EVERY = ((16384, 2), (1024, 1), (64, 0))

_state = SimpleNamespace(is_ours=False, is_wanted=True, rounds=0)


def install() -> None:
    """Collect garbage by rounds from now on. The program can still switch that off and on by gc.disable and enable."""
    gc.disable()
    _state.is_ours = True
    for name, is_wanted in (('gc.disable', False), ('gc.enable', True)):
        replace(name, lambda _original, by=is_wanted: lambda: setattr(_state, 'is_wanted', by))


def due() -> List[Callable[..., Any]]:
    """Count one more round; return the functions to be called in it: [] or one that collects."""
    if not _state.is_ours:
        return []
    _state.rounds += 1
    if _state.rounds % _EVERY[-1][0] or not _state.is_wanted:
        return []
    generation = next(generation for rounds, generation in _EVERY if _state.rounds % rounds == 0)
    return [lambda: gc.collect(generation)]
