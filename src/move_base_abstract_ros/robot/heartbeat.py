"""A heartbeat: it publishes for all robots of a process at once, at one rate."""
from __future__ import annotations

from typing import TYPE_CHECKING, Callable, List, Tuple

from move_base_abstract.engine.series import NOBODY

if TYPE_CHECKING:
    from .host import Host

#: heartbeats come after the robots' own events of the same instant
SHARED_INDEX = 2 ** 31 - 1


class Heartbeat:
    """Calls all its members ``frequency`` times a simulated second, at most ``rate_cap`` times a wall second."""

    def __init__(self, host: Host, frequency: float, rate_cap: float) -> None:
        self._clock = host.clock
        self._batch = host.timing.batch
        # what to call, who hears it, and since when it is there [ns]: beats that were slept through are made up for
        self._members: List[Tuple[Callable[[int], object], Callable[[], int], int]] = []
        self._throttle = host.throttle(rate_cap)
        with self._clock.lock:
            series = self._clock.simulation.series(SHARED_INDEX, frequency, self._beat, is_output=True,
                                                   is_heard=host.timing.when_heard(self._is_heard))
            if series is not None:
                series.start(self._clock.now_ns())
        self._clock.follow_restarts(self._restart)

    def add(self, member: Callable[[int], object], is_heard: Callable[[], int]) -> None:
        """Call ``member(now_ns)`` at each beat from now on.

        ``is_heard()`` returns which nodes hear what it publishes: NOBODY, ONLOOKERS or PARTICIPANTS.
        """
        with self._clock.lock:
            self._members.append((member, is_heard, self._clock.simulation.now_ns))

    def remove(self, member: Callable[[int], object]) -> None:
        """Do not call ``member`` any more."""
        with self._clock.lock:
            self._members = [one for one in self._members if one[0] != member]

    def _restart(self, _before_ns: int, now_ns: int) -> None:
        self._members = [(*one[:2], now_ns) for one in self._members]

    def _is_heard(self) -> int:
        return max((is_heard() for _, is_heard, _ in self._members), default=NOBODY)

    def _beat(self, _due_ns: int, now_ns: int) -> int:
        if self._throttle.ready():
            with self._batch():
                for member, _, since_ns in self._members:
                    if since_ns <= now_ns:
                        member(now_ns)
        return self._clock.wall_to_ns(self._throttle.remaining())
