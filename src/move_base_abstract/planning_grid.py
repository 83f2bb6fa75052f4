"""The cells of a map that a robot of a given radius may be in, and which places see each other. Integers only.

A place is (column, row) in 1/256 of a cell, whole numbers. What a straight line between two places touches is found
without rounding, so that no decision hangs on the last digit of a float.
"""
import math

import numpy as np

from .occupancy import OCCUPIED, UNKNOWN

#: parts of a cell in which places are counted; even, so that a cell's centre is one
PARTS = 256
_HALF = PARTS // 2
_PARTS_OF_8 = 8 * PARTS
_EIGHTHS = (4, 2, 6, 1, 3, 5, 7)  # of a line

#: the eight steps (columns, rows) in the order in which equal ones are taken: straight before diagonal
STEPS = ((1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1))


def blocked_cells(cells, radius, unknown_is_free=True):
    """Return which of ``cells`` (int8 of an OccupancyMap) no robot's centre may be in, as an array of bool.

    Those are the occupied ones and all whose centre lies within ``radius`` [cells] of the centre of one, as those that
    costmap_2d calls inscribed; and the unknown ones, if these are not free. The disc is one of whole numbers; a
    millionth is allowed for, so that 0.3 m are three cells of 0.1 m in 32 bits too.
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


def _widened(occupied, reach):
    """Return which cells have an occupied one within ``reach`` cells to the east or west."""
    rows, columns = occupied.shape
    counts = np.zeros((rows, columns + 1), np.int32)
    np.cumsum(occupied, axis=1, out=counts[:, 1:])
    places = np.arange(columns)
    return counts[:, np.minimum(places + reach + 1, columns)] > counts[:, np.maximum(places - reach, 0)]


class PlanningGrid:
    """Which cells are free, [row from the south, column from the west]; off the grid nothing is. Immutable.

    A cell's number is ``(row + 1) * stride + column + 1``: around the grid lies a border of cells that are not free.
    """

    def __init__(self, blocked):
        rows, columns = blocked.shape
        self.rows, self.columns = rows, columns
        self.stride = columns + 2
        free = np.zeros((rows + 2, columns + 2), bool)
        free[1:-1, 1:-1] = ~blocked
        #: whether a cell is free, by its number
        self.free = free.ravel()
        #: how a cell's number changes with each of STEPS
        self.offsets = np.array([row * self.stride + column for column, row in STEPS])
        #: by a cell's number: bit k says that the k-th of STEPS is allowed: diagonals cut no corner that is not free
        self.steps = _allowed_steps(free)
        #: a number for each cell that anybody may overwrite
        self.scratch = np.zeros(free.size, np.int32)
        corner = np.zeros(free.shape, bool)
        corner[1:-1, 1:-1] = _convex_corners(free)
        self._is_corner = memoryview(corner.ravel().view(np.uint8))
        #: which cells lie diagonally outside of a corner of what is not free, [row, column]
        self.corners = corner[1:-1, 1:-1]
        self._is_free = memoryview(self.free.view(np.uint8))
        # [column, row]: how many cells of the column south of the row are not free
        counts = np.zeros((columns, rows + 1), np.int32)
        np.cumsum(blocked.T, axis=1, out=counts[:, 1:])
        self._counts = counts.ravel()

    def place(self, column, row):
        """Return the place (1/256 cells) of a point given in cells with fractions, or None off the grid.

        It lies inside of the point's cell, never on its border.
        """
        if not (0.0 <= column < self.columns and 0.0 <= row < self.rows):
            return None
        return _inside(column), _inside(row)

    def cell_of(self, place):
        """Return the number of the cell in which ``place`` lies."""
        return (place[1] // PARTS + 1) * self.stride + place[0] // PARTS + 1

    def centre_of(self, cell):
        """Return the place in the middle of the cell with a number."""
        row, column = divmod(cell, self.stride)
        return (column - 1) * PARTS + _HALF, (row - 1) * PARTS + _HALF

    def is_free(self, cell):
        """Return whether the cell with a number is free."""
        return bool(self._is_free[cell])

    def is_corner(self, cell):
        """Return whether a cell lies diagonally outside of a corner of what is not free."""
        return bool(self._is_corner[cell])

    def nearest_free(self, place, reach):
        """Return the number of the free cell nearest to ``place``, at most ``reach`` cells away, or None.

        The distance is that of the cells' centres; of equal ones the southernmost counts, then the westernmost.
        """
        column, row = place[0] // PARTS, place[1] // PARTS
        best = None
        for dy in range(max(-reach, -row), min(reach, self.rows - 1 - row) + 1):
            for dx in range(max(-reach, -column), min(reach, self.columns - 1 - column) + 1):
                cell = (row + dy + 1) * self.stride + column + dx + 1
                distance = dx * dx + dy * dy
                if self._is_free[cell] and distance <= reach * reach and (best is None or distance < best[0]):
                    best = distance, cell
        return best[1] if best else None

    def sees(self, one, other):
        """Return whether each cell that the straight line between two places touches is free, ends and borders too.

        A line through a corner touches all four cells there. Along each column of cells the line covers rows from its
        lower to its upper end there; where it crosses into the next column is a fraction, compared without dividing.
        """
        (x, y), (end_x, end_y) = sorted((one, other))
        for share in _EIGHTHS:  # a point of the line lies in a cell that it touches: most that are not clear show here
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
        heights = np.empty(last - first + 2, np.int64)  # of the line at each column's borders, times width
        heights[0], heights[-1] = y * width, end_y * width
        heights[1:-1] = (np.arange(first + 1, last + 1) * PARTS - x) * height + y * width
        low, high = (heights[:-1], heights[1:]) if height >= 0 else (heights[1:], heights[:-1])
        scale = PARTS * width
        columns = np.arange(first * stride, (last + 1) * stride, stride)
        above = self._counts[columns + high // scale + 1]
        return bool((above == self._counts[columns + (low - 1) // scale]).all())


def _inside(value):
    cell = int(value)
    return cell * PARTS + min(max(int((value - cell) * PARTS), 1), PARTS - 1)


def _allowed_steps(free):
    steps = np.zeros(free.shape, np.uint8)
    inner = steps[1:-1, 1:-1]
    rows, columns = inner.shape

    def shifted(dx, dy):
        return free[1 + dy:1 + dy + rows, 1 + dx:1 + dx + columns]
    for number, (dx, dy) in enumerate(STEPS):
        inner |= (shifted(0, 0) & shifted(dx, dy) & shifted(dx, 0) & shifted(0, dy)).astype(np.uint8) << number
    return steps.ravel()


def _convex_corners(free):
    rows, columns = free.shape[0] - 2, free.shape[1] - 2

    def shifted(dx, dy):
        return free[1 + dy:1 + dy + rows, 1 + dx:1 + dx + columns]
    corner = np.zeros((rows, columns), bool)
    for dx, dy in STEPS[4:]:
        corner |= shifted(0, 0) & shifted(dx, 0) & shifted(0, dy) & ~shifted(dx, dy)
    return corner
