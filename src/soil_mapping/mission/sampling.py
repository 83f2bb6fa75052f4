"""Where samples are taken: the starts of the robots, and the three ways of making tasks."""

from typing import NamedTuple

import numpy as np

from ..config import Sampling
from ..seeds import Purpose, generator
from .coarse_cells import coarse_cells

GRID_POINTS = 10  # per side
GRID_MARGIN = 0.05  # of the field's extent, at each side
VARIANCE_DECIMALS = 6  # of kPa^2: where variances differ by rounding errors only, no machine decides otherwise


class Task(NamedTuple):
    """A place to sample, in the map frame [m]."""

    number: int  # from 0, in the order in which tasks are made
    x: float
    y: float


def start_places(robots, seed, grid):
    """Return the (x, y) at which each robot starts, drawn uniformly, each from a generator of its own.

    Places are drawn in metres and moved to the middle of their cell, so that grids of other cells start nearly alike.
    """
    draws = (generator(seed, Purpose.START, robot) for robot in range(robots))
    return tuple(_uniform_place(draw, grid) for draw in draws)


def make_sampling(config, seed, grid):
    """Return the object that makes the tasks of a mission, as a TrialConfig asks."""
    if config.sampling is Sampling.GRID:
        return GridSampling(grid)
    at_random = RandomSampling(config.robots, seed, grid)
    if config.sampling is Sampling.RANDOM:
        return at_random
    return DynamicSampling(2 * config.robots, coarse_cells(config, grid), grid, at_random)


class RandomSampling:
    """As many tasks as there are robots, uniform over the field; no cell twice."""

    first_samples = True  # each robot samples where it starts

    def __init__(self, count, seed, grid):
        self._count = count
        self._grid = grid
        self._draw = generator(seed, Purpose.RANDOM_TASKS)
        self._used = set()
        self._made = 0

    @property
    def exhausted(self):
        """Whether every cell has had a task."""
        return len(self._used) >= self._grid.rows * self._grid.columns

    def new_tasks(self, estimate):
        """Return the next tasks; the Estimate does not matter."""
        tasks = []
        while len(tasks) < self._count and not self.exhausted:
            place = _uniform_place(self._draw, self._grid)
            if place not in self._used:
                self._used.add(place)
                tasks.append(Task(self._made, *place))
                self._made += 1
        return tasks


class DynamicSampling:
    """Tasks where the map is least certain.

    Each time, in the coarse cells with the highest mean kriging variance of those without a task so far, each at its
    cell of highest variance; in falling order of mean variance. Variances are compared to the sixth decimal.
    Ties, which are frequent where the fitted range is short: lower label, then southern, then western cell.

    :param count: tasks at a time. :param labels: coarse cell of each cell, from 0.
    :param before: what makes tasks as long as there is no map.
    """

    first_samples = True

    def __init__(self, count, labels, grid, before):
        self._count = count
        self._labels = labels
        self._sizes = np.bincount(labels.ravel())
        self._grid = grid
        self._free = np.ones(len(self._sizes), dtype=bool)
        self._before = before
        self._made = 0

    @property
    def exhausted(self):
        """Whether every coarse cell has had a task."""
        return not self._free.any()

    def new_tasks(self, estimate):
        """Return the tasks that an Estimate asks for; without one (None) those of random sampling."""
        if estimate is None:
            tasks = self._before.new_tasks(None)
        else:
            tasks = [Task(self._made + i, *self._grid.centre(*cell)) for i, cell in enumerate(self._pick(estimate))]
        self._made += len(tasks)
        return tasks

    def _pick(self, estimate):
        """Return (row, column) per task and mark the coarse cells as used."""
        variance = estimate.variance.round(VARIANCE_DECIMALS)
        mean = (np.bincount(self._labels.ravel(), weights=variance.ravel()) / self._sizes).round(VARIANCE_DECIMALS)
        order = np.argsort(-np.where(self._free, mean, -np.inf), kind='stable')[:self._count]
        chosen = [label for label in order if self._free[label]]
        self._free[chosen] = False
        return [np.unravel_index(np.argmax(np.where(self._labels == label, variance, -np.inf)),
                                 self._grid.shape) for label in chosen]


class GridSampling:
    """10 x 10 points with a margin of 5 % of the field at each side, all at once: from the south-west, row by row."""

    first_samples = False  # the tasks are there at once

    def __init__(self, grid):
        self._grid = grid
        self.exhausted = False  # whether the tasks are made

    def new_tasks(self, estimate):
        """Return all tasks the first time, none later; the Estimate does not matter."""
        if self.exhausted:
            return []
        self.exhausted = True
        share = np.linspace(GRID_MARGIN, 1.0 - GRID_MARGIN, GRID_POINTS)
        places = [self._grid.snap(x, y) for y in share * self._grid.height_m for x in share * self._grid.width_m]
        return [Task(number, *place) for number, place in enumerate(places)]


def _uniform_place(draw, grid):
    x, y = draw.uniform(0.0, (grid.width_m, grid.height_m))
    return grid.snap(x, y)
