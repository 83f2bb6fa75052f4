"""Addresses of objects that are made in turns, and hashes of functions, that are the same in each run.

The preloaded library (src/python_shim/objects.cpp) gives each class an arena at an address that follows from its name,
in which objects lie in the order in which turns make them. It does so if the environment variable
``MOVE_BASE_ABSTRACT_ARENAS`` is ``on``. Objects of classes that are left out, of types made in C, and functions
that were a key already when this began, keep addresses that differ from run to run.
"""
from __future__ import annotations

import ctypes
import gc
import sys
import tracemalloc
import types
import weakref
from typing import Any, Iterator, List, Mapping, Optional, Set

from move_base_abstract.lockstep import stable_hash

from ..code.labels import told
from ..programs import address_layout, native_library
from .native import native

#: the versions of Python whose types are laid out as the library knows them, and in which nothing allocates past it
PYTHON = ((3, 11),)
#: modules and packages of Python's library of which only the program makes objects; locks and threads are made by any
#: thread that is the first to need something
_OF_PROGRAM = frozenset(('asyncio', 'collections', 'concurrent', 'random', 'sched'))
#: besides the rest of it: those of which ROS and this package make objects at any moment, as they connect and wait
LEFT_OUT = ('move_base_abstract.lockstep.locks', 'move_base_abstract.lockstep.stable_hash', 'move_base_abstract_ros',
            'rosgraph', 'rospy.core', 'rospy.msproxy', *('rospy.impl.' + name for name in (
                'init', 'masterslave', 'paramserver', 'registration', 'rosout', 'simtime', 'statistics', 'tcpros',
                'tcpros_base', 'tcpros_pubsub', 'transport', 'udpros')))
_ABSENT = 'the arenas of {} cannot be used: {}'.format(address_layout.ARENAS, '{}')
#: labels for the bits of Arenas::Trouble
_TROUBLE = ('addresses of objects are used again, after threads that lockstep does not order have given some back',
            'there is no more memory for arenas: further objects lie at addresses that differ from run to run')
_KEYED: Any = (dict, set, frozenset)
_PLAIN = frozenset((str, int, type, type(None)))


class _Arenas:
    library: Any = None
    trouble: Any = (0,)  # bits of Arenas::Trouble
    told = 0  # those that have been told


def install(environment: Mapping[str, str]) -> None:
    """Begin, if the environment wants it. Call this in the main thread, before the program's first line runs."""
    if not address_layout.wants_arenas(environment):
        return
    reason = _begin(address_layout.wanted(environment) == address_layout.RANDOM)
    if reason is not None:
        told.tell_text(_ABSENT.format(reason))


def _begin(is_random: bool) -> Optional[str]:
    """Make classes allocate in arenas; return None, or why that is not possible."""
    if sys.implementation.name != 'cpython' or sys.version_info[:2] not in PYTHON:
        return 'they know Python {}, and this is {}.{}'.format(
            ' and '.join('{}.{}'.format(*version) for version in PYTHON), *sys.version_info[:2])
    if not native_library.is_loaded():
        return 'the library {} is not in this process'.format(native_library.LIBRARY)
    if tracemalloc.is_tracing():  # when it stops, it would put the allocators back that were there before
        return 'tracemalloc follows allocations'
    library = ctypes.PyDLL(None)
    for name in ('arenas_of', 'hashed', 'is_hashed_by_name'):
        getattr(library, 'move_base_abstract_native_' + name).argtypes = [ctypes.py_object]
    in_use = _functions_in_use()
    of_python = sorted(vars(sys)['stdlib_module_names'] - _OF_PROGRAM)
    left_out = ''.join('\n' + name for name in (*of_python, *LEFT_OUT)) + '\n'
    failed = library.move_base_abstract_native_arenas(ctypes.py_object(_Arenas), int(is_random),
                                                      left_out.encode())
    if failed:
        return ('this Python is built in another way', 'the system does not give the addresses (ulimit -v)')[failed - 1]
    for one in in_use:
        library.move_base_abstract_native_hashed(one)
    for kind in _classes(object, set()):
        library.move_base_abstract_native_arenas_of(kind)
    library.move_base_abstract_native_arenas_has.argtypes = [ctypes.c_void_p]
    _Arenas.library, _Arenas.trouble = library, native.trouble()
    stable_hash.placed.knows = _knows
    return None


def _classes(kind: Any, seen: Set[Any]) -> Set[Any]:
    """Return ``kind`` and all classes derived from it, with those that are ``seen``."""
    waiting = [kind]
    while waiting:
        one = waiting.pop()
        if one not in seen:
            seen.add(one)
            waiting += type.__subclasses__(one)
    return seen


def _functions_in_use() -> List[Any]:
    """Return the functions that are part of a key, so that their hashes must stay as they are."""
    is_frozen = gc.get_freeze_count() > 0
    gc.unfreeze()  # those of the process from which this one was forked count, too
    objects = gc.get_objects()
    if is_frozen:
        gc.freeze()
    keys = [one() for one in objects if type(one) is weakref.ref]
    for one in objects:
        if isinstance(one, _KEYED):
            iterate = next(kind.__iter__ for kind in _KEYED if isinstance(one, kind))  # that of a subclass may do more
            if not _PLAIN.issuperset(map(type, iterate(one))):
                keys += iterate(one)
    return list(_functions(keys))


def _functions(keys: Any) -> Iterator[Any]:
    for one in keys:
        kind = type(one)
        if kind not in _PLAIN and isinstance(one, (tuple, frozenset)):
            yield from _functions(one)
        elif kind is types.MethodType:
            yield from _functions([one.__func__])
        elif kind is types.FunctionType:
            yield one


def are_on() -> bool:
    """Return whether objects that are made in turns lie at addresses that are the same in each run."""
    return _Arenas.library is not None


def holds(address: int) -> bool:
    """Return whether what lies at an address lies there in each run."""
    return are_on() and bool(_Arenas.library.move_base_abstract_native_arenas_has(address))


def _knows(one: Any) -> bool:
    """Return whether an object that Python hashes by its address has the same hash in each run."""
    if type(one) is types.FunctionType:
        return bool(_Arenas.library.move_base_abstract_native_is_hashed_by_name(one))
    return holds(id(one))


def follow(participant: Any) -> None:
    """Report to ``participant`` from now on what makes addresses differ; None: to nobody."""
    if participant is not None and are_on():
        participant.last_words.append(_tell)


def _tell() -> None:
    trouble = _Arenas.trouble[0]
    if trouble != _Arenas.told:
        for bit, text in enumerate(_TROUBLE):
            if trouble & ~_Arenas.told & 1 << bit:
                told.tell_text(text)
        _Arenas.told = trouble
