"""Ways around a map's obstacles: the shortest way over its cells, then straight pieces at any angle."""
from __future__ import annotations

import math
from collections import OrderedDict
from itertools import islice
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional, Sequence, Tuple

from .cost_field import CostField
from .kept import Kept, corners_of
from .occupancy import OccupancyMap
from .planning import StraightLinePlanner, WorldBounds
from .planning_grid import PARTS, PlanningGrid, blocked_cells
from .shortening import Shortener
from .tightening import tightened

if TYPE_CHECKING:
    from typing import OrderedDict as Ordered

    from ..motion.geometry import Pose2D
    from .map_check import MapCheck

_FIELDS_BYTES = 64 * 1024 * 1024  # the memory for all fields of one map; the least recently used one is dropped first
_WAVES_BYTES = 32 * 1024 * 1024  # the memory for waves that can go on; other waves have to start again
_WAVE_BYTES = 6  # the memory per cell for a wave that can go on
_SPANS = 4  # a robot further off the map than so many times its width and height comes from there, too
_DIGITS = 6  # the decimals of corners [m]: micrometres hide the rounding of a rotated map's angle
_LEAST_RESOLUTION = 0.001  # m; with smaller cells, a micrometre is not much less than 1/256 of a cell

#: a point in parts of a cell, see PlanningGrid
Cell = Tuple[int, int]
Corners = Tuple[Tuple[float, float], ...]


class MapWays:
    """The ways on one map for robots of ``radius`` [m]. Ways are cached; no way depends on earlier questions."""

    def __init__(self, occupancy: OccupancyMap, radius: float, unknown_is_free: bool = True,
                 leaves: bool = False) -> None:
        # A copy of the map: data that is kept for a map must not keep the map itself alive.
        self._map = OccupancyMap(occupancy.cells, occupancy.resolution, occupancy.origin)
        cells = radius / self._map.resolution
        self.grid = PlanningGrid(blocked_cells(occupancy.cells, cells, unknown_is_free))
        self._span = _SPANS * (self.grid.rows + self.grid.columns) if leaves else 0
        self._reach = 2 * self._span or int(cells) + 1
        self._digits = _DIGITS if self._map.resolution >= _LEAST_RESOLUTION else 2 * _DIGITS
        self._waves = max(2, _WAVES_BYTES // (_WAVE_BYTES * len(self.grid.free)))
        self._fields: Ordered[int, CostField] = OrderedDict()  # {cell of a goal: CostField}
        self._shorteners: Dict[int, Shortener] = {}  # {cell of a goal: Shortener for the latest point in it}
        self._ways: Callable[..., Optional[Corners]] = Kept(self._find, corners_of)

    @classmethod
    def on(cls, occupancy: OccupancyMap, radius: float, unknown_is_free: bool = True, leaves: bool = False) -> MapWays:
        """Return the ways on the OccupancyMap ``occupancy``; all robots with one ``radius`` [m] share them."""
        return occupancy.kept((cls, radius, unknown_is_free, leaves),
                              lambda: cls(occupancy, radius, unknown_is_free, leaves))

    def is_free(self, pose: Pose2D) -> bool:
        """Return whether the centre of a robot may be at ``pose`` (map frame)."""
        place = self._place(pose)
        return place is not None and self.grid.is_free(self.grid.cell_of(place))

    def corners(self, start: Pose2D, goal: Pose2D) -> Optional[Corners]:
        """Return the corners ((x, y), ...) [m] of the way from ``start`` to ``goal`` (Pose2D, map frame), or None.

        If the robot stands where its centre must not be, but is no further from a free cell than its radius plus a
        cell, it first goes straight to the nearest free cell. If it ``leaves`` obstacles, it does so from anywhere, and
        from off the map.
        """
        return self._ways(self._place(start) or self._off(start), self._place(goal))

    def leads(self, start: Pose2D, goal: Pose2D) -> bool:
        """Return whether there is a way from ``start`` to ``goal``. This is fast for one start and many goals."""
        begin, end = self._start(self._place(start) or self._off(start)), self._place(goal)
        if begin is None or end is None:
            return False
        cell = self.grid.cell_of(end)
        return self.grid.is_free(cell) and self._field(self.grid.cell_of(begin)).leads_from(cell)

    def is_clear(self, points: Sequence[Tuple[float, float]]) -> bool:
        """Return whether the straight pieces between ``points`` [(x, y), m] touch only cells where a centre may be."""
        places: List[Any] = [self.grid.place(*self._map.to_cells(x, y)) for x, y in points]
        return None not in places and all(self.grid.sees(one, other, 0) for one, other in zip(places, places[1:]))

    def _find(self, start: Optional[Cell], goal: Optional[Cell]) -> Optional[Corners]:
        grid = self.grid
        free = self._start(start)
        if free is None or goal is None or not grid.is_free(grid.cell_of(goal)):
            return None
        corners = [] if free == start else [free]
        if not grid.sees(free, goal):
            shortener = self._shortener(goal)
            if not shortener.field.leads_from(grid.cell_of(free)):
                return None
            corners += tightened(grid, [free, *shortener.corners_from(free), goal])[1:-1]
        points = (self._map.from_cells(column / PARTS, row / PARTS) for column, row in corners)
        return tuple((round(x, self._digits), round(y, self._digits)) for x, y in points)

    def _place(self, pose: Pose2D) -> Optional[Cell]:
        return self.grid.place(*self._map.to_cells(pose.x, pose.y))

    def _off(self, pose: Pose2D) -> Optional[Cell]:
        """Return the point (off the grid) of a robot that is not on the map, None: it does not come onto the map."""
        cells = (min(max(cell, -self._span), self._span) for cell in self._map.to_cells(pose.x, pose.y))
        column, row = (math.floor(cell * PARTS) for cell in cells)
        return (column, row) if self._span else None

    def _start(self, place: Optional[Cell]) -> Optional[Cell]:
        """Return the point of the free cells at which a way from ``place`` begins, or None."""
        if place is None or self.grid.contains(place) and self.grid.is_free(self.grid.cell_of(place)):
            return place
        cell = self.grid.nearest_free(place, self._reach)
        return None if cell is None else self.grid.centre_of(cell)

    def _shortener(self, goal: Cell) -> Shortener:
        field = self._field(self.grid.cell_of(goal))
        shortener = self._shorteners.get(field.goal)
        if shortener is None or shortener.goal != goal:
            shortener = self._shorteners[field.goal] = Shortener(self.grid, field, goal)
        return shortener

    def _field(self, cell: int) -> CostField:
        if cell in self._fields:
            self._fields.move_to_end(cell)
        else:
            self._fields[cell] = CostField(self.grid, cell)
            if len(self._fields) > max(1, _FIELDS_BYTES // len(self.grid.free)):
                self._shorteners.pop(self._fields.popitem(last=False)[0], None)
        for field in islice(reversed(self._fields.values()), self._waves, self._waves + 1):
            field.rest()
        return self._fields[cell]


class GridPlanner(StraightLinePlanner):
    """Plans ways around the obstacles on the map of ``map_check``, for a robot with the inscribed ``radius`` [m].

    ``inflation`` [m]: costmap_2d marks cells within the radius only up to this distance, in whole cells. ``tolerance``
    [m]: see StraightLinePlanner. ``leaves``: whether a robot leaves obstacles and comes onto the map from any distance.
    Places outside ``bounds`` cannot be reached, but a way may lead through them. All planners of a process share their
    results, so only one of them may be used at a time.
    """

    goes_straight = False

    def __init__(self, map_check: MapCheck, radius: float, bounds: WorldBounds = WorldBounds(),
                 inflation: float = math.inf, tolerance: float = 0.0, leaves: bool = False) -> None:
        super().__init__(bounds, map_check)
        self._radius, self._inflation, self._leaves = radius, inflation, leaves
        self.tolerance = tolerance

    def refusal(self, goal: Pose2D) -> Optional[str]:
        """Return a text that says why the map does not allow ``goal``, or None."""
        refusal = super().refusal(goal)
        if refusal is None and not self._ways().is_free(goal):
            return ('The goal ({:g}, {:g}) lies nearer to an occupied cell of the map than the inscribed radius of the '
                    'robot, {:g} m.'.format(goal.x, goal.y, self._clearance()))
        return refusal

    def refusal_of_way(self, start: Pose2D, goal: Pose2D) -> Optional[str]:
        """Return a text that says why there is no way from ``start`` to ``goal``; call it only if there is none."""
        return super().refusal_of_way(start, goal) or (
            'No way leads from ({:g}, {:g}) to the goal ({:g}, {:g}) on the map for a robot of {:g} m.'.format(
                start.x, start.y, goal.x, goal.y, self._clearance()))

    def corners(self, start: Pose2D, goal: Pose2D) -> Optional[Corners]:
        """Return the corners ((x, y), ...) [m] of the way, () for a straight one, or None if there is no way."""
        return self._ways().corners(start, goal) if self.reachable(goal) else None

    def is_clear(self, points: Sequence[Tuple[float, float]]) -> bool:
        """Return whether a robot may go straight from point to point, [(x, y), m]; without a map it may."""
        return self.lacking is not None or self._ways().is_clear(points)

    def _leads(self, start: Pose2D, goal: Pose2D) -> bool:
        return self.reachable(goal) and self._ways().leads(start, goal)

    def _ways(self) -> MapWays:
        check: Any = self._map_check  # this planner always has one
        return MapWays.on(check.occupancy, self._clearance(), check.allow_unknown, self._leaves)

    def _clearance(self) -> float:
        """Return the distance [m] that ways keep from obstacles."""
        if self._inflation >= self._radius:
            return self._radius
        side: float = self.occupancy.resolution
        return min(self._radius, math.ceil(self._inflation / side) * side)
