"""A cap, in wall time, on how often something is published; or none."""
import time

from move_base_abstract.supervision.rate_cap import RateCap


class NoThrottle:
    """Always says yes, for a clock that does not run by the wall's."""

    def ready(self):
        """Return True."""
        return True

    def remaining(self):
        """Return 0 [s, wall]."""
        return 0.0


class WallThrottle:
    """Says yes at most ``rate`` times a second of the wall clock [Hz], as a RateCap does.

    ``shortest_period()`` [s], if given, is a lower bound of the time between two yeses that may change.
    """

    def __init__(self, rate, shortest_period=lambda: 0.0):
        self._cap = RateCap(rate)
        self._shortest_period = shortest_period

    def ready(self):
        """Return whether enough time has passed since the last yes."""
        return self._cap.ready(time.monotonic(), self._shortest_period())

    def remaining(self):
        """Return how long the next answers will be no [s, wall]."""
        return self._cap.remaining(time.monotonic())
