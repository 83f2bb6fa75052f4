"""The places of samples: the starts of the robots, and the three ways of making tasks."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, NamedTuple, Optional, Set, Tuple, Union

import numpy as np

from ..config import Sampling
from ..seeds import Purpose, generator
from .coarse_cells import coarse_cells

if TYPE_CHECKING:
    from ..config import TrialConfig
    from ..ground_truth.grid import Grid
    from ..interpolation.kriging import Estimate

GRID_POINTS = 10  # per side
GRID_MARGIN = 0.05  # of the field's extent, at each side
VARIANCE_DECIMALS = 6  # of kPa^2: variances that differ by rounding errors only are equal on every machine


class Task(NamedTuple):
    """A place for a sample, in the map frame [m]."""

    number: int  # from 0, in the order in which tasks are made
    x: float
    y: float


def start_places(robots: int, seed: int, grid: Grid) -> Tuple[Tuple[float, float], ...]:
    """Return the start (x, y) of each robot [m, map frame], drawn uniformly, each from a generator of its own.

    Places are drawn in metres and moved to the centre of their cell, so that the starts on other grids are nearly
    equal.
    """
    draws = (generator(seed, Purpose.START, robot) for robot in range(robots))
    return tuple(_uniform_place(draw, grid) for draw in draws)


def make_sampling(config: TrialConfig, seed: int, grid: Grid) -> Union[DynamicSampling, GridSampling, RandomSampling]:
    """Return the object that makes the tasks of a mission, as a TrialConfig says."""
    if config.sampling is Sampling.GRID:
        return GridSampling(grid)
    at_random = RandomSampling(config.robots, seed, grid)
    if config.sampling is Sampling.RANDOM:
        return at_random
    return DynamicSampling(2 * config.robots, coarse_cells(config, grid), grid, at_random)


class RandomSampling:
    """At each call as many tasks as there are robots, uniform over the field; no cell twice."""

    first_samples = True  # each robot first samples at its start

    def __init__(self, count: int, seed: int, grid: Grid) -> None:
        self._count = count
        self._grid = grid
        self._draw = generator(seed, Purpose.RANDOM_TASKS)
        self._used: Set[Any] = set()
        self._made = 0

    @property
    def exhausted(self) -> bool:
        """Whether every cell has had a task."""
        return len(self._used) >= self._grid.rows * self._grid.columns

    def new_tasks(self, estimate: Optional[Estimate]) -> List[Task]:
        """Return the next tasks; the Estimate is not used."""
        tasks: List[Any] = []
        while len(tasks) < self._count and not self.exhausted:
            place = _uniform_place(self._draw, self._grid)
            if place not in self._used:
                self._used.add(place)
                tasks.append(Task(self._made, *place))
                self._made += 1
        return tasks


class DynamicSampling:
    """Tasks where the map is least certain.

    At each call it takes the coarse cells with the highest mean kriging variance among those without a task so far, in
    falling order of mean variance. The task is at their cell of highest variance. Variances are compared to the sixth
    decimal. Ties are frequent if the fitted range is short: the lower label, then the southern, then the western cell.

    :param count: number of tasks at each call. :param labels: coarse cell of each cell, from 0.
    :param before: the sampling that makes tasks while there is no map.
    """

    first_samples = True

    def __init__(self, count: int, labels: np.ndarray, grid: Grid, before: RandomSampling) -> None:
        self._count = count
        self._labels = labels
        self._sizes = np.bincount(labels.ravel())
        self._grid = grid
        self._free = np.ones(len(self._sizes), dtype=bool)
        self._before = before
        self._made = 0

    @property
    def exhausted(self) -> bool:
        """Whether every coarse cell has had a task."""
        return not self._free.any()

    def new_tasks(self, estimate: Optional[Estimate]) -> List[Task]:
        """Return the tasks for an Estimate; without one (None), those of random sampling."""
        if estimate is None:
            tasks = self._before.new_tasks(None)
        else:
            tasks = [Task(self._made + i, *self._grid.centre(*cell)) for i, cell in enumerate(self._pick(estimate))]
        self._made += len(tasks)
        return tasks

    def _pick(self, estimate: Estimate) -> List[Tuple[int, int]]:
        """Return (row, column) of each task, and mark the coarse cells as used."""
        variance = estimate.variance.round(VARIANCE_DECIMALS)
        mean = (np.bincount(self._labels.ravel(), weights=variance.ravel()) / self._sizes).round(VARIANCE_DECIMALS)
        order = np.argsort(-np.where(self._free, mean, -np.inf), kind='stable')[:self._count]
        chosen = [label for label in order if self._free[label]]
        self._free[chosen] = False
        return [np.unravel_index(np.argmax(np.where(self._labels == label, variance, -np.inf)),
                                 self._grid.shape) for label in chosen]


class GridSampling:
    """10 x 10 points with a margin of 5 % of the field at each side, all at once: from the south-west, row by row."""

    first_samples = False  # the tasks exist at once

    def __init__(self, grid: Grid) -> None:
        self._grid = grid
        self.exhausted = False  # whether the tasks are made

    def new_tasks(self, estimate: Any) -> List[Task]:
        """Return all tasks at the first call, and none later; the Estimate is not used."""
        if self.exhausted:
            return []
        self.exhausted = True
        share = np.linspace(GRID_MARGIN, 1.0 - GRID_MARGIN, GRID_POINTS)
        places = [self._grid.snap(x, y) for y in share * self._grid.height_m for x in share * self._grid.width_m]
        return [Task(number, *place) for number, place in enumerate(places)]


def _uniform_place(draw: Any, grid: Grid) -> Tuple[float, float]:
    x, y = draw.uniform(0.0, (grid.width_m, grid.height_m))
    return grid.snap(x, y)
