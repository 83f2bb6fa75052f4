"""The distance from a point, or from a way, to the nearest occupied cell."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Sequence, Tuple

import numpy as np

from ..common.map_images import OCCUPIED
from .occupancy import OccupancyMap

if TYPE_CHECKING:
    from numpy.typing import NDArray

_HALF_DIAGONAL = 0.7071068  # of a cell, rounded up [cells]
_FLOAT32 = 1e-6  # the largest error of the field's numbers, relative

def clearance_at(occupancy: OccupancyMap, x: float, y: float, limit: float) -> float:
    """Return the distance [m] from (x, y) [m, map frame] to the nearest occupied cell, at most ``limit`` [m].

    It is the distance to the nearest point of that cell. Unknown cells, and places off the map, are not occupied.
    """
    resolution = occupancy.resolution
    column, row = occupancy.to_cells(x, y)
    reach = limit / resolution
    left, low = max(0, math.floor(column - reach)), max(0, math.floor(row - reach))
    cells = occupancy.cells[low:max(low, math.floor(row + reach) + 1), left:max(left, math.floor(column + reach) + 1)]
    rows, columns = np.nonzero(cells >= OCCUPIED)
    if not len(rows):
        return limit
    dx, dy = (np.maximum(0.0, np.abs(found + begin + 0.5 - place) - 0.5) for found, begin, place in (
        (columns, left, column), (rows, low, row)))
    return min(limit, math.sqrt(float((dx * dx + dy * dy).min())) * resolution)


class ClearanceField:
    """For each cell of a map, the distance [m] from its middle to the nearest point of an occupied cell.

    The distances go up to ``limit`` [m]. Unknown cells, and places off the map, are not occupied.
    """

    def __init__(self, occupancy: OccupancyMap, limit: float) -> None:
        # A copy of the map, as in MapWays: data that is kept for a map must not keep the map itself alive.
        self._map = OccupancyMap(occupancy.cells, occupancy.resolution, occupancy.origin)
        self._limit = limit
        reach = math.ceil(limit / occupancy.resolution) + 1  # cells
        # First along rows, then across: the square of a distance is a sum.
        along = _least(np.where(occupancy.cells >= OCCUPIED, np.float32(0.0), np.float32(np.inf)).T, reach).T
        self._field = np.minimum(np.sqrt(_least(along, reach)) * np.float32(occupancy.resolution), np.float32(limit))

    @classmethod
    def on(cls, occupancy: OccupancyMap, limit: float) -> ClearanceField:
        """Return the field of a map up to ``limit`` [m]; all robots share it."""
        return occupancy.kept((cls, limit), lambda: cls(occupancy, limit))

    def least_at(self, column: float, row: float) -> float:
        """Return a distance [m] within which of (``column``, ``row``) [cells] there is surely no occupied cell.

        It is below 0 in one.
        """
        height, width, side = self._map.height, self._map.width, self._map.resolution
        value = self._field[min(max(int(row), 0), height - 1), min(max(int(column), 0), width - 1)]
        off = max(0.0, -column, column - width), max(0.0, -row, row - height)  # cells off the map
        return max(float(value) * (1.0 - _FLOAT32), math.hypot(*off) * side) - _HALF_DIAGONAL * side

    def least_along(self, way: Sequence[Tuple[float, float]], skipped: float = 0.0) -> Tuple[float, float]:
        """Return (the least clearance [m] of the cells below ``way`` ((x, y), ...) [m], where that is along it [m]).

        Of equal ones the first counts. The way is looked at every half cell, after the first ``skipped`` [m].
        """
        best, before = (self._limit, 0.0), 0.0
        for begin, end in zip(way, way[1:]):
            length = math.dist(begin, end)
            (column, row), (to_column, to_row) = self._map.to_cells(*begin), self._map.to_cells(*end)
            shares = self._shares((column, row), (to_column, to_row))
            shares = shares[before + shares * length >= skipped]
            if len(shares):
                rows = np.clip((row + shares * (to_row - row)).astype(int), 0, self._map.height - 1)
                columns = np.clip((column + shares * (to_column - column)).astype(int), 0, self._map.width - 1)
                values = self._field[rows, columns]
                least = int(values.argmin())
                if float(values[least]) < best[0]:
                    best = float(values[least]), before + float(shares[least]) * length
            before += length
        return best

    def _shares(self, begin: Tuple[float, float], end: Tuple[float, float]) -> NDArray[Any]:
        """Return the shares, 0..1, from ``begin`` to ``end`` [cells] at which to look: on the map, every half cell."""
        low, high = 0.0, 1.0
        for one, other, size in zip(begin, end, (self._map.width, self._map.height)):
            if one != other:
                first, last = sorted(((0.0 - one) / (other - one), (size - one) / (other - one)))
                low, high = max(low, first), min(high, last)
            elif not 0.0 <= one < size:
                return np.empty(0)
        if low > high:
            return np.empty(0)
        return np.linspace(low, high, max(2, math.ceil(2.0 * (high - low) * math.dist(begin, end)) + 1))


def _least(squares: NDArray[Any], reach: int) -> NDArray[Any]:
    """Return the least sum of one of ``squares`` and its squared distance, over rows up to ``reach`` [cells] away."""
    found = squares.copy()
    for step in range(1, min(reach, len(squares) - 1) + 1):
        square = np.float32((step - 0.5) ** 2)
        np.minimum(found[step:], squares[:-step] + square, out=found[step:])
        np.minimum(found[:-step], squares[step:] + square, out=found[:-step])
    return found
