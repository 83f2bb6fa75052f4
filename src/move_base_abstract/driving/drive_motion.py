"""The motion of a robot that is driven by velocities: arcs, one for each twist, and how a twist comes to another one.

The law of limited accelerations is that of diff_drive_controller (``SpeedLimiter``): from one control period to the
next, each component of the twist comes nearer to the command by no more than its acceleration times the period. In
between the twist is constant, so that each piece is an arc.
"""
from __future__ import annotations

import math
from typing import Iterator, List, NamedTuple, Sequence, Tuple

from ..common.units import NS_PER_S
from ..motion.geometry import Pose2D
from ..motion.pieces import Motion, Piece, Placed, pose_of
from .settings import DriveSettings, Limits

#: the time [ns] for which a motion with a twist that does not end is known in advance
HORIZON_NS = 60 * NS_PER_S
_ROUNDED = 1.0 + 1e-9  # so that no step is left that rounding has made
_MOST_STEPS = 1000  # of one motion, while an acceleration is limited


class Twist(NamedTuple):
    """A velocity in base_link: ``forward``, ``lateral`` (to the left) [m/s], ``turning`` (to the left) [rad/s]."""

    forward: float = 0.0
    lateral: float = 0.0
    turning: float = 0.0


REST = Twist()
#: an instant [ns], and the twist from then on
Step = Tuple[int, Twist]


class DriveMotion(Motion):
    """The motion from the pose ``start`` through ``steps`` ([Step, ...], at least one), which ends at ``end_ns`` [ns].

    :raises ValueError: if it leads beyond the farthest position.
    """

    __slots__ = ()
    is_from_rest = False

    def __init__(self, start: Pose2D, steps: Sequence[Step], end_ns: int) -> None:
        self.depart_ns, self.arrive_ns, self.start = steps[0][0], end_ns, start
        self.distance, pieces, driven = 0.0, [], []
        for (begin_ns, twist), until_ns in zip(steps, (*(begin_ns for begin_ns, _ in steps[1:]), end_ns)):
            if begin_ns == end_ns:
                break  # at rest from then on
            pieces.append(arc(start, twist, begin_ns))
            driven.append(self.distance)
            length = abs(pieces[-1].v) * ((until_ns - begin_ns) / NS_PER_S)
            self.distance += length
            bulge = min(0.5 * length, abs(2.0 * pieces[-1].v / twist.turning)) if twist.turning else 0.0
            Pose2D(abs(start.x) + bulge, abs(start.y) + bulge)  # between its ends an arc may lead beyond them
            start = pose_of(pieces[-1], until_ns)
        self.end = start
        self._kept = tuple(pieces), [*driven, self.distance]

    def _stretches(self) -> Iterator[Placed]:
        return zip(*self._law())

    @property
    def way(self) -> Tuple[Tuple[float, float], ...]:
        """The points ((x, y), ...) [m] at which its arcs begin, and its end."""
        return (*((piece.x, piece.y) for piece in self.pieces), (self.end.x, self.end.y))


def arc(pose: Pose2D, twist: Twist, begin_ns: int) -> Piece:
    """Return the piece of a robot that is at ``pose`` at ``begin_ns`` [ns] and drives with ``twist`` from then on."""
    forward, lateral, turning = twist
    cosine, sine = math.cos(pose.yaw), math.sin(pose.yaw)
    speed = math.sqrt(forward * forward + lateral * lateral)
    if lateral == 0.0 or speed == 0.0:
        return Piece(begin_ns, pose.x, pose.y, pose.yaw, cosine, sine, forward, 0.0, turning, -1.0)
    ahead, aside = forward / speed, lateral / speed
    return Piece(begin_ns, pose.x, pose.y, pose.yaw, ahead * cosine - aside * sine, ahead * sine + aside * cosine,
                 speed, 0.0, turning, -1.0)


def steps_towards(wanted: Twist, before: Step, settings: DriveSettings, now_ns: int) -> List[Step]:
    """Return the steps from ``now_ns`` [ns] on by which the twist comes to ``wanted``; the last one may be short of it.

    ``before``: the last step before now. A twist whose change is limited changes no sooner than a control period later.
    """
    stepped_ns, twist = before
    limits, period_ns = settings.limits, settings.period_ns
    if all(math.isinf(one.most_change) for one in limits):
        return [(now_ns, wanted)]
    at_ns = max(now_ns, stepped_ns + period_ns)
    steps = [(now_ns, twist)] if at_ns > now_ns else []
    while twist != wanted and len(steps) < _MOST_STEPS:
        twist = Twist(*(_nearer(*one, period_ns / NS_PER_S) for one in zip(twist, wanted, limits)))
        steps.append((at_ns, twist))
        at_ns += period_ns
    return steps or [(now_ns, twist)]


def _nearer(value: float, wanted: float, limits: Limits, seconds: float) -> float:
    """Return ``value`` after one control period on its way to ``wanted``, which is within its limits."""
    least, most = limits.least_change * seconds, limits.most_change * seconds
    if least * _ROUNDED <= wanted - value <= most * _ROUNDED:
        return wanted
    return value + (most if wanted > value else least)
