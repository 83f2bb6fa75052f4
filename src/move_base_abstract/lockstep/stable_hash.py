"""Hashes objects by a number instead of their address, so that sets of them have the same order in every run."""
from __future__ import annotations

import abc
import contextlib
import dataclasses
import itertools
import sys
import types
import weakref
from functools import lru_cache
from typing import Any, Callable, Dict, Iterator, Mapping, Tuple

_HASHED_BY_ADDRESS: Any = object.__hash__
_METHODS = (types.MethodType, types.BuiltinMethodType, types.MethodWrapperType)


class Numbered:
    """A base of the program's classes: an object's hash is its number, which it gets when its hash is first needed.

    Numbers count up, so they are the same in each run of a repeatable program. Equality does not change, and classes
    that define how they are compared or hashed stay as they are. Python's text for an object shows its number instead
    of its address. The numbers are kept apart from the objects, as long as these exist.
    """

    __slots__ = ()

    def __hash__(self) -> int:
        entry = _numbers.get(id(self))
        return entry.number if entry is not None else _number(self)

    def __repr__(self) -> str:
        if not type(self).__weakrefoffset__:
            return object.__repr__(self)  # its address, which is no number of ours
        return '<{0.__module__}.{0.__qualname__} object at 0x{1:012x}>'.format(type(self), Numbered.__hash__(self))


class Address(int):
    """The address of an object, which a program keeps as a key. It is hashed as any number."""


class _Placed:
    """Which of the objects that Python hashes by their addresses have the same hash in each run; by default none."""

    def __init__(self) -> None:
        self.knows: Callable[[Any], bool] = lambda _one: False


placed = _Placed()
_is_only_looked_at = [False]


@contextlib.contextmanager
def only_looked_at() -> Iterator[None]:
    """Give no numbers inside: a debugger shows an object whose hash nobody has asked for yet."""
    _is_only_looked_at[0] = True
    try:
        yield
    finally:
        _is_only_looked_at[0] = False


class _Number(weakref.ref):  # type: ignore[type-arg]
    __slots__ = ('key', 'number')
    key: int
    number: int


_numbers: Dict[int, _Number] = {}  # {id of an object: its number}
_count = itertools.count(1)


def _number(one: Numbered) -> int:
    if _is_only_looked_at[0]:
        return int(_HASHED_BY_ADDRESS(one))
    try:
        entry = _Number(one, _forget)
    except TypeError:
        number: int = _HASHED_BY_ADDRESS(one)
        return number  # its class has __slots__ without room for a weak reference
    entry.key, entry.number = id(one), next(_count)
    _numbers[entry.key] = entry
    return entry.number


def _forget(entry: _Number) -> None:
    if _numbers is not None:  # it is None at the end of Python
        _numbers.pop(entry.key, None)


def bases_of(*bases: Any) -> Tuple[Any, ...]:
    """Return the bases of a class of the program, with :class:`Numbered` if its objects would be hashed by address.

    Numbered comes last, but before ``object``. Classes with a metaclass of their own stay as they are, and so do
    exceptions and metaclasses.
    """
    if not all(isinstance(base, type) and _is_plain(base) for base in bases):
        return bases
    before = bases.index(object) if object in bases else len(bases)
    return bases[:before] + (Numbered,) + bases[before:]


def _is_plain(kind: Any) -> bool:
    return type(kind) in (type, abc.ABCMeta) and kind.__hash__ is _HASHED_BY_ADDRESS and not issubclass(
        kind, (BaseException, type))


def number_classes(module: str, names: Mapping[str, Any], within: str = '') -> None:
    """Hash objects of the classes that a ``module`` defines, {name: value}, by number, as :func:`bases_of` does."""
    for kind in list(names.values()):
        if isinstance(kind, type) and kind.__module__ == module and kind.__qualname__ == within + kind.__name__:
            if _is_plain(kind) and kind.__weakrefoffset__:
                _number_class(kind)
            number_classes(module, vars(kind), kind.__qualname__ + '.')


def _number_class(kind: Any) -> None:
    try:
        kind.__hash__ = Numbered.__hash__
        if kind.__repr__ is object.__repr__:
            kind.__repr__ = Numbered.__repr__
    except TypeError:
        pass  # it is made in C


def is_hashed_by_address(one: Any) -> bool:
    """Return whether an object's hash may differ from run to run."""
    kind: Any = type(one)
    by: Any = kind.__hash__
    if by is Numbered.__hash__:
        return not kind.__weakrefoffset__ and not placed.knows(one)
    if by in (tuple.__hash__, frozenset.__hash__):
        return any(is_hashed_by_address(part) for part in one)
    if by is float.__hash__:
        return one != one and sys.version_info >= (3, 10)  # NaN
    if issubclass(kind, Address):
        return True
    if isinstance(one, weakref.ref):
        return one() is None or is_hashed_by_address(one())
    if by is _HASHED_BY_ADDRESS or kind is types.MethodType:
        return not placed.knows(one) and not (
            kind is types.MethodType and placed.knows(one.__self__) and placed.knows(one.__func__))
    return kind in _METHODS or any(
        is_hashed_by_address(getattr(one, name)) for name in _hashed_fields(kind))


@lru_cache(maxsize=None)
def _hashed_fields(kind: Any) -> Tuple[str, ...]:
    """Return the fields from which a dataclass makes the hash of its objects; () for any other class."""
    params = getattr(kind, '__dataclass_params__', None)
    code = getattr(kind.__hash__, '__code__', None)
    is_made = params is not None and code is not None and code.co_filename == '<string>'
    return tuple(field.name for field in dataclasses.fields(kind) if (
        field.compare if field.hash is None else field.hash)) if is_made else ()
