"""How far what is occupied is from a place, and from a way."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from .occupancy import OCCUPIED

if TYPE_CHECKING:
    from .occupancy import OccupancyMap


def clearance_at(occupancy: OccupancyMap, x: float, y: float, limit: float) -> float:
    """Return how far (x, y) [m, map frame] is from the nearest occupied cell [m], at most ``limit`` [m].

    To the cell's nearest point. What is unknown, or off the map, is not occupied.
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
