"""Measures the wall time of phases. The mission gets a stopwatch, and never reads a clock itself."""
from __future__ import annotations

import contextlib
import time
from typing import Any, Callable, Dict, Iterator


class Stopwatch:
    """Adds up the wall seconds of each phase in ``seconds``; a phase inside another counts in both."""

    def __init__(self, now: Callable[..., Any] = time.perf_counter) -> None:
        self._now = now
        self.seconds: Dict[Any, Any] = {}

    @contextlib.contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Add the time until the end of the with block to the phase ``name``."""
        began = self._now()
        try:
            yield
        finally:
            self.seconds[name] = self.seconds.get(name, 0.0) + self._now() - began
