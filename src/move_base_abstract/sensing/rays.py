"""Where rays end: in the cells of a map, exactly, for all rays of a scan at once; and at straight pieces.

A ray begins at a point and goes in a direction (dx, dy) of length 1. In a map it goes from cell to cell as in
Amanatides and Woo: A fast voxel traversal algorithm for ray tracing (Eurographics 1987). But the crossings of many rays
with the lines between columns are handled in one step, and then those with the lines between rows.
"""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple, Sequence, Tuple

import numpy as np

from ..common.map_images import OCCUPIED, UNKNOWN
from ..engine.chance import Chance, Purpose
from ..maps.occupancy import OccupancyMap

if TYPE_CHECKING:
    from numpy.typing import NDArray

_CROSSINGS = 64  # the number of crossings of each ray that are handled in one step
_UNIFORMS = 12  # the sum of so many uniform numbers has the variance 1


class Body(NamedTuple):
    """Something with an outline: its ``corners`` [(x, y), m], none farther than ``radius`` [m] from (x, y) [m]."""

    x: float
    y: float
    radius: float
    corners: Sequence[Tuple[float, float]]


def of_map(occupancy: OccupancyMap, x: float, y: float, dx: NDArray[Any], dy: NDArray[Any],
           most: float) -> NDArray[Any]:
    """Return the distance [m] on each ray from (x, y) [m, map frame] to the first occupied cell, inf: beyond ``most``.

    ``dx``, ``dy``: the directions of the rays; ``most`` [m]. Unknown cells stop no ray, and outside the map nothing
    does. Rays that begin in an occupied cell end at once.
    """
    column, row = occupancy.to_cells(x, y)
    cos, sin = occupancy.axes
    is_inside = 0.0 <= column < occupancy.width and 0.0 <= row < occupancy.height
    by_columns, by_rows = occupancy.kept(of_map, lambda: _blocked(occupancy.cells))
    if is_inside and by_columns[int(row) + 1, int(column) + 1]:
        return np.zeros(len(dx))
    across, along = cos * dx + sin * dy, cos * dy - sin * dx
    limit = np.full(len(dx), most / occupancy.resolution)
    if is_inside:
        limit = np.minimum(limit, _to_the_edge(column, across, occupancy.width))
        limit = np.minimum(limit, _to_the_edge(row, along, occupancy.height))
    found = _entered(by_columns, column, row, across, along, limit, is_inside)
    limit = np.minimum(limit, found)
    found = np.minimum(found, _entered(by_rows, row, column, along, across, limit, is_inside))
    found *= occupancy.resolution
    found[found > most] = math.inf
    return found


def _blocked(cells: NDArray[Any]) -> Tuple[NDArray[Any], NDArray[Any]]:
    """Return (the occupied cells within a free border, the same transposed)."""
    blocked = np.pad((cells >= OCCUPIED) | (cells < UNKNOWN), 1)
    return blocked, np.ascontiguousarray(blocked.T)


def _to_the_edge(place: float, speed: NDArray[Any], size: int) -> NDArray[Any]:
    """Return the distance [cells] on each ray until ``place``, which grows by ``speed``, leaves [0, size]."""
    with np.errstate(divide='ignore', over='ignore', invalid='ignore'):
        return np.where(speed == 0.0, math.inf, np.where(speed > 0.0, size - place, place) / np.abs(speed))


def _entered(blocked: NDArray[Any], column: float, row: float, across: NDArray[Any], along: NDArray[Any],
             limit: NDArray[Any], is_inside: bool) -> NDArray[Any]:
    """Return the distance [cells] to the first blocked cell that each ray enters across a line between columns, or inf.

    ``across`` is the growth of the column along a ray, ``along`` that of the row; cells beyond ``limit`` [cells] need
    not be found. ``is_inside``: whether no ray leaves the map within its limit.
    """
    found = np.full(len(across), math.inf)
    rows, columns = blocked.shape
    east = across > 0.0
    # The line of column n is its western edge: there a ray to the east enters n, a ray to the west n - 1.
    first = np.where(east, max(math.floor(column) + 1, 0), min(math.floor(column), columns - 2))
    gap = np.abs(first - column)  # columns to the first line
    step = np.where(east, 1, -1)
    with np.errstate(divide='ignore', over='ignore', invalid='ignore'):
        slowness = 1.0 / np.abs(across)
        climb = slowness * along  # rows from line to line
        count = np.minimum(np.where(east, columns - 2 - first, first), np.abs(across) * limit - gap + 2.0)
    rays = np.flatnonzero((count > 0.0) & np.isfinite(climb))
    begin = 0
    while len(rays):
        lines = np.arange(begin, begin + _CROSSINGS)
        entered = climb[rays, None] * lines
        entered += (row + 1.0 + gap[rays] * climb[rays])[:, None]
        if not is_inside:
            np.clip(entered, 0.0, rows - 1.0, out=entered)
        index = entered.astype(np.intp)
        index *= columns
        index += (first[rays] + east[rays])[:, None] + step[rays, None] * lines
        hits = blocked.ravel().take(index, mode='clip')  # beyond the last line the values do not matter
        place = hits.argmax(axis=1)
        is_hit = hits[np.arange(len(rays)), place]
        place += begin
        is_hit &= place < count[rays]
        found[rays[is_hit]] = (gap[rays] + place)[is_hit] * slowness[rays[is_hit]]
        begin += _CROSSINGS
        rays = rays[~is_hit & (count[rays] > begin)]
    return found


def shorten(found: NDArray[Any], x: float, y: float, dx: NDArray[Any], dy: NDArray[Any], body: Body) -> None:
    """Shorten the distances ``found`` [m] on rays from (x, y) to where each ray meets the outline of ``body``."""
    ahead = (body.x - x) * dx + (body.y - y) * dy
    aside = np.abs((body.x - x) * dy - (body.y - y) * dx)
    rays = np.flatnonzero((aside <= body.radius) & (ahead >= -body.radius) & (found > ahead - body.radius))
    if not len(rays):
        return
    points = np.array(body.corners) - (x, y)
    sides = np.concatenate((points[1:], points[:1])) - points
    dx, dy = dx[rays, None], dy[rays, None]
    with np.errstate(divide='ignore', invalid='ignore'):
        turn = dx * sides[:, 1] - dy * sides[:, 0]
        far = (points[:, 0] * sides[:, 1] - points[:, 1] * sides[:, 0]) / turn
        share = (points[:, 0] * dy - points[:, 1] * dx) / turn
    # A ray that runs along a side meets the adjacent sides instead.
    far[~((far >= 0.0) & (share >= 0.0) & (share <= 1.0))] = math.inf
    found[rays] = np.minimum(found[rays], far.min(axis=1))


def normals(chance: Chance, count: int, number: int) -> NDArray[Any]:
    """Return the ``number``-th row of ``count`` numbers with mean 0 and variance 1: sums of 12 uniform ones, minus 6.

    In practice they are normally distributed (none is beyond 6), and sums have the same bits on every computer.
    """
    return chance.uniforms(number, Purpose.SCAN, count * _UNIFORMS).reshape(count, _UNIFORMS).sum(axis=1) - 6.0
