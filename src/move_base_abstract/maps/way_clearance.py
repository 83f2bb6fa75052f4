"""The distance of a way from the occupied cells of a map, by a field of distances that is made once per map."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Sequence, Tuple

import numpy as np

from ..common.map_images import OCCUPIED
from .occupancy import OccupancyMap

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: the largest distance [m]; larger ones count as this
LIMIT = 3.0
_MOST_CELLS = 200  # the limit in cells, on maps with very small cells


def way_clearance(occupancy: OccupancyMap, points: Sequence[Tuple[float, float]]) -> float:
    """Return the least distance [m] of the straight pieces between ``points`` [(x, y), m] from occupied cells.

    It is the distance to the edge of the cell, with the accuracy of a cell, and at most LIMIT. Unknown cells, and
    places off the map, are not occupied.
    """
    reach = min(_MOST_CELLS, int(LIMIT / occupancy.resolution) + 1)
    field = occupancy.kept(way_clearance, lambda: distance_field(occupancy.cells >= OCCUPIED, reach))
    nearest = float(reach)
    for one, other in zip(points, points[1:] or points[:1]):
        begin, end = np.array(occupancy.to_cells(*one)), np.array(occupancy.to_cells(*other))
        count = int(2.0 * float(np.hypot(*(end - begin)))) + 2  # two points per cell
        columns, rows = np.floor(np.linspace(begin, end, count)).astype(int).T
        inside = (columns >= 0) & (columns < occupancy.width) & (rows >= 0) & (rows < occupancy.height)
        if inside.any():
            nearest = min(nearest, math.sqrt(float(field[rows[inside], columns[inside]].min())))
    return min(LIMIT, max(0.0, nearest - 0.5) * occupancy.resolution if nearest < reach else LIMIT)


def distance_field(occupied: NDArray[Any], reach: int) -> NDArray[Any]:
    """Return the squares of the distances [cells] from each cell's centre to the centre of the nearest occupied cell.

    They are exact below ``reach`` [cells], whose square is the highest value. They are found along columns first, then
    across them.
    """
    rows, columns = occupied.shape
    row = np.arange(rows)[:, None]
    south = np.maximum.accumulate(np.where(occupied, row, -2 * reach), axis=0)
    north = np.minimum.accumulate(np.where(occupied, row, rows + 2 * reach)[::-1], axis=0)[::-1]
    squares = np.minimum(np.minimum(row - south, north - row), reach).astype(np.int32) ** 2
    best = squares.copy()
    for offset in range(1, min(reach, columns)):
        np.minimum(best[:, offset:], squares[:, :-offset] + offset * offset, out=best[:, offset:])
        np.minimum(best[:, :-offset], squares[:, offset:] + offset * offset, out=best[:, :-offset])
    return best
