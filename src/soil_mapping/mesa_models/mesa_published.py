"""The published Mesa study with its own rules, to compare with its published results. All units are cells and steps.

A cell is 2 m, a step 1 s, the grid 162 x 110 cells. The rules are those of the published program (TAROS 2022). They
differ from those in mission/coordinator.py in these points:

- In each step a robot moves to one of eight neighbouring cells, along a path that is searched anew at each step
  (greedy_path.py). Cells within 2 steps of any place where another robot has been weigh 2 for it, others 1. If its next
  cell is taken, or it stands on the next cell of another robot's path, it moves to a random free cell beside it
  instead. In the first case it draws one of the free cells, in the second one of all cells, until the cell is free.
- It samples in the step after its arrival. If it has a task, it sets off again in the step after that.
- If there are at least as many samples as robots, each sample makes new tasks. Dynamic sampling makes them in the six
  unused clusters with the highest mean variance, in the order of the clusters' numbers. A cluster that contains a
  robot's start is used up without a task.
- The cost of a queue leaves out the way to its first task, unless that is the new one. It is the weight of all cells on
  the path from the robot to the new task, plus that of the paths between the queue's tasks in order, at any position of
  the new one. Both allocations insert a task where this is least. The lowest cost wins the auction.
- A random task is drawn from all cells. If that cell has had a task, it is drawn once more from a list of the cells
  that have had none, column by column. If two tasks of one round are equal, the second one is dropped.
- PyKrige fits the variograms. With few samples its fit is not well-posed: the last digits decide it, and so does the
  processor, through its BLAS kernel.
- There are two random generators of Python's own, both seeded by the trial's number: for starts, and for tasks and side
  steps.

The figures (see figures()) are those that the program wrote, counted in the same way.
"""
from __future__ import annotations

import math
import random
from typing import Any, Dict, List, Set

import mesa
import numpy as np

from ..config import Allocation, Sampling
from ..ground_truth.grid import Grid
from ..interpolation.kriging import MIN_SAMPLES, Kriging
from ..interpolation.variogram import Variogram
from ..mission.coarse_cells import field_clusters

WIDTH, HEIGHT = 162, 110  # cells
CROWDED_WEIGHT = 2
CROWDED_RADIUS = 2  # Manhattan distance
SIDE_STEPS = ((0, -1), (-1, 0), (1, 0), (0, 1))


class PublishedRobot(mesa.Agent):
    """One robot of the published study. Cells are (x, y)."""

    def __init__(self, model: Any, pos: Any) -> None:
        super().__init__(model)
        self.pos = pos
        self.weights = np.ones((WIDTH, HEIGHT), dtype=np.int64)  # its cost of each cell
        self.search_weights = self.weights.copy()  # those of its last step, which its searches use
        self.goal = None
        self.queue: List[Any] = []
        self.path: List[Any] = []  # from its place before its last step
        self.task_steps: List[Any] = []  # number of steps on the way, for each finished task
        self.steps_on_way = self.distance = self.idle = 0
        self.costs: Dict[Any, Any] = {}  # of ways, by their ends, until a weight changes

    def step(self) -> None:
        """Sample, or move one cell, or stand idle."""
        if self.goal is None and self.queue:
            self.goal = self.queue.pop(0)
            self.path = greedy_path(self.search_weights, self.pos, self.goal)
            self.steps_on_way = 0
        if self.goal is not None and self.pos == self.goal:
            self._sample()
        elif self.goal is not None:
            self._move()
        if self.goal is None:
            self.idle += 1

    def _sample(self) -> None:
        self.goal, self.path = None, []
        self.task_steps.append(self.steps_on_way)
        self.model.sampled(self.pos)

    def _move(self) -> None:
        self.steps_on_way += 1
        self.distance += 1
        self.search_weights = self.weights.copy()
        self.costs.clear()
        self.path = greedy_path(self.search_weights, self.pos, self.goal)
        ahead = self.path[1]
        others = [robot for robot in self.model.robots if robot is not self]
        taken = [robot.pos for robot in others]
        if ahead in taken:
            self._step_aside(taken, [cell for cell in self._beside() if cell not in taken])
        elif any(robot.path[1:2] == [self.pos] for robot in others):
            self._step_aside(taken, self._beside())
        else:
            self.pos = ahead

    def _beside(self) -> Any:
        cells = [(self.pos[0] + dx, self.pos[1] + dy) for dx, dy in SIDE_STEPS]
        return [cell for cell in cells if 0 <= cell[0] < WIDTH and 0 <= cell[1] < HEIGHT]

    def _step_aside(self, taken: Any, cells: Any) -> None:
        """Move to a random one of the cells, drawn anew until it is not taken; stay if all are taken."""
        while any(cell not in taken for cell in cells):
            cell = cells[self.model.chance.randrange(len(cells))]
            if cell not in taken:
                self.pos = cell
                return

    def way_cost(self, start: Any, goal: Any) -> Any:
        """Return the weight of all cells of the path between two cells."""
        if (start, goal) not in self.costs:
            path = np.array(greedy_path(self.search_weights, start, goal))
            self.costs[start, goal] = int(self.weights[path[:, 0], path[:, 1]].sum())
        return self.costs[start, goal]

    def cheapest(self, task: Any) -> Any:
        """Return (least cost of the queue with the task, the position of the task for it)."""
        if not self.queue:
            return self.way_cost(self.pos, task), 0
        first = self.way_cost(self.pos, task)
        queues = [[*self.queue[:i], task, *self.queue[i:]] for i in range(len(self.queue) + 1)]
        costs = [first + sum(self.way_cost(a, b) for a, b in zip(queue, queue[1:])) for queue in queues]
        return min(costs), costs.index(min(costs))


class PublishedModel(mesa.Model):
    """One trial of the published study.

    :param truth: kPa, shape (110, 162), row 0 in the south. :param allocation, sampling: as in TrialConfig, but no
        grid.
    :param trial: its number, from 1, which is also the seed.
    """

    def __init__(self, truth: Any, allocation: Any, sampling: Any, trial: Any, robots: int = 3,
                 steps: int = 100) -> None:
        super().__init__(seed=trial)
        self.truth = truth
        self.auction = Allocation(allocation) is Allocation.AUCTION
        self.dynamic = Sampling(sampling) is Sampling.DYNAMIC
        self.max_steps = steps
        self.chance = random.Random(trial)
        self.values: Dict[Any, Any] = {}  # by cell
        self.estimate: Any = None
        self.given = set()  # cells that have had a task
        self._kriging: Any = Kriging(Grid(HEIGHT, WIDTH, 1.0), fit_by_pykrige)
        self._labels = field_clusters()
        self._used: Set[Any] = set()
        self._turn = 0
        self._reported = (0, 0)
        self.robots = [PublishedRobot(self, cell) for cell in _starts(random.Random(trial), robots)]
        for robot in self.robots:
            robot.queue.append(robot.pos)
            self.given.add(robot.pos)

    def step(self) -> None:
        """Simulate one step. Distance and idle time are reported as they were before the last step."""
        for robot in self.robots:
            near = _cells_near(robot.pos)
            for other in self.robots:
                if other is not robot:
                    other.weights[near] = CROWDED_WEIGHT
                    other.costs.clear()
        self._reported = (sum(robot.distance for robot in self.robots), sum(robot.idle for robot in self.robots))
        self.running = self.steps < self.max_steps
        self.agents.do('step')

    def figures(self) -> Any:
        """Return the figures that the published results have for a trial, as a mapping.

        rmse [kPa] and variance [kPa^2] of the last map; samples: number of different sampled cells; distance [cells],
        idle [steps, including the step of each sample] and waiting [steps, always 0] of all robots, without the last
        step; task_time [steps on the way]: the mean of the robots' means, in which first samples count as 0.
        """
        means = [np.mean(robot.task_steps) if robot.task_steps else math.nan for robot in self.robots]
        distance, idle = self._reported
        return {'rmse': math.nan if self.estimate is None else self.estimate.rmse,
                'variance': math.nan if self.estimate is None else self.estimate.mean_variance,
                'samples': len(self.values), 'distance': distance, 'idle': idle, 'waiting': 0,
                'task_time': float(np.mean(means))}

    def sampled(self, cell: Any) -> None:
        """Note a sample at a cell (x, y); make the map and new tasks, and assign them."""
        self.values[cell] = self.truth[cell[1], cell[0]]
        if len(self.values) < max(len(self.robots), MIN_SAMPLES):
            return
        cells = sorted(self.values)
        values = np.array([self.values[c] for c in cells], dtype=np.float32)
        self.estimate = self._kriging.estimate(np.array(cells) + 0.5, values, self.truth)
        for task in self._dynamic_tasks() if self.dynamic else self._random_tasks():
            self._allocate(task)

    def _random_tasks(self) -> Any:
        return [self._random_cell() for _ in self.robots]

    def _random_cell(self) -> Any:
        cell = self.chance.randrange(0, WIDTH), self.chance.randrange(0, HEIGHT)
        if cell in self.given:
            cell = self.chance.choice([(x, y) for x in range(WIDTH) for y in range(HEIGHT) if (x, y) not in self.given])
        return cell

    def _dynamic_tasks(self) -> Any:
        variance = self.estimate.variance
        mean = np.bincount(self._labels.T.ravel(), weights=variance.T.ravel()) / np.bincount(self._labels.ravel())
        chosen = [label for label in np.argsort(-mean, kind='stable') if label not in self._used][:2 * len(self.robots)]
        begun = {self._labels[y, x] for x, y in self.given}
        self._used.update(chosen)
        tasks = []
        for label in sorted(set(chosen) - begun):
            masked = np.where(self._labels == label, variance, -np.inf)
            x, y = np.unravel_index(np.argmax(masked.T), (WIDTH, HEIGHT))  # ties: the western cell, then the southern
            tasks.append((int(x), int(y)))
        return tasks

    def _allocate(self, task: Any) -> None:
        if self.auction:
            bids = [robot.cheapest(task) for robot in self.robots]
            winner = min(range(len(bids)), key=lambda index: bids[index][0])
            position = bids[winner][1]
        else:
            winner, self._turn = self._turn, (self._turn + 1) % len(self.robots)
            position = self.robots[winner].cheapest(task)[1]
        if task not in self.given:
            self.robots[winner].queue.insert(position, task)
            self.given.add(task)


def fit_by_pykrige(points: np.ndarray, values: np.ndarray, extent: float) -> Variogram:
    """Return the Variogram that PyKrige fits to values at points; see variogram.fit."""
    if np.ptp(values) ** 2 < np.finfo(np.float64).tiny:
        return Variogram(0.0, extent, 0.0)
    from pykrige.ok import OrdinaryKriging  # takes 0.9 s to import
    fitted = OrdinaryKriging(points[:, 0], points[:, 1], values, variogram_model='gaussian')
    return Variogram(*map(float, fitted.variogram_model_parameters))


def _starts(chance: Any, count: int) -> Any:
    """Return different cells (x, y), drawn as in the published program: never in the first row or column.

    After each robot it draws three numbers for a colour.
    """
    starts: List[Any] = []
    while len(starts) < count:
        cell = chance.randrange(1, WIDTH), chance.randrange(1, HEIGHT)
        if cell not in starts:
            starts.append(cell)
            for _ in range(3):
                chance.randint(0, 255)
    return starts


def _cells_near(cell: Any) -> Any:
    """Return the index arrays (x, y) of the cells within CROWDED_RADIUS."""
    reach = range(-CROWDED_RADIUS, CROWDED_RADIUS + 1)
    cells = [(cell[0] + dx, cell[1] + dy) for dx in reach for dy in reach if abs(dx) + abs(dy) <= CROWDED_RADIUS]
    return tuple(np.array([c for c in cells if 0 <= c[0] < WIDTH and 0 <= c[1] < HEIGHT]).T)


def run_published_trial(truth: Any, allocation: Any, sampling: Any, trial: Any, steps: int = 100) -> Any:
    """Return the figures of one trial; the arguments are those of PublishedModel."""
    model = PublishedModel(truth, allocation, sampling, trial, steps=steps)
    while model.running:
        model.step()
    return model.figures()


NEIGHBOURS = ((-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1))  # (x, y), in the order of search


def greedy_path(weights: Any, start: Any, goal: Any) -> Any:
    """Return the cells (x, y) from start to goal, both included.

    :param weights: array of shape (width, height), the weight of each cell. The estimate of a cell is its weight plus
        its Manhattan distance from the goal. The search goes on from the open cell with the least estimate: from the
        youngest one if no older one has a smaller estimate, otherwise from the oldest of those with the least estimate.
        If the youngest one is passed over, it is forgotten.
    """
    width, height = weights.shape
    goal = tuple(goal)
    estimates, parents, closed = {}, {}, set()
    open_cells, cell = [], tuple(start)
    here_estimate = 0
    while cell != goal:
        for dx, dy in NEIGHBOURS:
            x, y = near = cell[0] + dx, cell[1] + dy
            if not (0 <= x < width and 0 <= y < height) or near in closed:
                continue
            if near not in estimates:
                estimates[near] = int(weights[x, y]) + abs(x - goal[0]) + abs(y - goal[1])
                parents[near] = cell
                open_cells.append(near)
            elif estimates[near] < here_estimate:
                parents[near] = cell
        cell = _choose(open_cells, estimates)
        here_estimate = estimates.pop(cell)
        closed.add(cell)
    return _trace(parents, cell, tuple(start))


def _choose(open_cells: Any, estimates: Any) -> Any:
    """Remove and return the open cell to go on from."""
    youngest = open_cells.pop()
    if not open_cells:
        return youngest
    index = min(range(len(open_cells)), key=lambda i: estimates[open_cells[i]])
    if estimates[open_cells[index]] >= estimates[youngest]:
        return youngest
    estimates.pop(youngest)
    return open_cells.pop(index)


def _trace(parents: Any, cell: Any, start: Any) -> Any:
    path = [cell]
    while cell != start:
        cell = parents[cell]
        path.append(cell)
    return path[::-1]
