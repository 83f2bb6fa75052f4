"""Throttles: a cap, in wall time, on how often something is published, or no cap."""
from __future__ import annotations

import time
from typing import Callable

from move_base_abstract.supervision.rate_cap import RateCap


class NoThrottle:
    """Always says yes, for a clock that does not depend on wall time."""

    def ready(self) -> bool:
        """Return True: publish."""
        return True

    def remaining(self) -> float:
        """Return 0 [s, wall]."""
        return 0.0


class WallThrottle:
    """Says yes at most ``rate`` times a second of wall time [Hz], as a RateCap does.

    ``shortest_period()`` [s, wall], if given, is a lower bound of the time between two yeses. It may change.
    """

    def __init__(self, rate: float, shortest_period: Callable[[], float] = lambda: 0.0) -> None:
        self._cap = RateCap(rate)
        self._shortest_period = shortest_period

    def ready(self) -> bool:
        """Return whether enough time has passed since the last yes."""
        return self._cap.ready(time.monotonic(), self._shortest_period())

    def remaining(self) -> float:
        """Return for how long [s, wall] the next answers will be no."""
        return self._cap.remaining(time.monotonic())
