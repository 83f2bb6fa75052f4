"""Whether another simulator follows: compares the poses at which robots were placed with reported poses."""
from __future__ import annotations

from collections import deque
from typing import Any, Deque, Optional, Protocol, Tuple


class Placed(Protocol):
    """A position, for example a Pose2D."""

    def distance_to(self, other: Any) -> float:
        """Return the distance [m] to another position."""
        ...


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
        self._off_since: Optional[float] = None
        self._told = False

    def placed(self, pose: Placed, wall: float) -> None:
        """Note that the robot was placed at ``pose`` at ``wall`` [s]."""
        self._placed.append((wall, pose))

    def reported(self, pose: Placed, wall: float) -> Optional[float]:
        """Take in a report; return the distance [m] to where the robot should be, once per lapse, otherwise None."""
        if not self._placed:
            return None
        while len(self._placed) > 1 and self._placed[1][0] < wall - self._patience:
            self._placed.popleft()
        if any(pose.distance_to(placed) <= self._tolerance for _, placed in reversed(self._placed)):
            self._off_since, self._told = None, False
            return None
        if self._off_since is None:
            self._off_since = wall
        if self._told or wall - self._off_since < self._patience:
            return None
        self._told = True
        return pose.distance_to(self._placed[-1][1])
