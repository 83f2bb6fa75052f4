"""The cells of a map in which a robot of a given radius may be, and which places see each other. Integers only.

A place is a point (column, row) in 1/256 of a cell, in whole numbers. The cells that a straight line between two places
touches are found without rounding, so no decision depends on the last digit of a float.
"""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Callable, Optional, Sequence, Tuple

import numpy as np

from ..common.map_images import OCCUPIED, UNKNOWN

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: the parts of a cell in which places are counted; the number is even, so that a cell's centre is a place
PARTS = 256
#: the distance [parts] of planned ways from cells that are not free, so that rounding brings no way into such a cell
MARGIN = 1
_OFF = MARGIN + 1  # parts; the least distance of a place from the borders of its cell
_HALF = PARTS // 2
_PARTS_OF_8 = 8 * PARTS
_EIGHTHS = (4, 2, 6, 1, 3, 5, 7)  # the points of a line that are tested first, in eighths

#: the eight steps (columns, rows), in the order in which equally good ones are taken: straight before diagonal
STEPS = ((1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1))


def blocked_cells(cells: NDArray[Any], radius: float, unknown_is_free: bool = True) -> NDArray[Any]:
    """Return in which of ``cells`` (int8, of an OccupancyMap) no robot's centre may be, as an array of bool.

    These are the occupied cells, and all cells whose centre is within ``radius`` [cells] of the centre of an occupied
    one, which costmap_2d calls inscribed; also the unknown cells, if they are not free. The disc is computed in whole
    numbers, with an allowance of a millionth, so that 0.3 m are three cells of 0.1 m in 32 bits, too.
    """
    occupied = (cells >= OCCUPIED) | (cells < UNKNOWN)
    blocked = occupied.copy()
    squared = int(radius * radius * (1.0 + 1e-6))
    rows, columns = occupied.shape
    for offset in range(min(math.isqrt(squared), rows - 1) + 1):
        reach = min(math.isqrt(squared - offset * offset), columns)
        wide = _widened(occupied, reach)
        blocked[offset:] |= wide[:rows - offset]
        blocked[:rows - offset] |= wide[offset:]
    if not unknown_is_free:
        blocked |= cells == UNKNOWN
    return blocked


def _widened(occupied: NDArray[Any], reach: int) -> NDArray[Any]:
    """Return which cells have an occupied cell within ``reach`` cells to the east or west."""
    rows, columns = occupied.shape
    counts = np.zeros((rows, columns + 1), np.int32)
    np.cumsum(occupied, axis=1, out=counts[:, 1:])
    places = np.arange(columns)
    return counts[:, np.minimum(places + reach + 1, columns)] > counts[:, np.maximum(places - reach, 0)]


class PlanningGrid:
    """The free cells of a map, [row from the south, column from the west]. Immutable.

    The number of a cell is ``(row + 1) * stride + column + 1``: around the grid is a border of cells that are not free.
    """

    def __init__(self, blocked: NDArray[Any]) -> None:
        rows, columns = blocked.shape
        self.rows, self.columns = rows, columns
        self.stride: int = columns + 2
        free = np.zeros((rows + 2, columns + 2), bool)
        free[1:-1, 1:-1] = ~blocked
        #: [number of a cell]: whether the cell is free
        self.free = free.ravel()
        #: [step]: the change of a cell's number by each of STEPS
        self.offsets = np.array([row * self.stride + column for column, row in STEPS])
        #: [number of a cell]: bit k says that the k-th of STEPS is allowed; diagonals cut no corner of blocked cells
        self.steps = _bits(free, STEPS, lambda cell, one, other, end: cell & one & other & end).ravel()
        #: [number of a cell]: a number that any user of the grid may overwrite
        self.scratch = np.zeros(free.size, np.int32)
        #: [number of a cell]: bit k says that a convex corner of the cells that are not free is diagonally next to the
        #: cell, in the direction of the k-th diagonal one of STEPS
        corners = _bits(free, STEPS[4:], lambda cell, one, other, end: cell & one & other & ~end)
        self._corners_of = memoryview(corners.ravel())
        self._corners = corners[1:-1, 1:-1]
        self._is_free = memoryview(self.free.view(np.uint8))
        # [column, row]: the number of cells of the column south of the row that are not free
        counts = np.zeros((columns, rows + 1), np.int32)
        np.cumsum(blocked.T, axis=1, out=counts[:, 1:])
        self._counts = counts.ravel()

    def place(self, column: float, row: float) -> Optional[Tuple[int, int]]:
        """Return the place (1/256 cells) of a point that is given in cells with fractions, or None off the grid.

        It is the nearest place inside the point's cell that is at least two parts off the cell's borders.
        """
        if not (0.0 <= column < self.columns and 0.0 <= row < self.rows):
            return None
        return _inside(column), _inside(row)

    def contains(self, place: Tuple[int, int]) -> bool:
        """Return whether ``place`` is on the grid."""
        return bool(0 <= place[0] < self.columns * PARTS and 0 <= place[1] < self.rows * PARTS)

    def cell_of(self, place: Tuple[int, int]) -> int:
        """Return the number of the cell that contains ``place``."""
        return (place[1] // PARTS + 1) * self.stride + place[0] // PARTS + 1

    def centre_of(self, cell: int) -> Tuple[int, int]:
        """Return the place in the middle of the cell with the number ``cell``."""
        row, column = divmod(cell, self.stride)
        return (column - 1) * PARTS + _HALF, (row - 1) * PARTS + _HALF

    def is_free(self, cell: int) -> bool:
        """Return whether the cell with the number ``cell`` is free."""
        return bool(self._is_free[cell])

    def is_corner(self, cell: int) -> bool:
        """Return whether a convex corner of the cells that are not free is diagonally next to a cell."""
        return self._corners_of[cell] != 0

    def corners_within(self, places: Tuple[Tuple[int, int], ...]) -> Tuple[NDArray[Any], NDArray[Any]]:
        """Return (corners, bends) in the box around ``places``, as arrays [corner, x and y] in parts, as for places.

        The corners are the convex corners of the cells that are not free. A bend is the nearest allowed place to its
        corner, at which a way bends around it.
        """
        low = [max(min(values) // PARTS - 1, 0) for values in zip(*places)]
        high = [max(values) // PARTS + 2 for values in zip(*places)]
        window = self._corners[low[1]:high[1], low[0]:high[0]]
        rows, columns = np.nonzero(window)
        bits = window[rows, columns]
        cells = np.stack((columns, rows), axis=1) + low
        corners, bends = [], []
        for number, step in enumerate(STEPS[4:]):
            corners.append((cells[bits >> number & 1 != 0] * 2 + 1 + step) * _HALF)
            bends.append(corners[-1] - np.multiply(step, _OFF))
        return np.concatenate(corners), np.concatenate(bends)

    def corner_at(self, place: Tuple[int, int]) -> Optional[Tuple[int, int]]:
        """Return the direction (+-1, +-1) of the corner for which ``place`` is the nearest allowed place, or None."""
        parts = place[0] % PARTS, place[1] % PARTS
        if not all(part in (_OFF, PARTS - _OFF) for part in parts):
            return None
        step = (1 if parts[0] > _HALF else -1, 1 if parts[1] > _HALF else -1)
        return step if self._corners_of[self.cell_of(place)] >> STEPS.index(step) - 4 & 1 else None

    def nearest_free(self, place: Tuple[int, int], reach: int) -> Optional[int]:
        """Return the number of the free cell nearest to ``place``, at most ``reach`` cells away, or None.

        The distance is that of the cells' centres. Of equally near ones the southernmost counts, then the westernmost.
        """
        column, row = place[0] // PARTS, place[1] // PARTS
        first, low = max(column - reach, 0), max(row - reach, 0)
        free = self.free.reshape(self.rows + 2, self.stride)
        rows, columns = np.nonzero(free[low + 1:max(row + reach + 2, 0), first + 1:max(column + reach + 2, 0)])
        distances = (rows + (low - row)) ** 2 + (columns + (first - column)) ** 2
        if not len(distances) or distances.min() > reach * reach:
            return None
        best = distances.argmin()
        return int((rows[best] + low + 1) * self.stride + columns[best] + first + 1)

    def sees(self, one: Tuple[int, int], other: Tuple[int, int], margin: int = MARGIN) -> bool:
        """Return whether each cell within ``margin`` parts (0 or 1) of the straight line between two places is free.

        With 0 these are the cells that the line touches, including its ends and the cells' borders; a line through a
        corner touches all four cells there. With 1 a square with sides of two parts moves along the line. In each
        column of cells it covers the rows from its lower to its upper end there. The point at which it crosses a border
        is a fraction, which is compared without division.
        """
        (x, y), (end_x, end_y) = sorted((one, other))
        for share in _EIGHTHS:  # quick test: most lines that are not clear show it at one of these points
            rest = 8 - share
            cell = (rest * y + share * end_y) // _PARTS_OF_8 * self.stride + (rest * x + share * end_x) // _PARTS_OF_8
            if not self._is_free[cell + self.stride + 1]:
                return False
        width, height = end_x - x, end_y - y
        first, last = x // PARTS, end_x // PARTS
        stride = self.rows + 1
        if first == last:
            low, high = min(y, end_y) // PARTS, max(y, end_y) // PARTS
            return bool(self._counts[first * stride + high + 1] == self._counts[first * stride + low])
        # Heights of the line at the borders of columns, times width. Its ends are off their cells' borders by more
        # than the margin.
        heights = (np.arange(first + 1, last + 1) * PARTS - x) * height + y * width
        spread = margin * (width + abs(height))
        lows, highs = np.empty(last - first + 1, np.int64), np.empty(last - first + 1, np.int64)
        if height >= 0:
            lows[0], lows[1:], highs[:-1], highs[-1] = y * width, heights - spread, heights + spread, end_y * width
        else:
            highs[0], highs[1:], lows[:-1], lows[-1] = y * width, heights + spread, heights - spread, end_y * width
        scale = PARTS * width
        columns = np.arange(first * stride, (last + 1) * stride, stride)
        above = self._counts[columns + highs // scale + 1]
        return bool((above == self._counts[columns + (lows - 1) // scale]).all())


def _inside(value: Any) -> int:
    cell = int(value)
    return cell * PARTS + min(max(int((value - cell) * PARTS + 0.5), _OFF), PARTS - _OFF)


def _bits(free: NDArray[Any], steps: Sequence[Tuple[int, int]], sides_and_end: Callable[..., Any]) -> NDArray[Any]:
    """Return for each cell as bits for which of ``steps`` ``sides_and_end(cell, side, side, end)`` is true."""
    bits = np.zeros(free.shape, np.uint8)
    inner = bits[1:-1, 1:-1]
    rows, columns = inner.shape

    def shifted(dx: int, dy: int) -> NDArray[Any]:
        return free[1 + dy:1 + dy + rows, 1 + dx:1 + dx + columns]
    for number, (dx, dy) in enumerate(steps):
        found = sides_and_end(shifted(0, 0), shifted(dx, 0), shifted(0, dy), shifted(dx, dy))
        inner |= found.astype(np.uint8) << number
    return bits
