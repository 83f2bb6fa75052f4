"""Ways over cells, shortened to a few straight pieces at any angle by lines of sight.

The shortest way over the cells has candidates for bends: the cells where it turns, or where it passes a corner of the
cells that are not free. From a place the shortened way goes straight to one of the next candidates, and on from there
in the same way; the choice with the shortest total length counts. Lengths are whole numbers, in 1/65536 of a cell,
rounded up for each piece, so a straight way is never longer than one with a corner. Of equally long ways the one with
the fewest corners counts, then the one whose first corner is furthest along the way.
"""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, List, NamedTuple, Optional, Tuple

if TYPE_CHECKING:
    from .cost_field import CostField
    from .planning_grid import PlanningGrid

_BITS = 16  # lengths are 256 times finer than places, so their squares are shifted by twice 8 bits
_AHEAD = 48  # the number of candidates ahead to which a straight piece is tried


def length_between(one: Tuple[int, int], other: Tuple[int, int]) -> int:
    """Return the distance between two places [1/65536 cell], rounded up."""
    dx, dy = other[0] - one[0], other[1] - one[1]
    squared = (dx * dx + dy * dy) << _BITS
    return math.isqrt(squared - 1) + 1 if squared else 0


class _Tail(NamedTuple):
    """The rest of a way: its length to the goal, the number of its corners, and the cell at which it bends next."""

    length: int
    corners: int
    next: Optional[int]


class Shortener:
    """The shortened ways to ``goal``, a place in the cell to which ``field`` (CostField) leads.

    The best way from each cell is kept, since ways to one goal soon run together. No way depends on earlier questions.
    """

    def __init__(self, grid: PlanningGrid, field: CostField, goal: Tuple[int, int]) -> None:
        self.goal = goal
        self.field = field
        self._grid = grid
        self._tails = {field.goal: _Tail(0, 0, None)}

    def corners_from(self, place: Tuple[int, int]) -> List[Tuple[int, int]]:
        """Return the places of the corners between ``place`` and the goal; there must be a way from its cell."""
        cells = self.field.way_from(self._grid.cell_of(place))
        turns = self._turns(cells)
        for number in range(len(turns) - 2, -1, -1):
            cell = turns[number]
            if cell not in self._tails:
                self._tails[cell] = self._best(self._grid.centre_of(cell), turns[number + 1:number + 1 + _AHEAD])
        corners = []
        tail = self._best(place, turns[:_AHEAD])
        while tail.next is not None and tail.next != self.field.goal:
            corners.append(self._grid.centre_of(tail.next))
            tail = self._tails[tail.next]
        return corners

    def _turns(self, cells: List[int]) -> List[int]:
        """Return the ``cells`` at which a way may bend: turns, corners, and the neighbours of its ends."""
        is_corner = self._grid.is_corner
        turns = []
        step = None
        last = len(cells) - 1
        for number in range(1, last):
            cell = cells[number]
            next_step = cells[number + 1] - cell
            if next_step != step or number == last - 1 or is_corner(cell):
                turns.append(cell)
            step = next_step
        return turns + cells[-1:]

    def _best(self, place: Tuple[int, int], turns: List[int]) -> _Tail:
        """Return the best way on from ``place`` by one of ``turns``; at least the first of them must be visible."""
        choices = []
        for number, cell in enumerate(turns):
            tail = self._tails[cell]
            length = length_between(place, self._place_of(cell)) + tail.length
            choices.append((length, tail.corners + (cell != self.field.goal), -number, cell))
        choices.sort()
        for length, corners, _number, cell in choices:
            if self._grid.sees(place, self._place_of(cell)):
                return _Tail(length, corners, cell)
        raise AssertionError('a way over cells whose next cell is not seen')

    def _place_of(self, cell: int) -> Tuple[int, int]:
        return self.goal if cell == self.field.goal else self._grid.centre_of(cell)
