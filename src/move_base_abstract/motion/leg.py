"""How a robot travels: a straight leg in closed form, from whose pieces the pose at any instant is computed."""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import List, Optional, Tuple

from ..common.units import seconds_to_ns
from .geometry import Pose2D, normalize_angle
from .phases import Phase, Profile, Segment, drive_pieces, turn_piece
from .pieces import Motion, Placed

_ROUNDING = 1e-9  # m
_INF = math.inf


@dataclass(frozen=True)
class MotionLimits:
    """Limits of one robot's motion in the plane.

    ``max_speed`` [m/s, > 0] along base_link x; ``acceleration`` [m/s^2, > 0; inf = speed changes take no time];
    ``turn_rate`` [rad/s, > 0; inf = turning takes no time].

    :raises ValueError: if a limit is not > 0 (NaN included), or the speed is not finite.
    """

    max_speed: float
    acceleration: float = math.inf
    turn_rate: float = math.inf

    def __post_init__(self) -> None:
        for name, unit in (('max_speed', 'm/s'), ('acceleration', 'm/s^2'), ('turn_rate', 'rad/s')):
            value = getattr(self, name)
            if not value > 0.0:
                raise ValueError('{} must be > 0 {}, got {!r}'.format(name, unit, value))
        if math.isinf(self.max_speed):
            raise ValueError('max_speed must be finite, got inf')


@dataclass(frozen=True)
class Tolerances:
    """How close to its goal a robot stops: ``xy`` [m, >= 0] short of it, ``yaw`` [rad, >= 0] short of its heading.

    :raises ValueError: if a tolerance is negative or NaN.
    """

    xy: float = 0.0
    yaw: float = 0.0

    def __post_init__(self) -> None:
        for name, unit in (('xy', 'm'), ('yaw', 'rad')):
            value = getattr(self, name)
            if not value >= 0.0:
                raise ValueError('{} tolerance must be >= 0 {}, got {!r}'.format(name, unit, value))


def trip(distance: float, max_speed: float, acceleration: float) -> Tuple[float, float, float]:
    """Return (highest speed [m/s], time to speed up [s], time of the whole trip [s]) of a :func:`speed_profile`.

    If only these numbers are needed, no profile has to be made.
    """
    if math.isinf(acceleration):
        return max_speed, 0.0, distance / max_speed if distance > 0.0 and max_speed > 0.0 else 0.0
    product = acceleration * distance
    # The product of two tiny numbers is 0. Then the speed would be 0, and the robot would arrive at once.
    peak = min(max_speed, math.sqrt(product) if product else math.sqrt(acceleration) * math.sqrt(distance))
    ramp = peak / acceleration
    return peak, ramp, 0.0 if distance <= 0.0 or peak <= 0.0 else distance / peak + ramp


def speed_profile(distance: float, max_speed: float, acceleration: float = math.inf) -> Profile:
    """Return the profile of travel over ``distance`` [m] from rest to rest: accelerate, cruise, decelerate.

    The motion is uniformly accelerated, with the acceleration a and the top speed v. A trip shorter than v^2/a never
    reaches v: it takes 2*sqrt(distance/a) seconds and peaks at sqrt(a*distance) after half of them. A longer trip takes
    distance/v + v/a seconds.
    """
    peak, ramp, seconds = trip(distance, max_speed, acceleration)
    if ramp == 0.0:
        return Profile(distance, seconds, (Phase(0.0, 0.0, peak),))
    gained = 0.5 * peak * ramp
    return Profile(distance, seconds, (
        Phase(0.0, 0.0, 0.0, acceleration), Phase(ramp, gained, peak),
        Phase(seconds - ramp, distance - gained, peak, -acceleration)))


class Leg(Motion):
    """One trip: turn towards the goal, drive straight, turn to the goal's heading. Immutable.

    The robot stops as soon as it is within the tolerances. ``depart_ns`` and ``arrive_ns`` are simulated time [ns];
    each of the three phases lasts a whole number of nanoseconds.
    """

    __slots__ = ('_limits', '_turns')

    def __init__(self, start: Pose2D, goal: Pose2D, limits: MotionLimits, tolerances: Tolerances = Tolerances(),
                 depart_ns: int = 0) -> None:
        dx, dy = goal.x - start.x, goal.y - start.y
        gap = math.hypot(dx, dy)
        self.distance = distance = gap if tolerances.xy == 0.0 < gap else left_to_drive(gap, tolerances.xy)
        self.start = start
        self._limits = limits
        self._kept = None
        self.depart_ns = depart_ns
        if distance > 0.0 and limits.acceleration == _INF:  # as :func:`trip` says, without a call
            seconds = distance / limits.max_speed
        else:
            seconds = trip(distance, limits.max_speed, limits.acceleration)[2]
        # the course of the drive, the turn before it and the turn after it [rad]; None: the turns take no time
        self._turns: Optional[Tuple[float, float, float]] = None
        if 0.0 < distance == gap < _INF == limits.turn_rate and tolerances.yaw == 0.0:  # most legs
            self.end = goal
            self.arrive_ns = depart_ns + seconds_to_ns(seconds)
            return
        course = math.atan2(dy, dx) if distance > 0.0 else start.yaw
        first = normalize_angle(course - start.yaw)
        last = turn_within(normalize_angle(goal.yaw - course), tolerances.yaw)
        self._turns = course, first, last
        self.end = self._end_pose(goal, gap, goal.yaw if tolerances.yaw == 0.0 else course + last)
        self.arrive_ns = depart_ns + seconds_to_ns(seconds) + seconds_to_ns(abs(first) / limits.turn_rate) + (
            seconds_to_ns(abs(last) / limits.turn_rate))

    def _end_pose(self, goal: Pose2D, gap: float, yaw: float) -> Pose2D:
        start = self.start
        if self.distance <= 0.0:
            return Pose2D(start.x, start.y, yaw)
        share = self.distance / gap
        if share == 1.0:
            return goal if yaw is goal.yaw else Pose2D(goal.x, goal.y, yaw)
        return Pose2D(start.x + share * (goal.x - start.x), start.y + share * (goal.y - start.y), yaw)

    @property
    def way(self) -> Tuple[Tuple[float, float], ...]:
        """The points ((x, y), ...) [m] of the leg: its start and its end, between which it is straight."""
        return (self.start.x, self.start.y), (self.end.x, self.end.y)

    def _stretches(self) -> List[Placed]:
        start, end, limits, distance, rate = self.start, self.end, self._limits, self.distance, self._limits.turn_rate
        course, first, last = self._turns or (start.bearing_to(end), 0.0, 0.0)
        drive_ns = self.depart_ns + seconds_to_ns(abs(first) / rate)
        turn_ns = self.arrive_ns - seconds_to_ns(abs(last) / rate)
        placed: List[Placed] = []
        if drive_ns > self.depart_ns:
            placed += turn_piece(self.depart_ns, start, start.yaw, math.copysign(rate, first), 0.0)
        if turn_ns > drive_ns:
            placed += drive_pieces(drive_ns, [Segment(start.x, start.y, course, distance)],
                                   speed_profile(distance, limits.max_speed, limits.acceleration), 0.0)
        if self.arrive_ns > turn_ns:
            placed += turn_piece(turn_ns, end, course, math.copysign(rate, last), distance)
        return placed


def left_to_drive(gap: float, tolerance: float) -> float:
    """Return the distance [m] that a robot must drive until a goal ``gap`` [m] away is within ``tolerance`` [m].

    A robot that has stopped at the edge of the tolerance is within it, whatever rounding says: it does not drive 1e-16
    m. So with a tolerance, less than 1e-9 m counts as 0.
    """
    left = gap - tolerance
    return left if left > (_ROUNDING if tolerance else 0.0) else 0.0


def turn_within(turn: float, tolerance: float) -> float:
    """Return the part of ``turn`` [rad] that brings the heading within ``tolerance`` [rad]."""
    return math.copysign(max(0.0, abs(turn) - tolerance), turn)
