"""The shortest ways from the cells of a grid to one of them: a wave that runs only as far as needed.

This is Dijkstra's algorithm with buckets (Dial). A bucket is as wide as a straight step. No step is shorter, so the
cells of one bucket do not affect each other, and all of them are settled at once. Costs are whole numbers, so no float
decides: 985 for a straight step and 1393 for a diagonal one. 1393 / 985 is the square root of 2 to 3 parts in 10
million.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, Tuple

import numpy as np

from .planning_grid import STEPS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .planning_grid import PlanningGrid

STRAIGHT, DIAGONAL = 985, 1393

_MOST = 2 ** 29  # the largest cost, with its step bits, in 32 bits
_STEP_BITS = 3  # a cost contains its step in the lowest bits: of equal costs, the one with the first of STEPS is less
_LENGTHS = np.array([(STRAIGHT if 0 in step else DIAGONAL) << _STEP_BITS | number
                     for number, step in enumerate(STEPS)])
_UNSETTLED = 255
#: [allowed steps of a cell as bits, step]: whether the step is allowed; the shape is (256, 8)
_ALLOWED = (np.arange(256)[:, np.newaxis] >> np.arange(len(STEPS)) & 1).astype(bool)


def _lengths(kind: Any) -> Tuple[int, NDArray[Any]]:
    """Return (the cost that means 'far' for a type of integer, the cost of [step, allowed steps], (8, 256))."""
    far = np.iinfo(kind).max // 2
    return far, np.where(_ALLOWED, _LENGTHS, far // 2).T.astype(kind)


_OF_KIND = {kind: _lengths(kind) for kind in (np.int32, np.int64)}


class CostField:
    """First steps of the shortest ways over free cells of ``grid`` (PlanningGrid) to the cell with the number ``goal``.

    Of equally long ways, the one whose step comes first in STEPS is taken, at each cell.
    """

    def __init__(self, grid: PlanningGrid, goal: int) -> None:
        self.goal = goal
        self._grid = grid
        self._steps = np.full(len(grid.free), _UNSETTLED, np.uint8)
        self._steps[goal] = 0
        self._step_of = memoryview(self._steps)
        self._is_whole = self._rested = False
        # The state of a wave that can go on; if _costs is None, it cannot.
        self._costs: Any = None
        self._open: Any = None
        self._front: Any = None
        self._waiting: Any = None

    def leads_from(self, cell: int) -> bool:
        """Return whether there is a way from the cell with the number ``cell``."""
        while self._step_of[cell] == _UNSETTLED:
            if self._is_whole or not self._go_on():
                return False
        if self._rested and self._costs is not None:  # run the wave to its end, so that it need not start a third time
            while self._go_on():
                pass
        return True

    def way_from(self, cell: int) -> List[int]:
        """Return the numbers of the cells of the shortest way, beginning with ``cell``; there must be a way."""
        offsets, steps, goal = self._grid.offsets.tolist(), self._step_of, self.goal
        way = [cell]
        while cell != goal:
            cell += offsets[steps[cell]]
            way.append(cell)
        return way

    def rest(self) -> None:
        """Free memory, down to a byte per cell. To go on, the wave must then start again."""
        self._rested = True
        self._costs = self._open = self._front = self._waiting = None

    def _begin(self) -> None:
        self._use(np.int32)
        self._costs = np.full(len(self._steps), self._far, np.int32)  # with their step bits
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
        """Return the cells that wait to be settled, each once: those left over and new neighbours of settled ones."""
        grid, front = self._grid, self._front
        near = front[:, np.newaxis] + grid.offsets
        near = near[_ALLOWED[grid.steps[front]] & self._open[near]]
        if not len(near):
            return self._waiting
        order = np.arange(len(near), dtype=np.int32)
        grid.scratch[near] = order  # of a cell that is there twice, the last number stays
        near = near[grid.scratch[near] == order]
        self._open[near] = False
        return np.concatenate((self._waiting, near)) if len(self._waiting) else near
