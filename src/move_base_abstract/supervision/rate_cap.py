"""A cap on a rate, with some tolerance for events that come slightly early."""
from __future__ import annotations

#: the part of a period by which one may come early
_EARLY = 0.5


class RateCap:
    """Says yes at most ``rate`` times a second [Hz] on the average.

    Ticks of the very rate come now a little early, now a little late; a cap on the time since the last yes would turn
    every early one away, which is half of them. So a yes may come up to half a period early, and the next one is
    counted from where this one belonged. (The generic cell rate algorithm of ITU-T I.371 with half a period of
    tolerance: in any time T there are at most T * rate + 1.5 yeses.)
    """

    def __init__(self, rate: float) -> None:
        self._period = 1.0 / rate
        self._belongs = float('-inf')
        self._opens = float('-inf')

    def ready(self, now: float, shortest_period: float = 0.0) -> bool:
        """Return whether it is time at ``now`` [s]; ``shortest_period`` [s] is the period if it is the longer one."""
        if now < self._opens:
            return False
        period = max(self._period, shortest_period)
        self._belongs = max(self._belongs, now) + period
        self._opens = self._belongs - _EARLY * period
        return True

    def remaining(self, now: float) -> float:
        """Return for how long after ``now`` the answers will be no [s]."""
        return max(0.0, self._opens - now)
