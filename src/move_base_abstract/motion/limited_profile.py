"""Travel from rest to rest over pieces that have different top speeds, in closed form."""
from __future__ import annotations

import math
from typing import Iterable, List, Sequence, Tuple

from .leg import speed_profile
from .phases import Phase, Profile

Limited = Tuple[float, float]  # the length [m, > 0] of a piece, and its top speed [m/s]


def profile_over(pieces: Iterable[Limited], acceleration: float) -> Profile:
    """Return the profile of a drive over ``pieces`` ((length [m], top speed [m/s]), ...) with ``acceleration`` [m/s^2].

    The robot drives as fast as they allow. It brakes in time before a slower piece and speeds up again behind it. Its
    speed at each border between pieces is the highest that it can reach by then, and from which it can still keep all
    later limits and stop at the end (one pass forwards, one backwards). Between the speeds u and w at the ends of a
    piece of the length l, the highest speed is the root of (u^2 + w^2) / 2 + a l, or the limit if that is lower.
    """
    groups: List[Limited] = []
    for length, limit in pieces:
        if groups and groups[-1][1] == limit:
            groups[-1] = groups[-1][0] + length, limit
        else:
            groups.append((length, limit))
    if len(groups) == 1:
        return speed_profile(*groups[0], acceleration)
    phases: List[Phase] = []
    now, covered = 0.0, 0.0
    speeds = _border_speeds(groups, acceleration)
    for (length, limit), entry, leave in zip(groups, speeds, speeds[1:]):
        for share, speed, rate, seconds in _phases_of(length, limit, entry, leave, acceleration):
            phases.append(Phase(now, covered + share, speed, rate))
            now += seconds
        covered += length
    return Profile(covered, now, tuple(phases))


def _border_speeds(pieces: Sequence[Limited], acceleration: float) -> List[float]:
    """Return the speeds [m/s] at the start, between the pieces and at the end."""
    limits = [limit for _, limit in pieces]
    speeds = [0.0, *map(min, limits, limits[1:]), 0.0]
    gains = [2.0 * acceleration * length for length, _ in pieces]
    last = len(gains)
    for one in range(last):
        speeds[one + 1] = min(speeds[one + 1], math.sqrt(speeds[one] * speeds[one] + gains[one]))
    for one in range(last, 0, -1):
        speeds[one - 1] = min(speeds[one - 1], math.sqrt(speeds[one] * speeds[one] + gains[one - 1]))
    return speeds


def _phases_of(length: float, limit: float, entry: float, leave: float,
               rate: float) -> List[Tuple[float, float, float, float]]:
    """Return (begin [m], speed there, acceleration, duration [s]) for each of speeding up, cruising, braking."""
    if math.isinf(rate):
        return [(0.0, limit, 0.0, length / limit)]
    peak = max(entry, leave, min(limit, math.sqrt(0.5 * (entry * entry + leave * leave) + rate * length)))
    up, down = (peak * peak - entry * entry) / (2.0 * rate), (peak * peak - leave * leave) / (2.0 * rate)
    even = max(0.0, length - up - down)
    phases = [(0.0, entry, rate, (peak - entry) / rate), (up, peak, 0.0, even / peak),
              (up + even, peak, -rate, (peak - leave) / rate)]
    return [phase for phase in phases if phase[3] > 0.0]
