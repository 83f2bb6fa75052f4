"""A robot that slows down the nearer it comes to the end of its way, or of a turn, in closed form."""
import math
from dataclasses import dataclass, field

from .geometry import normalize_angle


@dataclass(frozen=True)
class ApproachProfile:
    """Travel over ``distance`` [m] from rest: accelerate, cruise, brake so that the speed is in proportion to the rest.

    While it brakes the speed is ``gain`` [1/s] x (what is left + ``offset`` [m, > 0]), so that what is left shrinks
    exponentially and the end is reached at the speed ``gain`` x ``offset``. So does a planner that wants to be able to
    stand within a fixed time (DWA: 1/``sim_time``). With the acceleration a the speed u at which braking begins
    follows from u^2/2a + u/gain - offset = distance; braking takes ln(u / (gain offset)) / gain.
    For a turn read rad for m.
    """

    distance: float
    max_speed: float
    acceleration: float
    gain: float
    offset: float
    #: the highest speed that is reached [m/s]
    peak_speed: float = field(init=False, repr=False, compare=False)
    #: how long speeding up takes [s]
    ramp_seconds: float = field(init=False, repr=False, compare=False)
    #: when braking begins [s after the start]
    brake_begin: float = field(init=False, repr=False, compare=False)
    #: how long the trip takes [s]
    seconds: float = field(init=False, repr=False, compare=False)

    def __post_init__(self):
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

    def _unlimited_peak(self):
        slowness, whole = 1.0 / self.gain, self.distance + self.offset
        if math.isinf(self.acceleration):
            return whole * self.gain
        # The root of the quadratic equation, written so that nothing cancels.
        return 2.0 * whole / (slowness + math.sqrt(slowness * slowness + 2.0 * whole / self.acceleration))

    def covered(self, elapsed):
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

    def smooth(self):
        """As of :meth:`.leg.SpeedProfile.smooth`; while it brakes it is the most that the acceleration comes to."""
        ramp = [(self.ramp_seconds, self.acceleration)] if self.ramp_seconds else []
        return [*ramp, (self.brake_begin, 0.0), (self.seconds, self.gain * self.peak_speed)]

    def speed(self, elapsed):
        """Return the speed [m/s] at ``elapsed`` [s] after the start; 0 outside the trip."""
        if elapsed < 0.0 or elapsed >= self.seconds:
            return 0.0
        if elapsed < self.ramp_seconds:
            return self.acceleration * elapsed
        return self.peak_speed * math.exp(-self.gain * max(0.0, elapsed - self.brake_begin))

    def elapsed(self, covered):
        """Return when [s after the start] ``covered`` [m] are covered, clamped to the trip: the reverse of covered."""
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
        # Never sooner: of a trip that does not brake the last digit of what is covered may lie behind its end.
        return self.brake_begin + max(0.0, math.log(self.peak_speed / braked)) / self.gain

    def changes(self, pieces):
        """Return instants [s after the start] that part the times of changing speed into ``pieces`` equal ones each."""
        shares = [number / pieces for number in range(1, pieces + 1)]
        return [*(share * self.ramp_seconds for share in shares),
                *(self.brake_begin + share * (self.seconds - self.brake_begin) for share in (0.0, *shares))]


@dataclass(frozen=True)
class MotionPhases:
    """How a robot begins and ends its legs, beside its limits.

    A turn by t [rad] at the start takes ``start_turn`` (a, b): a t + b t^2 [s/rad, s/rad^2], evenly; the drive brakes
    with ``braking_gain`` [1/s] and ``braking_offset`` [m], the last turn with ``turning_gain`` [1/s] and
    ``turning_offset`` [rad] from at most ``turning_speed`` [rad/s], as of :class:`ApproachProfile`.

    A real robot turns while it drives, so that on a short way it arrives in a bow: of the first turn the share
    B^2 / (B^2 + length^2) is still in its heading, B being ``bow_length`` [m]. The last turn takes as long as from
    there.
    """

    start_turn: tuple
    braking_gain: float
    braking_offset: float
    turning_speed: float
    turning_gain: float
    turning_offset: float
    bow_length: float = 0.0

    def start_turn_seconds(self, turn):
        """Return how long a turn by ``turn`` [rad] at the start takes [s]."""
        linear, square = self.start_turn
        return abs(turn) * (linear + square * abs(turn))

    def drive(self, distance, limits):
        """Return the profile of a drive over ``distance`` [m] with the MotionLimits ``limits``."""
        return ApproachProfile(distance, limits.max_speed, limits.acceleration, self.braking_gain, self.braking_offset)

    def end_turn(self, turn, start_turn, length, tolerance):
        """Return the profile of a turn by ``turn`` [rad] after ``length`` [m], to within ``tolerance`` [rad]."""
        square = self.bow_length * self.bow_length
        share = square / (square + length * length) if square else 0.0
        whole = abs(normalize_angle(turn - share * start_turn))
        return ApproachProfile(max(0.0, whole - tolerance), self.turning_speed, math.inf, self.turning_gain,
                               self.turning_offset)
