"""A robot's motion in the form that is sent to the time master: pieces with position, speed and acceleration."""
from __future__ import annotations

import struct
from typing import Any, Iterator, List, Tuple

_PIECE = struct.Struct('<q6d')  # begin [ns, simulated], x, y [m], their speeds [m/s] and accelerations [m/s^2]
_NS_PER_S = 1_000_000_000
#: the number of pieces for a span of time in which the speed does not change evenly
RAMP_PIECES = 8

Numbers = Tuple[float, float, float]


def pieces_of(robot: Any, now_ns: int) -> bytes:
    """Return the pieces of a :class:`.motion.robot.Robot` from ``now_ns`` [ns] on, the last one at rest.

    Each piece is the quadratic through the positions at its begin, middle and end. If the acceleration is constant,
    that is the motion itself, except for rounding. If the robot brakes in proportion to the distance left, there are
    RAMP_PIECES pieces for each ramp.
    """
    leg = robot.leg
    if leg is None or leg.arrive_ns <= now_ns:
        pose = robot.pose_at(now_ns)
        return _PIECE.pack(now_ns, pose.x, pose.y, 0.0, 0.0, 0.0, 0.0)
    instants = [now_ns, *(one for one in leg.even_instants_ns(RAMP_PIECES) if now_ns < one < leg.arrive_ns),
                leg.arrive_ns]
    packed = [_PIECE.pack(begin, *_numbers(leg, begin, end)) for begin, end in zip(instants, instants[1:])]
    return b''.join([*packed, _PIECE.pack(leg.arrive_ns, leg.end.x, leg.end.y, 0.0, 0.0, 0.0, 0.0)])


def _numbers(leg: Any, begin: int, end: int) -> Iterator[float]:
    """Return x, y, their speeds and accelerations of the piece from ``begin`` to ``end`` [ns]."""
    half_ns = (end - begin) // 2
    if not half_ns:  # the piece lasts a nanosecond
        pose = leg.pose_at(begin)
        return iter((pose.x, pose.y, 0.0, 0.0, 0.0, 0.0))
    poses = [leg.pose_at(instant) for instant in (begin, begin + half_ns, end)]
    seconds = half_ns / _NS_PER_S, (end - begin) / _NS_PER_S
    x, y = (_through([getattr(pose, axis) for pose in poses], *seconds) for axis in 'xy')
    return iter([one for pair in zip(x, y) for one in pair])


def _through(places: List[float], half: float, whole: float) -> Numbers:
    """Return position, speed, acceleration at 0 of the quadratic through ``places`` at 0, ``half``, ``whole`` [s]."""
    middle, last = places[1] - places[0], places[2] - places[0]
    acceleration = 2.0 * (last / whole - middle / half) / (whole - half)
    return places[0], middle / half - 0.5 * acceleration * half, acceleration
