"""Whether another simulator uses the same clock: compares its stamps with the present."""
from __future__ import annotations

from typing import Optional, Tuple

from ..common.units import NS_PER_S

_SPEED_SECONDS = 0.5  # s, wall: the time over which the speed of simulated time is measured


class StampCheck:
    """Compares stamps with the present, within ``tolerance`` [s] of simulated or wall time, whichever is longer.

    Messages are late by some wall time. The faster simulated time runs, the more simulated time that is. Only stamps
    that are wrong for ``patience`` [s, wall] count as a lapse. Wall times are arguments [s, of one clock that never
    goes back].
    """

    def __init__(self, tolerance: float = 1.0, patience: float = 2.0) -> None:
        self._tolerance = tolerance
        self._patience = patience
        self._off_since: Optional[float] = None
        self._told = False
        self._speed = 1.0
        self._mark: Optional[Tuple[int, int, float]] = None

    @property
    def is_alike(self) -> bool:
        """Whether the latest stamp was within the tolerance."""
        return self._off_since is None

    def reported(self, stamp_ns: int, now_ns: int, wall: float) -> Optional[float]:
        """Take in a stamp; return how far it is in the past [s], once per lapse, otherwise None."""
        self._measure_speed(stamp_ns, now_ns, wall)
        gap = (now_ns - stamp_ns) / NS_PER_S
        if abs(gap) <= self._tolerance * self._speed:
            self._off_since, self._told = None, False
            return None
        if self._off_since is None:
            self._off_since = wall
        if self._told or wall - self._off_since < self._patience:
            return None
        self._told = True
        return gap

    def _measure_speed(self, stamp_ns: int, now_ns: int, wall: float) -> None:
        """Measure the speed of the faster of the two clocks, relative to wall time; it is at least 1."""
        if self._mark is None:
            self._mark = (stamp_ns, now_ns, wall)
        mark_stamp_ns, mark_now_ns, mark_wall = self._mark
        if wall - mark_wall >= _SPEED_SECONDS:
            fastest = max(stamp_ns - mark_stamp_ns, now_ns - mark_now_ns) / NS_PER_S / (wall - mark_wall)
            self._speed = max(1.0, fastest)
            self._mark = (stamp_ns, now_ns, wall)
