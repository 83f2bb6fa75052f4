"""Motions as others are told of them, in the event log and by the time master: pieces, the last one at rest."""
from __future__ import annotations

import math
import struct
from itertools import accumulate
from typing import TYPE_CHECKING, Any, Iterable, Optional, Sequence, Tuple

from ..common.units import FARTHEST_M, LAST_NS, NS_PER_S
from .pieces import Motion, Piece, gone, pose_of, stand

if TYPE_CHECKING:
    from .robot import Robot

_PACKED = struct.Struct('<q9d')  # src/motion/motion.h reads it
_MOST = 1e15  # m/s, m/s^2, rad/s, 1/s; so that no number of a motion overflows


def told(motion: Motion) -> Tuple[Piece, ...]:
    """Return the pieces of ``motion``, and the rest at its end from the arrival on."""
    return (*motion.pieces, stand(motion.end, motion.arrive_ns))


def told_of(robot: Robot, now_ns: int) -> Tuple[Piece, ...]:
    """Return what is told of a robot at ``now_ns`` [ns]: its leg, or that it stands."""
    leg = robot.leg
    return (stand(robot.pose_at(now_ns), now_ns),) if leg is None or leg.arrive_ns <= now_ns else told(leg)


def packed(pieces: Iterable[Piece]) -> bytes:
    """Return ``pieces`` as the time master reads them: each an i64 and nine f64, little endian."""
    return b''.join([_PACKED.pack(*piece) for piece in pieces])


class ToldMotion(Motion):
    """The motion that has been told as ``pieces`` (Piece, ...), of which the last one is at rest."""

    __slots__ = ()

    def __init__(self, pieces: Sequence[Piece]) -> None:
        first, last = pieces[0], pieces[-1]
        self.depart_ns, self.arrive_ns = first.begin_ns, last.begin_ns
        self.start, self.end = pose_of(first, first.begin_ns), pose_of(last, last.begin_ns)
        driven = [0.0, *accumulate(abs(gone(one, other.begin_ns)[0]) for one, other in zip(pieces, pieces[1:]))]
        self.distance = driven[-1]
        self._kept = tuple(pieces[:-1]), driven

    @property
    def way(self) -> Tuple[Tuple[float, float], ...]:
        """As in :class:`.pieces.Motion`."""
        return (*((piece.x, piece.y) for piece in self.pieces), (self.end.x, self.end.y))


def motion_of_row(values: Sequence[Any]) -> Optional[ToldMotion]:
    """Return the motion of the values of a row ``pieces``, None if they are none: any program may write a row."""
    if not values or not all(isinstance(value, list) and len(value) == len(Piece._fields) and type(value[0]) is int
                             and all(type(one) in (int, float) and abs(one) <= _MOST for one in value[1:])
                             for value in values):
        return None
    pieces = [Piece(value[0], *map(float, value[1:])) for value in values]
    ends_ns = [*(piece.begin_ns for piece in pieces[1:]), LAST_NS + 1]
    good = pieces[0].begin_ns >= 0 and not any(pieces[-1][6:9]) and all(map(_is_possible, pieces, ends_ns))
    return ToldMotion(pieces) if good else None


def _is_possible(piece: Piece, end_ns: int) -> bool:
    """Return whether ``piece`` ends at ``end_ns`` [ns] after its begin, and up to then leads nowhere too far away."""
    seconds = (end_ns - piece.begin_ns) / NS_PER_S
    reach = (abs(piece.v) + abs(piece.a) * seconds) * seconds * (
        math.hypot(piece.ux, piece.uy) if piece.k else max(abs(piece.ux), abs(piece.uy)))
    is_known = piece.k >= 0.0 or piece.k == -1.0 and piece.a == 0.0
    return seconds > 0.0 and is_known and max(abs(piece.x), abs(piece.y)) + reach <= FARTHEST_M
