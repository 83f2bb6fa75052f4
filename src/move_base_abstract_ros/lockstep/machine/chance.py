"""The program's random numbers follow from the run's seed, the node's name, and the number of earlier draws.

Python's and numpy's global generators are seeded so. So are the bytes that the machine would give: os.urandom, and all
that is made of it (secrets, SystemRandom, generators without a seed, also numpy's, uuid, temporary names). Threads that
lockstep does not order draw from other bytes, so that they do not disturb the others, and label the run.
"""
from __future__ import annotations

import functools
import os
import random
import sys
import tempfile
import uuid
import zlib
from typing import Any, Callable, Iterator

from move_base_abstract.common import temporary
from move_base_abstract.lockstep.machine_view import Entropy

from ...replacing.replaced import replace
from ..code.callers import asker, is_own, own_frame, sees_run
from ..code.labels import told

_STRAY = 'draws in a thread that lockstep does not order'
_BITS = 32  # number of bytes that seed a generator
_LETTERS = 'abcdefghijklmnopqrstuvwxyz0123456789_'  # of names of temporary files
_MULTICAST = 1 << 40  # bit in the node of uuid.uuid1: the node is not an address of hardware


def install(text: str, present_ns: Callable[..., Any]) -> Callable[..., Any]:
    """Seed the global generators, and make the program draw from the run's chance.

    :param text: the seed and the node's name.
    :param present_ns: function of a frame that returns the date [ns] that its code sees; None for the machine's.
    :return: a function ``draw(size)`` that returns bytes of the run's chance for the calling thread.
    """
    number = zlib.crc32(text.encode('utf-8'))
    random.seed(number)  # noqa: TID251 - the generator of the program, not ours
    chance = _Chance(text)
    replace('uuid.uuid1', lambda machine: _dated_identifier(machine, chance, present_ns))
    for name in ('os.urandom', 'random._urandom'):
        replace(name, lambda machine: lambda size, /: _or_else(chance.draw(size, sys._getframe(1)), machine, size))
    replace('os.getrandom', lambda machine: lambda size, flags=0: _or_else(
        chance.draw(size, sys._getframe(1)), machine, size, flags))
    replace('random.Random.seed', lambda seed: _seeding(seed, chance))
    replace('random.seed', lambda _seed: random._inst.seed)
    replace('tempfile._get_candidate_names', lambda machine: _naming(machine, chance))
    _follow_numpy(number)
    return chance.draw_in_turn


def _follow_numpy(number: int) -> None:
    """Seed numpy's generator from a ``number``, and have zeros in arrays of which the program has written nothing."""
    try:
        import numpy
    except ImportError:
        return
    numpy.random.seed(number)  # noqa: NPY002 - the generator of the program, not ours
    for name, zeros in (('numpy.empty', numpy.zeros), ('numpy.empty_like', numpy.zeros_like)):
        replace(name, lambda empty, zeros=zeros: _written(empty, zeros))


def _written(empty: Callable[..., Any], zeros: Callable[..., Any]) -> Callable[..., Any]:
    @functools.wraps(empty)
    def call(*args: Any, **kwds: Any) -> Any:
        made = zeros(*args, **kwds)
        return empty(*args, **kwds) if made.dtype.hasobject else made  # of objects, all are None
    return call


class _Chance:
    """The run's chance of this process: bytes for ordered threads, and other bytes for all others."""

    def __init__(self, text: str) -> None:
        self._ordered = Entropy(text + '\nentropy')
        self._strays = Entropy(text + '\nstrays')

    def draw_in_turn(self, size: int) -> Any:
        """Return ``size`` bytes for the calling thread, whichever code asks."""
        return (self._ordered if told.is_ordered() else self._strays).draw(size)

    def draw(self, size: int, frame: Any) -> Any:
        """Return ``size`` bytes for the code of a frame; None if it sees the machine's."""
        frame = asker(frame)
        if not sees_run(frame):
            return None
        if not told.is_ordered() and is_own(frame):
            told.tell(frame, 'chance', _STRAY)
        return self.draw_in_turn(size)


def _or_else(drawn: Any, machine: Any, *given: Any) -> Any:
    return machine(*given) if drawn is None else drawn


def _seeding(original: Callable[..., Any], chance: _Chance) -> Callable[..., Any]:
    def seed(self: random.Random, a: Any = None, version: int = 2) -> None:
        """Seed as random.Random.seed does; without a number, from the run's chance."""
        drawn = chance.draw(_BITS, sys._getframe(1)) if a is None else None
        original(self, a if drawn is None else int.from_bytes(drawn, 'little'), version)
    return seed


def _dated_identifier(machine: Callable[..., Any], chance: _Chance,
                      present_ns: Callable[..., Any]) -> Callable[..., Any]:
    """Return uuid1 with the run's date. If no node is given, it is drawn, since each computer has another address."""
    ticks_to_1970, last = 0x01b21dd213814000, [0]  # 100 ns since 1582, RFC 4122

    def uuid1(node: Any = None, clock_seq: Any = None) -> Any:
        frame = sys._getframe(1)
        now_ns = present_ns(frame)
        drawn = None if now_ns is None else chance.draw(8, frame)
        if drawn is None:
            return machine(node, clock_seq)
        ticks = last[0] = max(now_ns // 100 + ticks_to_1970, last[0] + 1)
        node = int.from_bytes(drawn[:6], 'little') | _MULTICAST if node is None else node
        clock_seq = int.from_bytes(drawn[6:], 'little') & 0x3fff if clock_seq is None else clock_seq
        return uuid.UUID(fields=(ticks & 0xffffffff, (ticks >> 32) & 0xffff, (ticks >> 48) & 0x0fff,
                                 (clock_seq >> 8) & 0x3f, clock_seq & 0xff, node), version=1)
    return uuid1


def _names(draw: Callable[[int], bytes]) -> Iterator[str]:
    """Yield names of temporary files, of the form of tempfile's names."""
    while True:
        number = int.from_bytes(draw(8), 'little')
        yield ''.join(_LETTERS[number // len(_LETTERS) ** place % len(_LETTERS)] for place in range(8))


def _naming(machine: Callable[..., Any], chance: _Chance) -> Callable[..., Any]:
    def names() -> Any:
        frame: Any = sys._getframe(1)
        while frame is not None and frame.f_globals.get('__name__') == tempfile.__name__:
            frame = frame.f_back
        if not is_own(frame):
            return machine()
        return _names(lambda size: _or_else(chance.draw(size, frame), os.urandom, size))
    return names


def is_taken(path: str, frame: Any) -> None:
    """Label the run if a file with the name of a new temporary file exists: tempfile then takes the next name."""
    frame = own_frame(frame)
    if frame is not None and isinstance(path, (str, bytes)) and os.path.lexists(path):
        told.tell(frame, 'tempfile', 'finds a file of an earlier run, which had the same name for it; another TMPDIR '
                  'for each run, or another --seed, helps')


def _is_ours(frame: Any) -> bool:
    return (frame.f_globals.get('__name__') or '').startswith('move_base_abstract')


def watch_paths(participant: Any, folder: str) -> None:
    """Label the run if others get a path in ``folder``, that for temporary files, while another run has the first one.

    ``participant`` is a Participant.
    """
    if not temporary.is_beside_another_run(folder):
        return
    text, add = os.fsencode(folder), participant.add

    def adding(item: Any) -> None:
        if type(item) is bytes and text in item:
            frame: Any = sys._getframe(1)
            while frame is not None and (not is_own(frame) or _is_ours(frame)):
                frame = frame.f_back
            told.tell_text('{}a path of a temporary file is sent, and is another one if no other run goes on beside '
                           'this one; another TMPDIR for each run helps'.format(frame and '{}, line {}: '.format(
                               frame.f_code.co_filename, frame.f_lineno) or ''))
        add(item)
    participant.add = adding
