"""A robot that slows down as it comes near the end of its way or of a turn, in closed form."""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, List, Tuple

from .geometry import normalize_angle

if TYPE_CHECKING:
    from .leg import MotionLimits


@dataclass(frozen=True)
class ApproachProfile:
    """Travel over ``distance`` [m] from rest: accelerate, cruise, then brake in proportion to the distance left.

    While the robot brakes, its speed is ``gain`` [1/s] x (the distance left + ``offset`` [m, > 0]). So the distance
    left shrinks exponentially, and the robot reaches the end at the speed ``gain`` x ``offset``. A planner that must
    be able to stop within a fixed time behaves like this (DWA: gain = 1/``sim_time``). With the acceleration a, the
    speed u at which braking begins follows from u^2/2a + u/gain - offset = distance; braking takes
    ln(u / (gain offset)) / gain. For a turn, read rad instead of m.
    """

    distance: float
    max_speed: float
    acceleration: float
    gain: float
    offset: float
    #: the highest speed that is reached [m/s]
    peak_speed: float = field(init=False, repr=False, compare=False)
    #: the time that speeding up takes [s]
    ramp_seconds: float = field(init=False, repr=False, compare=False)
    #: the time at which braking begins [s after the start]
    brake_begin: float = field(init=False, repr=False, compare=False)
    #: the time that the trip takes [s]
    seconds: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        distance, gain, offset = self.distance, self.gain, self.offset
        peak = min(self.max_speed, self._unlimited_peak())
        if not peak > 0.0 or distance <= 0.0:
            self.__dict__.update(peak_speed=0.0, ramp_seconds=0.0, brake_begin=0.0, seconds=0.0)
            return
        brakes = peak > gain * offset
        if not brakes:
            peak = min(self.max_speed, math.sqrt(2.0 * self.acceleration * distance))
        ramp = 0.0 if math.isinf(self.acceleration) else peak / self.acceleration
        cruise = max(0.0, distance - 0.5 * peak * ramp - (peak / gain - offset if brakes else 0.0))
        begin = ramp + cruise / peak
        seconds = begin + (math.log(peak / (gain * offset)) / gain if brakes else 0.0)
        self.__dict__.update(peak_speed=peak, ramp_seconds=ramp, brake_begin=begin, seconds=seconds)

    def _unlimited_peak(self) -> float:
        slowness, whole = 1.0 / self.gain, self.distance + self.offset
        if math.isinf(self.acceleration):
            return whole * self.gain
        # The root of the quadratic equation, written so that nothing cancels.
        return 2.0 * whole / (slowness + math.sqrt(slowness * slowness + 2.0 * whole / self.acceleration))

    def covered(self, elapsed: float) -> float:
        """Return the distance [m] covered ``elapsed`` [s] after the start, clamped to the trip."""
        if elapsed >= self.seconds:
            return self.distance
        if elapsed <= 0.0:
            return 0.0
        if elapsed < self.ramp_seconds:
            return 0.5 * self.acceleration * elapsed * elapsed
        if elapsed <= self.brake_begin:
            return self.peak_speed * (elapsed - 0.5 * self.ramp_seconds)
        left = self.speed(elapsed) / self.gain - self.offset
        return min(self.distance, max(0.0, self.distance - left))

    def smooth(self) -> List[Tuple[float, float]]:
        """Return the same as :meth:`.leg.SpeedProfile.smooth`; for braking, the largest acceleration that occurs."""
        ramp = [(self.ramp_seconds, self.acceleration)] if self.ramp_seconds else []
        return [*ramp, (self.brake_begin, 0.0), (self.seconds, self.gain * self.peak_speed)]

    def speed(self, elapsed: float) -> float:
        """Return the speed [m/s] at ``elapsed`` [s] after the start; 0 outside the trip."""
        if elapsed < 0.0 or elapsed >= self.seconds:
            return 0.0
        if elapsed < self.ramp_seconds:
            return self.acceleration * elapsed
        return self.peak_speed * math.exp(-self.gain * max(0.0, elapsed - self.brake_begin))

    def elapsed(self, covered: float) -> float:
        """Return the time [s after the start] at which ``covered`` [m] are covered: the inverse of :meth:`covered`.

        The result is clamped to the trip.
        """
        if covered <= 0.0 or self.seconds == 0.0:
            return 0.0
        if covered >= self.distance:
            return self.seconds
        if covered < 0.5 * self.peak_speed * self.ramp_seconds:
            return math.sqrt(2.0 * covered / self.acceleration)
        even = covered / self.peak_speed + 0.5 * self.ramp_seconds
        if even <= self.brake_begin:
            return even
        braked = self.gain * (self.distance - covered + self.offset)
        # Never before brake_begin: on a trip without braking, rounding may put ``covered`` just beyond the end.
        return self.brake_begin + max(0.0, math.log(self.peak_speed / braked)) / self.gain

    def changes(self, pieces: int) -> List[float]:
        """Return instants [s after the start] that divide each time of changing speed into ``pieces`` equal parts."""
        shares = [number / pieces for number in range(1, pieces + 1)]
        return [*(share * self.ramp_seconds for share in shares),
                *(self.brake_begin + share * (self.seconds - self.brake_begin) for share in (0.0, *shares))]


@dataclass(frozen=True)
class MotionPhases:
    """How a robot begins and ends its legs, in addition to its limits.

    A turn by t [rad] at the start takes a t + b t^2 seconds at an even rate, with ``start_turn`` = (a, b) [s/rad,
    s/rad^2]. The drive brakes with ``braking_gain`` [1/s] and ``braking_offset`` [m]. The last turn begins with at most
    ``turning_speed`` [rad/s] and brakes with ``turning_gain`` [1/s] and ``turning_offset`` [rad]. Both brake as an
    :class:`ApproachProfile` does.

    A real robot turns while it drives, so on a short way it arrives in a bow: the share B^2 / (B^2 + length^2) of the
    first turn is still in its heading, where B is ``bow_length`` [m]. The duration of the last turn is computed from
    that heading.
    """

    start_turn: Tuple[float, float]
    braking_gain: float
    braking_offset: float
    turning_speed: float
    turning_gain: float
    turning_offset: float
    bow_length: float = 0.0

    def start_turn_seconds(self, turn: float) -> float:
        """Return the time [s] that a turn by ``turn`` [rad] at the start takes."""
        linear, square = self.start_turn
        return abs(turn) * (linear + square * abs(turn))

    def drive(self, distance: float, limits: MotionLimits) -> ApproachProfile:
        """Return the profile of a drive over ``distance`` [m] with the MotionLimits ``limits``."""
        return ApproachProfile(distance, limits.max_speed, limits.acceleration, self.braking_gain, self.braking_offset)

    def end_turn(self, turn: float, start_turn: float, length: float, tolerance: float) -> ApproachProfile:
        """Return the profile of the last turn, by ``turn`` [rad] to within ``tolerance`` [rad].

        ``start_turn`` [rad] and ``length`` [m] are the first turn and the length of the drive before it.
        """
        square = self.bow_length * self.bow_length
        share = square / (square + length * length) if square else 0.0
        whole = abs(normalize_angle(turn - share * start_turn))
        return ApproachProfile(max(0.0, whole - tolerance), self.turning_speed, math.inf, self.turning_gain,
                               self.turning_offset)
