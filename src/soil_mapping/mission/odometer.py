"""The driven distance of a robot, from its poses, which may arrive late, and from the ends of its goals."""
from __future__ import annotations

import math
from typing import Any

from .commands import Place

DETOUR_M = 1e-3  # a way that is longer than the straight line by less than this counts as straight


class Odometer:
    """The place of one robot, and its way between the places that the mission gets.

    Poses and ends of goals come over different connections, so a pose from before the end of a goal may come after it.
    Reports that are older than the latest known one are left out, so that no way counts twice.
    """

    def __init__(self) -> None:
        self.position: Any = None  # (x, y) [m, map frame]; None before the first pose
        self.stamp_ns: Any = None  # of the position
        self._told: Any = None  # (x, y) that take_place returned last
        self._way_m = 0.0  # driven since then

    def pose(self, stamp_ns: Any, x: float, y: float) -> None:
        """Note that the robot was at (x, y) [m] at stamp_ns; a pose that is older than the last one is left out."""
        if self.position is None:
            self.position = (x, y)
        elif stamp_ns < self.stamp_ns:
            return
        self._way_m += math.dist(self.position, (x, y))
        self.position, self.stamp_ns = (x, y), stamp_ns

    def reached(self, stamp_ns: int, x: float, y: float) -> None:
        """Note that a goal at (x, y) [m] was reached at stamp_ns. If a pose from then or later is known, it stays."""
        if self.stamp_ns < stamp_ns:
            self.pose(stamp_ns, x, y)

    def take_place(self) -> Place:
        """Return the Place of the robot, with its way since the last call.

        If the way was straight, except for rounding, driven_m is None.
        """
        straight = math.dist(self._told, self.position) if self._told is not None else 0.0
        driven = self._way_m if self._way_m > straight + DETOUR_M else None
        self._told, self._way_m = self.position, 0.0
        return Place(*self.position, driven)  # type: ignore[call-arg]
