"""The map: free, occupied and unknown cells. Only values; nothing here reads a file."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Callable, Dict, Hashable, Optional, Tuple, TypeVar

import numpy as np

from ..common.errors import ConfigurationError
from ..common.geometry import Pose2D
from ..common.kinds import error
from ..common.map_images import OCCUPIED, UNKNOWN
from .map_check import Ground

if TYPE_CHECKING:
    from numpy.typing import NDArray

_DIGITS = 12  # the decimals of the sine and cosine of a map's angle
Kept = TypeVar('Kept')


class OccupancyMap:
    """An immutable grid of cells (int8); row 0 is in the south and column 0 in the west, by the map's own axes.

    ``resolution`` is the side of a cell [m]; ``origin`` is the pose of the grid's south-west corner in the map's frame,
    and its yaw turns the grid about that corner. The resolution is rounded to 32 bits, as in nav_msgs/MapMetaData. So a
    point on a cell's border is in the same cell, whether the map comes from a file or from a topic.

    :raises ConfigurationError: if ``cells`` is not a 2-D int8 array or is empty, or if ``resolution`` is not > 0.
    """

    def __init__(self, cells: NDArray[Any], resolution: float, origin: Pose2D = Pose2D()) -> None:
        cells = np.asarray(cells)
        if cells.dtype != np.int8 or cells.ndim != 2 or not cells.size:
            raise ConfigurationError('map: got cells of type {} and shape {}; allowed: a 2-D array of int8 that is '
                                     'not empty'.format(cells.dtype, cells.shape))
        if not (resolution > 0.0 and math.isfinite(resolution)):
            raise error('map: resolution', resolution, 'a finite number > 0 [m/cell]')
        #: the values of the cells, [row from the south, column from the west]; read-only
        self.cells = cells.view()
        self.cells.flags.writeable = False
        with np.errstate(over='ignore', under='ignore'):
            self.resolution = float(np.float32(resolution))
        if not 0.0 < self.resolution < math.inf:
            raise error('map: resolution', resolution, 'a number > 0 that 32 bits hold [m/cell]')
        self.origin = origin
        #: the numbers of rows and of columns
        self.height, self.width = cells.shape
        #: the extent (east-west, north-south) along the map's own axes [m]
        self.size = self.width * self.resolution, self.height * self.resolution
        # A map on a topic has its angle as a quaternion, whose last digits differ from those of the file.
        self._cos, self._sin = round(math.cos(origin.yaw), _DIGITS), round(math.sin(origin.yaw), _DIGITS)
        #: cosine and sine of the angle by which the map's own axes are rotated in its frame
        self.axes = self._cos, self._sin
        self._kept: Dict[Hashable, Any] = {}

    def kept(self, key: Hashable, make: Callable[[], Kept]) -> Kept:
        """Return what ``make()`` returned when ``key`` was first asked for; it is kept as long as this map."""
        if key not in self._kept:
            self._kept[key] = make()
        found: Kept = self._kept[key]
        return found

    def cell_at(self, x: float, y: float) -> Optional[int]:
        """Return the value of the cell at (x, y) [m, map frame], or None off the map.

        The southern and the western edge belong to a cell.
        """
        column, row = self.to_cells(x, y)
        if not (0.0 <= column < self.width and 0.0 <= row < self.height):
            return None
        return int(self.cells[int(row), int(column)])

    def to_cells(self, x: float, y: float) -> Tuple[float, float]:
        """Return (column, row) of (x, y) [m, map frame], in cells from the south-west corner, with fractions."""
        dx, dy = x - self.origin.x, y - self.origin.y
        return ((self._cos * dx + self._sin * dy) / self.resolution,
                (self._cos * dy - self._sin * dx) / self.resolution)

    def from_cells(self, column: float, row: float) -> Tuple[float, float]:
        """Return (x, y) [m, map frame] of a point in cells: the inverse of :meth:`to_cells`."""
        east, north = column * self.resolution, row * self.resolution
        return (self.origin.x + self._cos * east - self._sin * north,
                self.origin.y + self._sin * east + self._cos * north)

    def ground_at(self, x: float, y: float) -> Ground:
        """Return the :class:`Ground` at (x, y) [m, map frame]."""
        value = self.cell_at(x, y)
        if value is None:
            return Ground.OFF_MAP
        if value == UNKNOWN:
            return Ground.UNKNOWN
        return Ground.FREE if 0 <= value < OCCUPIED else Ground.OCCUPIED

    def is_free(self, pose: Pose2D, unknown_is_free: bool = True) -> bool:
        """Return whether the cell at ``pose`` (map frame) is free; no place off the map is."""
        ground = self.ground_at(pose.x, pose.y)
        return ground is Ground.FREE or (unknown_is_free and ground is Ground.UNKNOWN)

    def cut(self, x: float, y: float, columns: int, rows: int, resolution: float) -> NDArray[Any]:
        """Return a grid [row from the south, column from the west] of int8 with its south-west corner at (x, y).

        ``x``, ``y`` [m] and the axes of the grid are those of the map's frame; ``resolution`` [m] is the side of its
        cells. Each cell gets the value of the map at its centre; off the map that is UNKNOWN.
        """
        east = x - self.origin.x + (np.arange(columns) + 0.5) * resolution
        north = (y - self.origin.y + (np.arange(rows) + 0.5) * resolution)[:, np.newaxis]
        column = (self._cos * east + self._sin * north) / self.resolution
        row = (self._cos * north - self._sin * east) / self.resolution
        inside = (column >= 0.0) & (column < self.width) & (row >= 0.0) & (row < self.height)
        values = np.full((rows, columns), UNKNOWN, np.int8)
        values[inside] = self.cells[row[inside].astype(int), column[inside].astype(int)]
        return values

    def reach_from(self, x: float, y: float) -> float:
        """Return the distance [m] from (x, y) [m, map frame] to the corner of the map that is farthest from it."""
        east, north = self.size
        corners = [self.origin.compose(Pose2D(a, b)) for a in (0.0, east) for b in (0.0, north)]
        return max(math.hypot(corner.x - x, corner.y - y) for corner in corners)
