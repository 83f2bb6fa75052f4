"""A cap, in wall time, on how often something is published."""
import time


class WallThrottle:
    """Says yes at most ``rate`` times a second of the wall clock [Hz]."""

    def __init__(self, rate):
        self._period = 1.0 / rate
        self._last = -self._period

    def ready(self):
        """Return whether enough time has passed since the last yes."""
        wall = time.monotonic()
        if wall - self._last < self._period:
            return False
        self._last = wall
        return True

    def reset(self):
        """Let the next question be answered with yes."""
        self._last = -self._period
