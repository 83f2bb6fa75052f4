"""Travel from rest to rest over pieces that have different top speeds, in closed form."""
from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass, field
from typing import Iterable, List, NamedTuple, Tuple, Union

from .leg import SpeedProfile


class _Phase(NamedTuple):
    """A span of constant acceleration: when [s] and where [m] it begins, the speed there [m/s], the acceleration."""

    begin: float
    covered: float
    speed: float
    acceleration: float


@dataclass(frozen=True)
class LimitedProfile:
    """Travel as fast as the ``pieces`` ((length [m, > 0], top speed [m/s]), ...) and ``acceleration`` [m/s^2] allow.

    The robot brakes in time before a slower piece and speeds up again behind it. Its speed at each border between
    pieces is the highest that it can reach by then, and from which it can still keep all later limits and stop at the
    end (one pass forwards, one backwards). Between the speeds u and w at the ends of a piece of the length l, the
    highest speed is the root of (u^2 + w^2) / 2 + a l, or the limit if that is lower.
    """

    pieces: Tuple[Tuple[float, float], ...]
    acceleration: float = math.inf
    #: the time that the trip takes [s]
    seconds: float = field(init=False, repr=False, compare=False)
    #: the length of the trip [m]
    distance: float = field(init=False, repr=False, compare=False)
    _phases: List[_Phase] = field(init=False, repr=False, compare=False)
    _begins: List[float] = field(init=False, repr=False, compare=False)
    _covereds: List[float] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        phases: List[_Phase] = []
        now, covered = 0.0, 0.0
        speeds = self._border_speeds()
        for (length, limit), entry, leave in zip(self.pieces, speeds, speeds[1:]):
            for share, speed, acceleration, seconds in self._phases_of(length, limit, entry, leave):
                phases.append(_Phase(now, covered + share, speed, acceleration))
                now += seconds
            covered += length
        begins, covereds = [phase.begin for phase in phases], [phase.covered for phase in phases]
        self.__dict__.update(seconds=now, distance=covered, _phases=phases, _begins=begins, _covereds=covereds)

    def _border_speeds(self) -> List[float]:
        """Return the speeds [m/s] at the start, between the pieces and at the end."""
        limits = [limit for _, limit in self.pieces]
        speeds = [0.0, *map(min, limits, limits[1:]), 0.0]
        gains = [2.0 * self.acceleration * length for length, _ in self.pieces]
        last = len(gains)
        for one in range(last):
            speeds[one + 1] = min(speeds[one + 1], math.sqrt(speeds[one] * speeds[one] + gains[one]))
        for one in range(last, 0, -1):
            speeds[one - 1] = min(speeds[one - 1], math.sqrt(speeds[one] * speeds[one] + gains[one - 1]))
        return speeds

    def _phases_of(self, length: float, limit: float, entry: float,
                   leave: float) -> List[Tuple[float, float, float, float]]:
        """Return (begin [m], speed there, acceleration, duration [s]) for each of speeding up, cruising, braking."""
        rate = self.acceleration
        if math.isinf(rate):
            return [(0.0, limit, 0.0, length / limit)]
        peak = max(entry, leave, min(limit, math.sqrt(0.5 * (entry * entry + leave * leave) + rate * length)))
        up, down = (peak * peak - entry * entry) / (2.0 * rate), (peak * peak - leave * leave) / (2.0 * rate)
        even = max(0.0, length - up - down)
        phases = [(0.0, entry, rate, (peak - entry) / rate), (up, peak, 0.0, even / peak),
                  (up + even, peak, -rate, (peak - leave) / rate)]
        return [phase for phase in phases if phase[3] > 0.0]

    def covered(self, elapsed: float) -> float:
        """Return the distance [m] covered ``elapsed`` [s] after the start, clamped to the trip."""
        if elapsed >= self.seconds:
            return self.distance
        if elapsed <= 0.0:
            return 0.0
        index = bisect_right(self._begins, elapsed) - 1
        phase, since = self._phases[index], elapsed - self._begins[index]
        most = self._covereds[index + 1] if index + 1 < len(self._covereds) else self.distance
        return min(most, phase.covered + since * (phase.speed + 0.5 * phase.acceleration * since))

    def elapsed(self, covered: float) -> float:
        """Return the time [s after the start] at which ``covered`` [m] are covered: the inverse of :meth:`covered`.

        The result is clamped to the trip.
        """
        if covered <= 0.0:
            return 0.0
        if covered >= self.distance:
            return self.seconds
        phase = self._phases[bisect_right(self._covereds, covered) - 1]
        rest = covered - phase.covered
        root = math.sqrt(max(0.0, phase.speed * phase.speed + 2.0 * phase.acceleration * rest))
        return phase.begin + (2.0 * rest / (phase.speed + root) if rest > 0.0 else 0.0)

    def changes(self, pieces: int) -> List[float]:
        """Return instants [s after the start] that divide each time of changing speed into ``pieces`` equal parts."""
        ends = [*self._begins[1:], self.seconds]
        return [instant for phase, end in zip(self._phases, ends) for instant in (
            (phase.begin + (end - phase.begin) * number / pieces for number in range(pieces + 1))
            if phase.acceleration else (phase.begin, end))]

    def smooth(self) -> List[Tuple[float, float]]:
        """Return the same as :meth:`.leg.SpeedProfile.smooth`."""
        return [(end, abs(phase.acceleration)) for phase, end in zip(self._phases, [*self._begins[1:], self.seconds])]

    def speed(self, elapsed: float) -> float:
        """Return the speed [m/s] at ``elapsed`` [s] after the start; 0 outside the trip."""
        if elapsed < 0.0 or elapsed >= self.seconds:
            return 0.0
        index = bisect_right(self._begins, elapsed) - 1
        phase = self._phases[index]
        return phase.speed + phase.acceleration * (elapsed - phase.begin)


def profile_over(pieces: Iterable[Tuple[float, float]], acceleration: float) -> Union[SpeedProfile, LimitedProfile]:
    """Return the profile of a drive over ``pieces`` ((length [m], top speed [m/s]), ...).

    If all pieces have the same top speed, that is a SpeedProfile, otherwise a LimitedProfile.
    """
    groups: List[Tuple[float, float]] = []
    for length, limit in pieces:
        if groups and groups[-1][1] == limit:
            groups[-1] = groups[-1][0] + length, limit
        else:
            groups.append((length, limit))
    if len(groups) == 1:
        return SpeedProfile(*groups[0], acceleration)
    return LimitedProfile(tuple(groups), acceleration)
