"""How far a robot has driven, from what is heard of it: poses, which may be late, and the ends of its goals."""

import math

from .commands import Place

DETOUR_M = 1e-3  # a way is told apart from the straight line if it is longer by this


class Odometer:
    """Where one robot is, and its way between the places that the mission was told of.

    Poses and ends of goals come over different connections: a pose from before the end of a goal may come after it.
    What is older than what is known already is left out, so that no way is counted twice.
    """

    def __init__(self):
        self.position = None  # (x, y) [m, map frame], None before the first pose
        self.stamp_ns = None  # of the position
        self._told = None  # (x, y) that take_place returned last
        self._way_m = 0.0  # since then

    def pose(self, stamp_ns, x, y):
        """Take note that the robot was at (x, y) [m] at stamp_ns; a pose from before the last one is left out."""
        if self.position is None:
            self.position = (x, y)
        elif stamp_ns < self.stamp_ns:
            return
        self._way_m += math.dist(self.position, (x, y))
        self.position, self.stamp_ns = (x, y), stamp_ns

    def reached(self, stamp_ns, x, y):
        """Take note that a goal at (x, y) was reached at stamp_ns; a pose from then or later says more and stays."""
        if self.stamp_ns < stamp_ns:
            self.pose(stamp_ns, x, y)

    def take_place(self):
        """Return the Place where the robot is, with its way since the last call.

        Of a way that is the straight line but for rounding, only the places are told.
        """
        straight = math.dist(self._told, self.position) if self._told is not None else 0.0
        driven = self._way_m if self._way_m > straight + DETOUR_M else None
        self._told, self._way_m = self.position, 0.0
        return Place(*self.position, driven)
