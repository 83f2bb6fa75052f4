"""Whether another simulator follows: compares what it reports, poses and stamps, with where and when robots are."""
from __future__ import annotations

from collections import deque
from typing import Any, Deque, Optional, Protocol, Tuple

from ..common.units import NS_PER_S

_SPEED_SECONDS = 0.5  # s, wall: the time over which the speed of simulated time is measured


class Placed(Protocol):
    """A position, for example a Pose2D."""

    def distance_to(self, other: Any) -> float:
        """Return the distance [m] to another position."""
        ...


class _Lapse:
    """Whether something has been wrong for ``patience`` [s, wall], told once until it is right again."""

    def __init__(self, patience: float) -> None:
        self._patience = patience
        self._told = False
        self.since: Optional[float] = None  # s, wall; None: it is right

    def is_new(self, is_right: bool, wall: float) -> bool:
        """Take in at ``wall`` [s] whether it is right; return whether to tell now that it is wrong."""
        if is_right:
            self.since, self._told = None, False
            return False
        if self.since is None:
            self.since = wall
        if self._told or wall - self.since < self._patience:
            return False
        self._told = True
        return True


class FollowCheck:
    """Compares the poses at which a robot was placed with those that are reported, within ``tolerance`` [m].

    A report may lag behind: it is right if it fits any pose of the last ``patience`` [s, wall]. Only reports that are
    wrong for that long count as a lapse. Wall times are arguments [s, of one clock that never goes back].
    """

    _REMEMBERED = 256

    def __init__(self, tolerance: float = 0.05, patience: float = 2.0) -> None:
        self._tolerance = tolerance
        self._patience = patience
        self._placed: Deque[Tuple[float, Placed]] = deque(maxlen=self._REMEMBERED)
        self._lapse = _Lapse(patience)

    def placed(self, pose: Placed, wall: float) -> None:
        """Note that the robot was placed at ``pose`` at ``wall`` [s]."""
        self._placed.append((wall, pose))

    def reported(self, pose: Placed, wall: float) -> Optional[float]:
        """Take in a report; return the distance [m] to where the robot should be, once per lapse, otherwise None."""
        if not self._placed:
            return None
        while len(self._placed) > 1 and self._placed[1][0] < wall - self._patience:
            self._placed.popleft()
        is_right = any(pose.distance_to(placed) <= self._tolerance for _, placed in reversed(self._placed))
        return pose.distance_to(self._placed[-1][1]) if self._lapse.is_new(is_right, wall) else None


class StampCheck:
    """Compares stamps with the present, within ``tolerance`` [s] of simulated or wall time, whichever is longer.

    Messages are late by some wall time. The faster simulated time runs, the more simulated time that is. Only stamps
    that are wrong for ``patience`` [s, wall] count as a lapse. Wall times are arguments [s, of one clock that never
    goes back].
    """

    def __init__(self, tolerance: float = 1.0, patience: float = 2.0) -> None:
        self._tolerance = tolerance
        self._lapse = _Lapse(patience)
        self._speed = 1.0
        self._mark: Optional[Tuple[int, int, float]] = None

    @property
    def is_alike(self) -> bool:
        """Whether the latest stamp was within the tolerance."""
        return self._lapse.since is None

    def reported(self, stamp_ns: int, now_ns: int, wall: float) -> Optional[float]:
        """Take in a stamp; return how far it is in the past [s], once per lapse, otherwise None."""
        self._measure_speed(stamp_ns, now_ns, wall)
        gap = (now_ns - stamp_ns) / NS_PER_S
        return gap if self._lapse.is_new(abs(gap) <= self._tolerance * self._speed, wall) else None

    def _measure_speed(self, stamp_ns: int, now_ns: int, wall: float) -> None:
        """Measure the speed of the faster of the two clocks, relative to wall time; it is at least 1."""
        if self._mark is None:
            self._mark = (stamp_ns, now_ns, wall)
        mark_stamp_ns, mark_now_ns, mark_wall = self._mark
        if wall - mark_wall >= _SPEED_SECONDS:
            fastest = max(stamp_ns - mark_stamp_ns, now_ns - mark_now_ns) / NS_PER_S / (wall - mark_wall)
            self._speed = max(1.0, fastest)
            self._mark = (stamp_ns, now_ns, wall)
