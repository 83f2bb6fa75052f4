"""Measures the wall time of phases. The mission gets a stopwatch, and never reads a clock itself."""

import contextlib
import time


class NullStopwatch:
    """Measures nothing."""

    def phase(self, name):
        """Return a context manager that does nothing."""
        return contextlib.nullcontext()


class Stopwatch:
    """Adds up the wall seconds of each phase in ``seconds``; a phase inside another counts in both."""

    def __init__(self, now=time.perf_counter):
        self._now = now
        self.seconds = {}

    @contextlib.contextmanager
    def phase(self, name):
        """Add the time until the end of the with block to the phase ``name``."""
        began = self._now()
        try:
            yield
        finally:
            self.seconds[name] = self.seconds.get(name, 0.0) + self._now() - began
