"""When a robot that is driven by velocities enters or leaves a zone: to the nanosecond, on arcs."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Iterator, List, Mapping, Optional, Sequence, Tuple

from ..common.units import NS_PER_S
from ..engine.instants import first_ns

if TYPE_CHECKING:
    from ..motion.pieces import Motion, Piece
    from .way import ZoneIndex

_STRAIGHT = 1e-8  # rad; an arc with a smaller turn is less than a micrometre beside the straight line
_NEAR = 1e-3  # m; the accuracy with which meetings with borders are guessed


def next_change(motion: Motion, zones: ZoneIndex, held: Mapping[Any, bool], now_ns: int) -> Optional[Tuple[int, Any]]:
    """Return (the first instant [ns] after ``now_ns`` at which ``motion`` enters or leaves a zone, the zone), or None.

    ``held``: the areas in which the robot is now.
    """
    for piece, last_ns in motion.spans():
        if last_ns <= now_ns or piece.v == 0.0:
            continue
        begin_ns = max(now_ns, piece.begin_ns)
        turn_ns = math.ceil(2.0 * math.pi * NS_PER_S / abs(piece.w)) if abs(piece.w) > 1e-9 else last_ns
        end_ns = min(last_ns, begin_ns + turn_ns)  # one turn says it all
        found = [(at_ns, number, area) for number, area in enumerate(_near(piece, zones, begin_ns, end_ns))
                 for at_ns in [_change_ns(motion, area, area in held, _cuts(piece, area, begin_ns, end_ns))]
                 if at_ns is not None]
        if found:
            return min(found)[0], min(found)[2]
    return None


def _near(piece: Piece, zones: ZoneIndex, begin_ns: int, end_ns: int) -> List[Any]:
    """Return the zones that may be met on the piece up to ``end_ns`` [ns]."""
    way = abs(piece.v) * (end_ns - piece.begin_ns) / NS_PER_S + _NEAR
    reach = min(way, 2.0 * abs(piece.v / piece.w) + _NEAR) if piece.w else way
    return zones.near(piece.x - reach, piece.y - reach, piece.x + reach, piece.y + reach)


def _change_ns(motion: Motion, area: Any, was_inside: bool, cuts: Sequence[int]) -> Optional[int]:
    """Return the first instant at which it is otherwise than ``was_inside``; it changes near ``cuts`` [ns] only."""
    def has_changed(at_ns: int) -> bool:
        pose = motion.pose_at(at_ns)
        is_inside: bool = area.contains(pose.x, pose.y)
        return is_inside != was_inside
    before_ns = cuts[0]
    for begin_ns, end_ns in zip(cuts, cuts[1:]):
        middle_ns = (begin_ns + end_ns) // 2
        if has_changed(middle_ns):
            return first_ns(before_ns, middle_ns, has_changed, begin_ns)
        before_ns = middle_ns
    return None


def _cuts(piece: Piece, area: Any, begin_ns: int, end_ns: int) -> List[int]:
    """Return begin, end and, about, the instants [ns] between at which the piece meets the border of ``area``."""
    points = area.outline.points
    found = [begin_ns, end_ns]
    for one, other in zip(points, (*points[1:], points[0])):
        for seconds in _meetings(piece, one, other, (begin_ns - piece.begin_ns) / NS_PER_S,
                                 (end_ns - piece.begin_ns) / NS_PER_S):
            at_ns = piece.begin_ns + int(seconds * NS_PER_S)
            if begin_ns < at_ns < end_ns:
                found.append(at_ns)
    return sorted(set(found))


def _meetings(piece: Piece, one: Tuple[float, float], other: Tuple[float, float], low: float,
              high: float) -> Iterator[float]:
    """Yield after how long [s], from ``low`` to ``high``, the piece meets the line through two points, near these."""
    length = math.hypot(other[0] - one[0], other[1] - one[1])
    along = (other[0] - one[0]) / length, (other[1] - one[1]) / length
    x, y = piece.x - one[0], piece.y - one[1]
    aside = along[0] * y - along[1] * x  # of its begin, to the left of the edge [m]
    rise, bend = along[0] * piece.uy - along[1] * piece.ux, along[0] * piece.ux + along[1] * piece.uy
    if abs(piece.w) * high <= _STRAIGHT:
        guesses = [-aside / (piece.v * rise)] if rise else []
    else:  # aside + v / w (rise sin(angle) + bend (1 - cos(angle))) = 0
        sine = -(aside * piece.w / piece.v + bend)
        if abs(sine) > 1.0 + 1e-9:
            return
        base, turn = math.atan2(bend, rise), math.asin(min(1.0, max(-1.0, sine)))
        guesses = _of_angles((base + turn, base + math.pi - turn), piece.w, low, high)
    for guess in guesses:
        half = 0.5 * piece.w * guess
        chord = piece.v * guess * (math.sin(half) / half if half else 1.0)
        way = along[0] * x + along[1] * y + chord * (bend * math.cos(half) - rise * math.sin(half))
        if -_NEAR <= way <= length + _NEAR:
            yield guess


def _of_angles(angles: Sequence[float], turn_rate: float, low: float, high: float) -> List[float]:
    """Return the times [s] from ``low`` to ``high`` at which the angle turned is one of ``angles`` [rad], or more."""
    period = 2.0 * math.pi / abs(turn_rate)
    firsts = [angle / turn_rate for angle in angles]
    return [first + number * period for first in firsts
            for number in range(math.floor((low - first) / period), math.ceil((high - first) / period) + 1)]
