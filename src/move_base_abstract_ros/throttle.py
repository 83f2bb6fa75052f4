"""A cap, in wall time, on how often something is published; or none."""
import time


class NoThrottle:
    """Always says yes, for a clock that does not run by the wall's."""

    def ready(self):
        """Return True."""
        return True

    def remaining(self):
        """Return 0 [s, wall]."""
        return 0.0


class WallThrottle:
    """Says yes at most ``rate`` times a second of the wall clock [Hz].

    ``shortest_period()`` [s], if given, is a lower bound of the time between two yeses that may change.
    """

    def __init__(self, rate, shortest_period=lambda: 0.0):
        self._period = 1.0 / rate
        self._shortest_period = shortest_period
        self._next = 0.0

    def ready(self):
        """Return whether enough time has passed since the last yes."""
        wall = time.monotonic()
        if wall < self._next:
            return False
        self._next = wall + max(self._period, self._shortest_period())
        return True

    def remaining(self):
        """Return how long the next answers will be no [s, wall]."""
        return max(0.0, self._next - time.monotonic())
