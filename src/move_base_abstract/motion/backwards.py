"""Driving backwards along the first part of a way, in closed form, and dividing a way for it."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Callable, List, Sequence, Tuple

from ..common.units import NS_PER_S
from .geometry import normalize_angle
from .phases import Profile, Segment, drive_pieces

if TYPE_CHECKING:
    from .pieces import Placed

_HALVINGS = 60  # steps of the bisection for a length


def backwards_pieces(begin_ns: int, segments: Sequence[Segment], profile: Profile, yaw: float,
                     driven: float) -> List[Placed]:
    """Return the pieces of a drive backwards, at constant speed, as :func:`.phases.drive_pieces` does.

    Meanwhile the heading turns evenly from ``yaw`` [rad] until the robot's back points in the direction in which it
    drives.
    """
    turn = normalize_angle(segments[0].course + math.pi - yaw)
    placed = []
    for piece, covered in drive_pieces(begin_ns, segments, profile, driven):
        left = turn * (1.0 - (piece.begin_ns - begin_ns) / NS_PER_S / profile.seconds)
        placed.append((piece._replace(yaw=normalize_angle(piece.yaw + math.pi - left), ux=-piece.ux, uy=-piece.uy,
                                      v=-piece.v, w=turn / profile.seconds), covered))
    return placed


def parted(pieces: Sequence[Segment], length: float) -> Tuple[List[Segment], List[Segment]]:
    """Return (the first ``length`` [m] of ``pieces`` (Segment, ...), the rest of them), both as lists of Segments."""
    before: List[Segment] = []
    behind: List[Segment] = []
    for piece in pieces:
        begin = length - sum([one.length for one in before], 0.0)
        if begin >= piece.length:
            before.append(piece)
        elif begin <= 0.0 or behind:
            behind.append(piece)
        else:
            place = piece.at(begin)
            before.append(piece._replace(length=begin))
            behind.append(piece._replace(x=place.x, y=place.y, length=piece.length - begin))
    return before, behind


def length_backwards(extra: float, length: float, speed: float, seconds_of: Callable[[float], float]) -> float:
    """Return the length [m] that must be driven backwards at ``speed`` [m/s] to make a drive ``extra`` [s] longer.

    The drive has the whole ``length`` [m]; ``seconds_of(length)`` returns the time [s] of a drive forwards. If even
    driving all of it backwards adds no more than ``extra``, the result is ``length``.
    """
    low, high = 0.0, length
    whole = seconds_of(length)
    if length / speed - whole <= extra:
        return length
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if middle / speed + seconds_of(length - middle) - whole < extra:
            low = middle
        else:
            high = middle
    return low
