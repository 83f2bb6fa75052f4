"""Wall time per phase. The mission is handed a stopwatch and never looks at a clock itself."""

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
        """Count the time until the end of the with block as phase name."""
        began = self._now()
        try:
            yield
        finally:
            self.seconds[name] = self.seconds.get(name, 0.0) + self._now() - began
