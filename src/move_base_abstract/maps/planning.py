"""Where a robot can go, and the straight way there, through any obstacle. Without a map every place is free.

:mod:`.grid_planner` plans ways around the obstacles on a map.
"""
from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, List, Optional, Sequence, Tuple

from ..motion.geometry import Pose2D
from .map_check import square_rings

if TYPE_CHECKING:
    from .map_check import MapCheck
    from .priced_ways import Prices

_PATH_SPACING = 0.25
_MAX_PATH_STEPS = 10_000
_CELLS_BETWEEN_TRIES = 3
_MAX_TRIES = 1_000_000  # they take some seconds
_MAX_SIDE = 1000


@dataclass(frozen=True)
class WorldBounds:
    """The rectangle [m, global frame] outside which no place can be reached.

    :raises ValueError: if a bound is NaN, or a lower bound is not below its upper one.
    """

    x_min: float = -math.inf
    y_min: float = -math.inf
    x_max: float = math.inf
    y_max: float = math.inf

    def __post_init__(self) -> None:
        if not (self.x_min < self.x_max and self.y_min < self.y_max):
            raise ValueError('bounds must be [x_min, y_min, x_max, y_max] with x_min < x_max and y_min < y_max, '
                             'got {!r}'.format([self.x_min, self.y_min, self.x_max, self.y_max]))

    def contains(self, pose: Pose2D) -> bool:
        """Return whether ``pose`` is in the rectangle or on its edge."""
        return self.x_min <= pose.x <= self.x_max and self.y_min <= pose.y <= self.y_max

    def nearest(self, pose: Pose2D) -> Pose2D:
        """Return the pose in the rectangle that is nearest to ``pose``, with the same heading."""
        return Pose2D(min(max(pose.x, self.x_min), self.x_max), min(max(pose.y, self.y_min), self.y_max), pose.yaw)


class StraightLinePlanner:
    """Plans straight ways to places inside ``bounds``; with a :class:`MapCheck`, only to places that the map allows."""

    #: whether all ways are straight, so that no way depends on what is between its ends
    goes_straight = True
    #: whether its ways take times of their own, whatever the robot's limits
    keeps_times = False
    #: what lanes cost in addition to their time, None: nothing; see :mod:`.priced_ways`
    prices: Optional[Prices] = None
    #: the distance [m] from a goal that cannot be reached within which the robot goes instead
    tolerance = 0.0

    def __init__(self, bounds: WorldBounds = WorldBounds(), map_check: Optional[MapCheck] = None) -> None:
        self._bounds = bounds
        self._map_check = map_check
        self._goes_anywhere = map_check is None and bounds == WorldBounds()

    @property
    def lacking(self) -> Optional[str]:
        """A text that says what is missing before goals can be judged, or None."""
        if self._map_check is None or self._map_check.occupancy is not None:
            return None
        return self._map_check.lacking

    @property
    def occupancy(self) -> Any:
        """The map (OccupancyMap) by which it judges goals, None: there is none, or none yet."""
        return None if self._map_check is None else self._map_check.occupancy

    def clearance_of(self, points: Sequence[Tuple[float, float]]) -> Optional[float]:
        """Return the distance [m] of a way between ``points`` [(x, y), m] from occupied cells, None without a map."""
        if self.occupancy is None:
            return None
        from .way_clearance import way_clearance  # imported here, since it needs numpy
        return way_clearance(self.occupancy, points)

    def refusal(self, goal: Pose2D) -> Optional[str]:
        """Return a text that says why the map does not allow ``goal``, or None."""
        return None if self._map_check is None else self._map_check.refusal(goal)

    def refusal_of_way(self, _start: Pose2D, goal: Pose2D) -> Optional[str]:
        """Return a text that says why there is no way to ``goal``, or None."""
        refusal = self.refusal(goal)
        if refusal is None and not self._bounds.contains(goal):
            return 'The goal ({:g}, {:g}) lies outside of world_bounds, [{:g}, {:g}, {:g}, {:g}].'.format(
                goal.x, goal.y, self._bounds.x_min, self._bounds.y_min, self._bounds.x_max, self._bounds.y_max)
        return refusal

    def reachable(self, goal: Pose2D) -> bool:
        """Return whether ``goal`` can be reached at all."""
        return self._goes_anywhere or (
            self._bounds.contains(goal) and (self._map_check is None or self.refusal(goal) is None))

    def plan(self, start: Pose2D, goal: Pose2D) -> List[Pose2D]:
        """Return the way from ``start`` to ``goal`` as a list of poses about 0.25 m apart, or [] if there is none."""
        corners = self.corners(start, goal)
        return [] if corners is None else path_along(start, corners, goal)

    def corners(self, _start: Pose2D, goal: Pose2D) -> Optional[Tuple[Any, ...]]:
        """Return the corners ((x, y), ...) [m] of the way, which are none here, or None if there is no way."""
        return () if self._goes_anywhere or self.reachable(goal) else None

    def is_clear(self, _points: Sequence[Tuple[float, float]]) -> bool:
        """Return whether a robot may go straight from point to point, [(x, y), m]; here nothing on a map hinders it."""
        return True

    def plan_near(self, start: Pose2D, goal: Pose2D, tolerance: float, add_goal: bool = True) -> List[Pose2D]:
        """Return the way to ``goal``, or to a place within ``tolerance`` [m] of it, or [] if there is none.

        Without a map that place is the nearest one inside the bounds. With a map it is the first one that move_base's
        search finds, on squares around the goal that are three cells apart. With ``add_goal`` the goal is appended even
        if the way does not reach it, as move_base does by default.
        """
        path = self.plan(start, goal)
        if path:
            return path
        near = self._near(start, goal, tolerance)
        if near is None:
            return []
        path = self.plan(start, near)
        return path + [goal] if add_goal else path

    def nearest_to(self, start: Pose2D, goal: Pose2D) -> Optional[Pose2D]:
        """Return the place nearest to ``goal``, within the tolerance in x and in y, to which a way leads, or None.

        The places are those that navfn tries: a cell apart, from south to north, then from west to east.
        """
        occupancy = self.occupancy
        if occupancy is None:
            return None
        count = min(int(2.0 * self.tolerance / occupancy.resolution * (1.0 + 1e-9)), _MAX_SIDE)
        offsets = [number * occupancy.resolution - self.tolerance for number in range(count + 1)]
        for dx, dy in sorted(((dx, dy) for dy in offsets for dx in offsets), key=lambda one: math.hypot(*one)):
            pose = Pose2D(goal.x + dx, goal.y + dy, goal.yaw)
            if self._leads(start, pose):
                return pose
        return None

    def _leads(self, start: Pose2D, goal: Pose2D) -> bool:
        """Return whether there is a way to ``goal``."""
        return self.corners(start, goal) is not None

    def _near(self, start: Pose2D, goal: Pose2D, tolerance: float) -> Optional[Pose2D]:
        """Return a pose within ``tolerance`` [m] of ``goal`` to which a way leads, or None."""
        if self._map_check is None:
            near = self._bounds.nearest(goal)
            return near if near.distance_to(goal) <= tolerance else None
        occupancy = self._map_check.occupancy
        if occupancy is None or not tolerance > 0.0:
            return None
        increment = min(_CELLS_BETWEEN_TRIES * occupancy.resolution, tolerance)
        limit = min(tolerance, occupancy.reach_from(goal.x, goal.y) + increment)
        offsets = itertools.islice(square_rings(increment, limit), _MAX_TRIES)
        tries = (Pose2D(goal.x + dx, goal.y + dy, goal.yaw) for dx, dy in offsets)
        return next((pose for pose in tries if self._leads(start, pose)), None)


def path_along(start: Pose2D, corners: Tuple[Any, ...], goal: Pose2D) -> List[Pose2D]:
    """Return poses from ``start`` along ``corners`` [(x, y), m] to ``goal``; each piece is a :func:`straight_path`.

    The pose at a corner has the heading of the next piece.
    """
    points = [start] + [Pose2D(x, y) for x, y in corners] + [goal]
    most = max(1, _MAX_PATH_STEPS // (len(points) - 1))
    path: List[Pose2D] = []
    for begin, end in zip(points, points[1:]):
        turns = path and begin.distance_to(end) > 0.0
        place = Pose2D(begin.x, begin.y, begin.bearing_to(end)) if turns else begin
        path += straight_path(place, end, most)[:-1]
    return path + [goal]


def straight_path(start: Pose2D, goal: Pose2D, most_steps: int = _MAX_PATH_STEPS) -> List[Pose2D]:
    """Return poses from ``start`` to ``goal`` on a straight line, with the heading along it; the last one is the goal.

    They are at most 0.25 m apart. If that would need more than ``most_steps`` steps, the steps are longer.
    """
    distance = start.distance_to(goal)
    steps = max(1, int(math.ceil(min(distance / _PATH_SPACING, most_steps))))
    course = start.bearing_to(goal) if distance > 0.0 else start.yaw
    dx, dy = (goal.x - start.x) / steps, (goal.y - start.y) / steps
    return [start] + [Pose2D(start.x + k * dx, start.y + k * dy, course) for k in range(1, steps)] + [goal]
