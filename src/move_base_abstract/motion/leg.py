"""How a robot travels: a straight leg in closed form, from which the pose at any instant is computed exactly.

Nothing is integrated, so no error accumulates: :meth:`Leg.pose_at` may be called for any instants in any order.
"""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import List, Optional, Tuple

from ..common.units import NS_PER_S, seconds_to_ns
from ..engine.instants import first_ns
from .geometry import Pose2D, normalize_angle

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
    """Return (highest speed [m/s], time to speed up [s], time of the whole trip [s]) of a :class:`SpeedProfile`.

    If only these numbers are needed, no SpeedProfile has to be made.
    """
    if math.isinf(acceleration):
        return max_speed, 0.0, distance / max_speed if distance > 0.0 and max_speed > 0.0 else 0.0
    product = acceleration * distance
    # The product of two tiny numbers is 0. Then the speed would be 0, and the robot would arrive at once.
    peak = min(max_speed, math.sqrt(product) if product else math.sqrt(acceleration) * math.sqrt(distance))
    ramp = peak / acceleration
    return peak, ramp, 0.0 if distance <= 0.0 or peak <= 0.0 else distance / peak + ramp


@dataclass(frozen=True, init=False)
class SpeedProfile:
    """Travel over ``distance`` [m] from rest to rest: accelerate, cruise, decelerate.

    The motion is uniformly accelerated, with the acceleration a and the top speed v. A trip shorter than v^2/a never
    reaches v: it takes 2*sqrt(distance/a) seconds and peaks at sqrt(a*distance) after half of them. A longer trip takes
    distance/v + v/a seconds.
    """

    distance: float
    max_speed: float
    acceleration: float
    #: the highest speed that is reached [m/s]
    peak_speed: float = field(repr=False, compare=False)
    #: the time that speeding up takes, and that slowing down takes [s]
    ramp_seconds: float = field(repr=False, compare=False)
    #: the time that the trip takes [s]
    seconds: float = field(repr=False, compare=False)

    def __init__(self, distance: float, max_speed: float, acceleration: float = math.inf) -> None:
        peak, ramp, seconds = trip(distance, max_speed, acceleration)
        self.__dict__.update(distance=distance, max_speed=max_speed, acceleration=acceleration, peak_speed=peak,
                             ramp_seconds=ramp, seconds=seconds)  # by __dict__, since the class is frozen

    def covered(self, elapsed: float) -> float:
        """Return the distance [m] covered ``elapsed`` [s] after the start, clamped to the trip."""
        total = self.seconds
        if elapsed >= total:
            return self.distance
        if elapsed <= 0.0:
            return 0.0
        ramp, peak = self.ramp_seconds, self.peak_speed
        if elapsed < ramp:
            return 0.5 * self.acceleration * elapsed * elapsed
        if elapsed > total - ramp:
            left = total - elapsed
            return self.distance - 0.5 * self.acceleration * left * left
        return peak * (elapsed - 0.5 * ramp)

    def elapsed(self, covered: float) -> float:
        """Return the time [s after the start] at which ``covered`` [m] are covered: the inverse of :meth:`covered`.

        The result is clamped to the trip.
        """
        if covered <= 0.0 or self.seconds == 0.0:
            return 0.0
        left = self.distance - covered
        if left <= 0.0:
            return self.seconds
        ramp_length = 0.5 * self.peak_speed * self.ramp_seconds
        if covered < ramp_length:
            return math.sqrt(2.0 * covered / self.acceleration)
        if left < ramp_length:
            return self.seconds - math.sqrt(2.0 * left / self.acceleration)
        return covered / self.peak_speed + 0.5 * self.ramp_seconds

    def changes(self, pieces: int) -> List[float]:
        """Return instants [s after the start] that divide each time of changing speed into ``pieces`` equal parts."""
        ramp = [self.ramp_seconds * number / pieces for number in range(1, pieces + 1)]
        return [*ramp, *(self.seconds - seconds for seconds in ramp)]

    def smooth(self) -> List[Tuple[float, float]]:
        """Return the spans of constant acceleration, in order: [(end, acceleration), ...].

        ``end`` is in s after the start; the acceleration is its size [m/s^2], so it is not negative while braking.
        """
        if self.ramp_seconds == 0.0:
            return [(self.seconds, 0.0)]
        return [(self.ramp_seconds, self.acceleration), (self.seconds - self.ramp_seconds, 0.0),
                (self.seconds, self.acceleration)]

    def speed(self, elapsed: float) -> float:
        """Return the speed [m/s] at ``elapsed`` [s] after the start; 0 outside the trip."""
        total = self.seconds
        if elapsed < 0.0 or elapsed >= total:
            return 0.0
        if elapsed < self.ramp_seconds:
            return self.acceleration * elapsed
        if elapsed > total - self.ramp_seconds:
            return self.acceleration * (total - elapsed)
        return self.peak_speed


class Leg:
    """One trip: turn towards the goal, drive straight, turn to the goal's heading. Immutable.

    The robot stops as soon as it is within the tolerances. ``depart_ns`` and ``arrive_ns`` are simulated time [ns];
    each of the three phases lasts a whole number of nanoseconds.
    """

    __slots__ = ('depart_ns', 'arrive_ns', 'start', 'end', 'distance',
                 '_limits', '_kept_profile', '_course', '_first_turn', '_last_turn', '_drive_ns', '_last_turn_ns')

    #: none, since a leg is straight; see :class:`.route.Route`
    corners: Tuple[Tuple[float, float], ...] = ()
    #: how the leg differs from its law, as in :class:`.pace.PacedLeg`: not at all
    manner: Tuple[float, ...] = ()

    def __init__(self, start: Pose2D, goal: Pose2D, limits: MotionLimits, tolerances: Tolerances = Tolerances(),
                 depart_ns: int = 0) -> None:
        dx, dy = goal.x - start.x, goal.y - start.y
        gap = math.hypot(dx, dy)
        self.distance = distance = gap if tolerances.xy == 0.0 < gap else left_to_drive(gap, tolerances.xy)
        self._course = math.atan2(dy, dx) if distance > 0.0 else start.yaw
        self.start = start
        self._limits = limits
        self._kept_profile: Optional[SpeedProfile] = None
        self.depart_ns = depart_ns
        if distance > 0.0 and limits.acceleration == _INF:  # as :func:`trip` says, without a call
            seconds = distance / limits.max_speed
        else:
            seconds = trip(distance, limits.max_speed, limits.acceleration)[2]
        if limits.turn_rate == _INF and tolerances.yaw == 0.0:  # most legs: their turns take no time
            self.end = goal if 0.0 < distance == gap < _INF else self._end_pose(goal, gap, goal.yaw)
            self._drive_ns = depart_ns
            self._last_turn_ns = self.arrive_ns = depart_ns + seconds_to_ns(seconds)
            return
        self._first_turn = normalize_angle(self._course - start.yaw)
        self._last_turn = turn_within(normalize_angle(goal.yaw - self._course), tolerances.yaw)
        self.end = self._end_pose(goal, gap, goal.yaw if tolerances.yaw == 0.0 else self._course + self._last_turn)
        self._drive_ns = depart_ns + seconds_to_ns(abs(self._first_turn) / limits.turn_rate)
        self._last_turn_ns = self._drive_ns + seconds_to_ns(seconds)
        self.arrive_ns = self._last_turn_ns + seconds_to_ns(abs(self._last_turn) / limits.turn_rate)

    def _end_pose(self, goal: Pose2D, gap: float, yaw: float) -> Pose2D:
        start = self.start
        if self.distance <= 0.0:
            return Pose2D(start.x, start.y, yaw)
        share = self.distance / gap
        if share == 1.0:
            return goal if yaw is goal.yaw else Pose2D(goal.x, goal.y, yaw)
        return Pose2D(start.x + share * (goal.x - start.x), start.y + share * (goal.y - start.y), yaw)

    @property
    def _profile(self) -> SpeedProfile:
        """The speed profile of the drive. It is made at the first question about an instant between the ends."""
        if self._kept_profile is None:
            limits = self._limits
            self._kept_profile = SpeedProfile(self.distance, limits.max_speed, limits.acceleration)
        return self._kept_profile

    @property
    def duration_ns(self) -> int:
        """The simulated time that the trip takes [ns]."""
        return self.arrive_ns - self.depart_ns

    @property
    def way(self) -> Tuple[Tuple[float, float], Tuple[float, float]]:
        """The points ((x, y), ...) [m] of the leg: its start and its end, between which it is straight."""
        return (self.start.x, self.start.y), (self.end.x, self.end.y)

    @property
    def course(self) -> float:
        """The direction of the drive [rad]."""
        return self._course

    @staticmethod
    def corners_ahead(_now_ns: int) -> Tuple[Tuple[float, float], ...]:
        """Return the corners that are still to come: none."""
        return ()

    def even_instants_ns(self, ramp_pieces: int) -> List[int]:
        """Return the same as :meth:`.route.Route.even_instants_ns`."""
        changes = (self._drive_ns + seconds_to_ns(elapsed) for elapsed in self._profile.changes(ramp_pieces))
        return sorted({self.depart_ns, self._drive_ns, *changes, self._last_turn_ns, self.arrive_ns})

    def smooth_ns(self) -> List[Tuple[int, float]]:
        """Return the same as :meth:`.route.Route.smooth_ns`."""
        drive = [(self._drive_ns + seconds_to_ns(end), most) for end, most in self._profile.smooth()]
        return [(self._drive_ns, 0.0), *drive, (self._last_turn_ns, 0.0), (self.arrive_ns, 0.0)]

    def distance_at(self, now_ns: int) -> float:
        """Return the distance [m] driven since the departure, at ``now_ns`` [ns]."""
        if now_ns >= self._last_turn_ns:
            return self.distance
        return self._profile.covered((now_ns - self._drive_ns) / NS_PER_S) if now_ns > self._drive_ns else 0.0

    def guess_ns(self, distance: float) -> int:
        """Return the instant [ns] at which ``distance`` [m] are driven; rounding may shift it by a few ns."""
        return self._drive_ns + int(self._profile.elapsed(distance) * NS_PER_S)

    def covers_ns(self, distance: float) -> int:
        """Return the first instant [ns] at which ``distance`` [m] are driven, or the arrival; it is exact."""
        return first_ns(self.depart_ns, self.arrive_ns, lambda at_ns: self.distance_at(at_ns) >= distance,
                        self.guess_ns(distance))

    def pose_at(self, now_ns: int) -> Pose2D:
        """Return the pose at ``now_ns`` [ns]: the start before the departure, the end from the arrival on."""
        if now_ns < self.depart_ns:
            return self.start
        if now_ns >= self.arrive_ns:
            return self.end
        if now_ns < self._drive_ns:
            turned = math.copysign(self._limits.turn_rate * (now_ns - self.depart_ns) / NS_PER_S, self._first_turn)
            return Pose2D(self.start.x, self.start.y, self.start.yaw + turned)
        if now_ns < self._last_turn_ns:
            covered = self.distance_at(now_ns)
            return Pose2D(self.start.x + covered * math.cos(self._course),
                          self.start.y + covered * math.sin(self._course), self._course)
        turned = math.copysign(self._limits.turn_rate * (now_ns - self._last_turn_ns) / NS_PER_S, self._last_turn)
        return Pose2D(self.end.x, self.end.y, self._course + turned)

    def velocity_at(self, now_ns: int) -> Tuple[float, float]:
        """Return (forward [m/s], turning [rad/s]) in base_link at ``now_ns`` [ns]."""
        if now_ns < self.depart_ns or now_ns >= self.arrive_ns:
            return 0.0, 0.0
        if now_ns < self._drive_ns:
            return 0.0, math.copysign(self._limits.turn_rate, self._first_turn)
        if now_ns < self._last_turn_ns:
            return self._profile.speed((now_ns - self._drive_ns) / NS_PER_S), 0.0
        return 0.0, math.copysign(self._limits.turn_rate, self._last_turn)


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
