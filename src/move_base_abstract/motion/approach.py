"""A robot that slows down as it comes near the end of its way or of a turn, in closed form."""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Tuple

from .geometry import normalize_angle
from .phases import Phase, Profile

if TYPE_CHECKING:
    from .leg import MotionLimits


def approach_profile(distance: float, max_speed: float, acceleration: float, gain: float, offset: float) -> Profile:
    """Return the profile of travel over ``distance`` [m] from rest that brakes in proportion to the distance left.

    The robot accelerates and cruises. While it brakes, its speed is ``gain`` [1/s] x (the distance left + ``offset``
    [m, > 0]). So the distance left shrinks exponentially, and the robot reaches the end at the speed ``gain`` x
    ``offset``. A planner that must be able to stop within a fixed time behaves like this (DWA: gain = 1/``sim_time``).
    With the acceleration a, the speed u at which braking begins follows from u^2/2a + u/gain - offset = distance;
    braking takes ln(u / (gain offset)) / gain. For a turn, read rad instead of m.
    """
    peak = min(max_speed, _unlimited_peak(distance + offset, acceleration, gain))
    if not peak > 0.0 or distance <= 0.0:
        return Profile(distance, 0.0, ())
    brakes = peak > gain * offset
    if not brakes:
        peak = min(max_speed, math.sqrt(2.0 * acceleration * distance))
    ramp = 0.0 if math.isinf(acceleration) else peak / acceleration
    left = peak / gain - offset if brakes else 0.0
    begin = ramp + max(0.0, distance - 0.5 * peak * ramp - left) / peak
    phases = [Phase(0.0, 0.0, 0.0, acceleration)] if ramp else []
    phases.append(Phase(ramp, 0.5 * peak * ramp, peak))
    if not brakes:
        return Profile(distance, begin, tuple(phases))
    phases.append(Phase(begin, distance - left, peak, 0.0, gain))
    return Profile(distance, begin + math.log(peak / (gain * offset)) / gain, tuple(phases))


def _unlimited_peak(whole: float, acceleration: float, gain: float) -> float:
    slowness = 1.0 / gain
    if math.isinf(acceleration):
        return whole * gain
    # The root of the quadratic equation, written so that nothing cancels.
    return 2.0 * whole / (slowness + math.sqrt(slowness * slowness + 2.0 * whole / acceleration))


@dataclass(frozen=True)
class MotionPhases:
    """How a robot begins and ends its legs, in addition to its limits.

    A turn by t [rad] at the start takes a t + b t^2 seconds at an even rate, with ``start_turn`` = (a, b) [s/rad,
    s/rad^2]. The drive brakes with ``braking_gain`` [1/s] and ``braking_offset`` [m]. The last turn begins with at most
    ``turning_speed`` [rad/s] and brakes with ``turning_gain`` [1/s] and ``turning_offset`` [rad]. Both brake as an
    :func:`approach_profile` says.

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

    def drive(self, distance: float, limits: MotionLimits) -> Profile:
        """Return the profile of a drive over ``distance`` [m] with the MotionLimits ``limits``."""
        return approach_profile(distance, limits.max_speed, limits.acceleration, self.braking_gain, self.braking_offset)

    def end_turn(self, turn: float, start_turn: float, length: float, tolerance: float) -> Profile:
        """Return the profile of the last turn, by ``turn`` [rad] to within ``tolerance`` [rad].

        ``start_turn`` [rad] and ``length`` [m] are the first turn and the length of the drive before it.
        """
        square = self.bow_length * self.bow_length
        share = square / (square + length * length) if square else 0.0
        whole = abs(normalize_angle(turn - share * start_turn))
        return approach_profile(max(0.0, whole - tolerance), self.turning_speed, math.inf, self.turning_gain,
                                self.turning_offset)
