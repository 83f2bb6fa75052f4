"""The shortest ways from the cells of a grid to one of them: a wave that runs only as far as needed.

Dijkstra's algorithm with a bucket for each straight step's length (Dial): no step is shorter, so that the cells of one
bucket do not change one another and are settled at once. Costs are whole numbers, 985 for a straight step and 1393 for
a diagonal one; 1393 / 985 is the square root of 2 to 3 parts in 10 million, so that no float decides.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, Tuple

import numpy as np

from .planning_grid import STEPS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .planning_grid import PlanningGrid

STRAIGHT, DIAGONAL = 985, 1393

_MOST = 2 ** 29  # of a cost with the bits beside it, while it has 32 bits
_STEP_BITS = 3  # beside a cost stands the step by which it came: of equal ones the smaller is the first of STEPS
_LENGTHS = np.array([(STRAIGHT if 0 in step else DIAGONAL) << _STEP_BITS | number
                     for number, step in enumerate(STEPS)])
_UNSETTLED = 255
#: by a cell's allowed steps: which these are, [256, 8]
_ALLOWED = (np.arange(256)[:, np.newaxis] >> np.arange(len(STEPS)) & 1).astype(bool)


def _lengths(kind: Any) -> Tuple[int, NDArray[Any]]:
    """Return what is 'far' for costs of a type of integer, and by allowed steps what each costs, [8, 256]."""
    far = np.iinfo(kind).max // 2
    return far, np.where(_ALLOWED, _LENGTHS, far // 2).T.astype(kind)


_OF_KIND = {kind: _lengths(kind) for kind in (np.int32, np.int64)}


class CostField:
    """First steps of the shortest ways over free cells of ``grid`` (PlanningGrid) to the cell with the number ``goal``.

    Of equally long ways the step that comes first in STEPS is taken, at each cell.
    """

    def __init__(self, grid: PlanningGrid, goal: int) -> None:
        self.goal = goal
        self._grid = grid
        self._steps = np.full(len(grid.free), _UNSETTLED, np.uint8)
        self._steps[goal] = 0
        self._step_of = memoryview(self._steps)
        self._is_whole = self._rested = False
        # of a wave that can go on; costs None: it cannot
        self._costs: Any = None
        self._open: Any = None
        self._front: Any = None
        self._waiting: Any = None

    def leads_from(self, cell: int) -> bool:
        """Return whether there is a way from the cell with a number."""
        while self._step_of[cell] == _UNSETTLED:
            if self._is_whole or not self._go_on():
                return False
        if self._rested and self._costs is not None:  # once is enough: it is run to its end
            while self._go_on():
                pass
        return True

    def way_from(self, cell: int) -> List[int]:
        """Return the numbers of the cells of the shortest way, the first being ``cell``; a way must lead from there."""
        offsets, steps, goal = self._grid.offsets.tolist(), self._step_of, self.goal
        way = [cell]
        while cell != goal:
            cell += offsets[steps[cell]]
            way.append(cell)
        return way

    def rest(self) -> None:
        """Take little memory from now on, a byte a cell: to go on further the wave must start anew."""
        self._rested = True
        self._costs = self._open = self._front = self._waiting = None

    def _begin(self) -> None:
        self._use(np.int32)
        self._costs = np.full(len(self._steps), self._far, np.int32)  # with the bits beside them
        self._costs[self.goal] = 0
        self._open = self._grid.free.copy()
        self._open[self.goal] = False
        self._front = np.array([self.goal])
        self._waiting = np.empty(0, self._front.dtype)
        self._limit = STRAIGHT << _STEP_BITS

    def _use(self, kind: Any) -> None:
        self._far, self._lengths = _OF_KIND[kind]

    def _go_on(self) -> bool:
        """Settle the cells of the next bucket; return whether there are any."""
        if self._costs is None:
            self._begin()
        waiting = self._met()
        if not len(waiting):
            self._is_whole = True
            self.rest()
            return False
        self._limit += STRAIGHT << _STEP_BITS
        if self._limit > _MOST and self._costs.dtype == np.int32:
            self._widen()
        steps = self._grid.steps
        offers = self._costs[waiting + self._grid.offsets[:, np.newaxis]]
        offers += self._lengths[:, steps[waiting]]
        best = offers.min(axis=0)
        is_settled = best < self._limit
        front, best = waiting[is_settled], best[is_settled]
        self._costs[front] = best & ~7
        self._steps[front] = best & 7
        self._front, self._waiting = front, waiting[~is_settled]
        return True

    def _widen(self) -> None:
        was_far = self._costs >= self._far
        self._costs = self._costs.astype(np.int64)
        self._use(np.int64)
        self._costs[was_far] = self._far

    def _met(self) -> NDArray[Any]:
        """Return the cells that wait to be settled: those left over and the neighbours of those settled last, once."""
        grid, front = self._grid, self._front
        near = front[:, np.newaxis] + grid.offsets
        near = near[_ALLOWED[grid.steps[front]] & self._open[near]]
        if not len(near):
            return self._waiting
        order = np.arange(len(near), dtype=np.int32)
        grid.scratch[near] = order  # of those that are there twice the last one stays
        near = near[grid.scratch[near] == order]
        self._open[near] = False
        return np.concatenate((self._waiting, near)) if len(self._waiting) else near
