"""Objects of the program's own classes are hashed by a number, not by their address, so that sets of them repeat.

If the program goes through a set of objects for which that is not possible, a warning names file and line, and the run
is labelled. :mod:`own_code` compiles the calls of this module into the program's classes and loops.
"""
from __future__ import annotations

import builtins
import sys
import weakref
from typing import AbstractSet, Any, Callable, Set, Tuple

from move_base_abstract.lockstep.object_order import BASES, ORDER
from move_base_abstract.lockstep.stable_hash import Address, bases_of, is_hashed_by_address, number_classes

from ...replacing.replaced import replace
from .callers import is_of_library
from .labels import told

_SHOWN = 3  # number of classes that a warning names


_told: Set[Tuple[str, int]] = set()  # the places that have been labelled


def install() -> None:
    """Make the program's classes and loops call this module, before its first line runs."""
    setattr(builtins, BASES, bases_of)
    setattr(builtins, ORDER, _see)
    replace('importlib.machinery.SourceFileLoader.exec_module', _executing)


def _executing(execute: Callable[..., None]) -> Callable[..., None]:
    """Return ``exec_module`` that also numbers objects of classes of libraries, as soon as these are imported."""
    def call(self: Any, module: Any) -> None:
        execute(self, module)
        if is_of_library(self.path):
            number_classes(module.__name__, vars(module))
    return call


def _see(value: Any) -> Any:
    """Return ``value``, through which the program goes. If its order is by addresses, warn once for each place."""
    kind = type(value)
    is_set = kind is set or kind is frozenset or isinstance(value, (set, frozenset, weakref.WeakSet))
    if kind is not int and isinstance(value, Address):
        told.tell(sys._getframe(1), 'id', 'gives an address, which differs from run to run')
    if is_set and len(value) > 1:
        frame = sys._getframe(1)
        place = frame.f_code.co_filename, frame.f_lineno
        if place not in _told:
            _look(value, place)
    return value


def _look(value: AbstractSet[Any], place: Tuple[str, int]) -> None:
    kinds = sorted({'{0.__module__}.{0.__qualname__}'.format(type(one)) for one in value if is_hashed_by_address(one)})
    if not kinds:
        return
    _told.add(place)
    shown = kinds[:_SHOWN] + ['...'] * (len(kinds) > _SHOWN)
    told.tell_text('{}, line {}: goes through a set of objects that Python hashes by their address ({}): its order '
                   'differs from run to run; a list or a dict keeps the order in which it was filled'.format(
                       *place, ', '.join(shown)))
