"""A cap on a rate, with some tolerance for events that come slightly early."""
from __future__ import annotations

#: the part of a period by which an event may come early
_EARLY = 0.5


class RateCap:
    """Lets events pass at most ``rate`` times a second [Hz] on average.

    If events come at exactly this rate, some are a little early and others a little late. A cap on the time since the
    last event that passed would reject every early one, about half of them. So an event may come up to half a period
    early, and the next one is counted from the instant at which this one was due. This is the generic cell rate
    algorithm of ITU-T I.371 with a tolerance of half a period: in any time T at most T x rate + 1.5 events pass.
    """

    def __init__(self, rate: float) -> None:
        self._period = 1.0 / rate
        self._belongs = float('-inf')
        self._opens = float('-inf')

    def ready(self, now: float, shortest_period: float = 0.0) -> bool:
        """Return whether an event may pass at ``now`` [s]; the period is at least ``shortest_period`` [s]."""
        if now < self._opens:
            return False
        period = max(self._period, shortest_period)
        self._belongs = max(self._belongs, now) + period
        self._opens = self._belongs - _EARLY * period
        return True

    def remaining(self, now: float) -> float:
        """Return the time [s] after ``now`` for which no event may pass."""
        return max(0.0, self._opens - now)
