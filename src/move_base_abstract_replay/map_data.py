"""A map for the page: its cells, not more of them than a screen can show, and where they are."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, List, Tuple, Union

import numpy as np

from move_base_abstract.maps.map_files import load_map, read_description
from move_base_abstract.motion.geometry import Pose2D

from .packed import Packer

if TYPE_CHECKING:
    from pathlib import Path

    from move_base_abstract.maps.occupancy import OccupancyMap

_MOST_CELLS = 2048  # along a side
_UNKNOWN = 255  # on the page; other cells are 0 to 100 as in a nav_msgs/OccupancyGrid


def packed_map(path: Union[str, Path]) -> Tuple[str, Tuple[float, float, float, float], List[Any]]:
    """Return (the text for data.js, the box (x_min, y_min, x_max, y_max) [m], warnings) for the map of a YAML file.

    :raises ConfigurationError: if it cannot be read; the text names the file.
    """
    description = read_description(os.fspath(path))
    grid = load_map(description)
    step = -(-max(grid.width, grid.height) // _MOST_CELLS)
    cells = _coarser(grid.cells, step)
    packer = Packer()
    packer.add('cells', 'u1', np.where(cells < 0, _UNKNOWN, cells).astype(np.uint8).tobytes())
    text = packer.text({'columns': cells.shape[1], 'rows': cells.shape[0], 'resolution': grid.resolution * step,
                        'width': grid.size[0], 'height': grid.size[1],
                        'origin': [grid.origin.x, grid.origin.y, grid.origin.yaw]})
    return text, _box(grid), list(description.warnings)


def _box(grid: OccupancyMap) -> Tuple[float, float, float, float]:
    """Return (x_min, y_min, x_max, y_max) [m, map frame] around an OccupancyMap."""
    corners = [grid.origin.compose(Pose2D(x, y)) for x in (0.0, grid.size[0]) for y in (0.0, grid.size[1])]
    xs, ys = [corner.x for corner in corners], [corner.y for corner in corners]
    return min(xs), min(ys), max(xs), max(ys)


def _coarser(cells: np.ndarray, step: int) -> np.ndarray:
    """Return the cells with each ``step`` by ``step`` of them joined: the most occupied one counts."""
    if step == 1:
        return cells
    rows, columns = (-(-side // step) * step for side in cells.shape)
    whole = np.full((rows, columns), -1, np.int8)
    whole[:cells.shape[0], :cells.shape[1]] = cells
    return whole.reshape(rows // step, step, columns // step, step).max(axis=(1, 3))
