"""The published Mesa study by its own rules, to compare with its published results. Everything is in cells and steps.

A cell is 2 m, a step 1 s, the grid 162 x 110 cells. What differs from the study's rules in mission/coordinator.py, all
of it as in the published program (TAROS 2022):

- A robot moves to a neighbouring cell per step, in eight directions, along a path that is searched anew at each step
  (greedy_path.py). Cells within 2 steps of where another robot ever was weigh 2 for it, others 1. Where its next cell
  is taken, or it stands on the next cell of another robot's path, it moves to a free cell beside it by chance instead:
  drawn from the free ones in the first case, from all of them until it is free in the second.
- It samples in the step after its arrival, and sets off again in the step after that if it has a task.
- Whenever there are at least as many samples as robots, each sample makes new tasks. Dynamic: in the six clusters with
  the highest mean variance of those not used, in the order of the clusters' numbers; one that holds a robot's start is
  used up without a task.
- The cost of a queue leaves out the way to its first task where that is not the new one: it is the weight of all cells
  on the path from the robot to the new task, plus that of the paths between the queue's tasks in order, wherever the
  new one is. Both allocations insert a task where this is least. The lowest cost wins the auction.
- A random task is drawn from all cells; where that cell has had a task, it is drawn once more from a list of those that
  have had none, column by column. Of two equal tasks of one round the second is dropped.
- PyKrige fits the variograms. From few samples its fit is not well-posed: the last digits decide it, and with them the
  processor, whose BLAS kernel it uses.
- Chance is two generators of Python's own, both seeded by the trial's number: starts, and tasks and side steps.

The figures (see figures()) are those that the program wrote, with what it counts.
"""

import math
import random

import mesa
import numpy as np

from ..config import Allocation, Sampling
from ..ground_truth.grid import Grid
from ..interpolation.kriging import MIN_SAMPLES, Kriging
from ..interpolation.variogram import Variogram
from ..mission.coarse_cells import field_clusters
from .greedy_path import greedy_path

WIDTH, HEIGHT = 162, 110  # cells
CROWDED_WEIGHT = 2
CROWDED_RADIUS = 2  # Manhattan distance
SIDE_STEPS = ((0, -1), (-1, 0), (1, 0), (0, 1))


class PublishedRobot(mesa.Agent):
    """One robot of the published study. Cells are (x, y)."""

    def __init__(self, model, pos):
        super().__init__(model)
        self.pos = pos
        self.weights = np.ones((WIDTH, HEIGHT), dtype=np.int64)  # what crossing a cell costs it
        self.search_weights = self.weights.copy()  # those of its last step: its searches know no others
        self.goal = None
        self.queue = []
        self.path = []  # from where it was before its last step
        self.task_steps = []  # steps on the way, per finished task
        self.steps_on_way = self.distance = self.idle = 0
        self.costs = {}  # of ways, by their ends, as long as no weight changes

    def step(self):
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

    def _sample(self):
        self.goal, self.path = None, []
        self.task_steps.append(self.steps_on_way)
        self.model.sampled(self.pos)

    def _move(self):
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

    def _beside(self):
        cells = [(self.pos[0] + dx, self.pos[1] + dy) for dx, dy in SIDE_STEPS]
        return [cell for cell in cells if 0 <= cell[0] < WIDTH and 0 <= cell[1] < HEIGHT]

    def _step_aside(self, taken, cells):
        """Move to one of the cells that is not taken, drawn anew until it is one; stay if there is none."""
        while any(cell not in taken for cell in cells):
            cell = cells[self.model.chance.randrange(len(cells))]
            if cell not in taken:
                self.pos = cell
                return

    def way_cost(self, start, goal):
        """Return the weight of all cells of the path between two cells."""
        if (start, goal) not in self.costs:
            path = np.array(greedy_path(self.search_weights, start, goal))
            self.costs[start, goal] = int(self.weights[path[:, 0], path[:, 1]].sum())
        return self.costs[start, goal]

    def cheapest(self, task):
        """Return (cost of the queue with the task where that is least, the position)."""
        if not self.queue:
            return self.way_cost(self.pos, task), 0
        first = self.way_cost(self.pos, task)
        queues = [[*self.queue[:i], task, *self.queue[i:]] for i in range(len(self.queue) + 1)]
        costs = [first + sum(self.way_cost(a, b) for a, b in zip(queue, queue[1:])) for queue in queues]
        return min(costs), costs.index(min(costs))


class PublishedModel(mesa.Model):
    """One trial of the published study.

    :param truth: kPa, shape (110, 162), row 0 in the south. :param allocation, sampling: as in TrialConfig, no grid.
    :param trial: its number, from 1; it is the seed.
    """

    def __init__(self, truth, allocation, sampling, trial, robots=3, steps=100):
        super().__init__(seed=trial)
        self.truth = truth
        self.auction = Allocation(allocation) is Allocation.AUCTION
        self.dynamic = Sampling(sampling) is Sampling.DYNAMIC
        self.max_steps = steps
        self.chance = random.Random(trial)
        self.values = {}  # by cell
        self.estimate = None
        self.given = set()  # cells that have had a task
        self._kriging = Kriging(Grid(HEIGHT, WIDTH, 1.0), fit_by_pykrige)
        self._labels = field_clusters()
        self._used = set()
        self._turn = 0
        self._reported = (0, 0)
        self.robots = [PublishedRobot(self, cell) for cell in _starts(random.Random(trial), robots)]
        for robot in self.robots:
            robot.queue.append(robot.pos)
            self.given.add(robot.pos)

    def step(self):
        """Simulate one step. Distance and idle time are reported as they were before the last one."""
        for robot in self.robots:
            near = _cells_near(robot.pos)
            for other in self.robots:
                if other is not robot:
                    other.weights[near] = CROWDED_WEIGHT
                    other.costs.clear()
        self._reported = (sum(robot.distance for robot in self.robots), sum(robot.idle for robot in self.robots))
        self.running = self.steps < self.max_steps
        self.agents.do('step')

    def figures(self):
        """Return what the published results hold of a trial.

        rmse [kPa] and variance [kPa^2] of the last map; samples: different cells sampled; distance [cells], idle
        [steps, the step of each sample included] and waiting [steps, always 0] of all robots but for the last step;
        task_time [steps on the way]: the mean of the robots' means, first samples included as 0.
        """
        means = [np.mean(robot.task_steps) if robot.task_steps else math.nan for robot in self.robots]
        distance, idle = self._reported
        return {'rmse': math.nan if self.estimate is None else self.estimate.rmse,
                'variance': math.nan if self.estimate is None else self.estimate.mean_variance,
                'samples': len(self.values), 'distance': distance, 'idle': idle, 'waiting': 0,
                'task_time': float(np.mean(means))}

    def sampled(self, cell):
        """Take note of a sample; make the map, new tasks, and hand them out."""
        self.values[cell] = self.truth[cell[1], cell[0]]
        if len(self.values) < max(len(self.robots), MIN_SAMPLES):
            return
        cells = sorted(self.values)
        values = np.array([self.values[c] for c in cells], dtype=np.float32)
        self.estimate = self._kriging.estimate(np.array(cells) + 0.5, values, self.truth)
        for task in self._dynamic_tasks() if self.dynamic else self._random_tasks():
            self._allocate(task)

    def _random_tasks(self):
        return [self._random_cell() for _ in self.robots]

    def _random_cell(self):
        cell = self.chance.randrange(0, WIDTH), self.chance.randrange(0, HEIGHT)
        if cell in self.given:
            cell = self.chance.choice([(x, y) for x in range(WIDTH) for y in range(HEIGHT) if (x, y) not in self.given])
        return cell

    def _dynamic_tasks(self):
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

    def _allocate(self, task):
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


def fit_by_pykrige(points, values, extent):
    """Return the Variogram that PyKrige fits to values at points; see variogram.fit."""
    if np.ptp(values) ** 2 < np.finfo(np.float64).tiny:
        return Variogram(0.0, extent, 0.0)
    from pykrige.ok import OrdinaryKriging  # takes 0.9 s to import
    fitted = OrdinaryKriging(points[:, 0], points[:, 1], values, variogram_model='gaussian')
    return Variogram(*map(float, fitted.variogram_model_parameters))


def _starts(chance, count):
    """Return different cells, drawn as the published program does: never in the first row or column.

    Between two robots it draws three numbers for a colour.
    """
    starts = []
    while len(starts) < count:
        cell = chance.randrange(1, WIDTH), chance.randrange(1, HEIGHT)
        if cell not in starts:
            starts.append(cell)
            for _ in range(3):
                chance.randint(0, 255)
    return starts


def _cells_near(cell):
    """Return the index arrays (x, y) of the cells within CROWDED_RADIUS."""
    reach = range(-CROWDED_RADIUS, CROWDED_RADIUS + 1)
    cells = [(cell[0] + dx, cell[1] + dy) for dx in reach for dy in reach if abs(dx) + abs(dy) <= CROWDED_RADIUS]
    return tuple(np.array([c for c in cells if 0 <= c[0] < WIDTH and 0 <= c[1] < HEIGHT]).T)


def run_published_trial(truth, allocation, sampling, trial, steps=100):
    """Return the figures of one trial; arguments as for PublishedModel."""
    model = PublishedModel(truth, allocation, sampling, trial, steps=steps)
    while model.running:
        model.step()
    return model.figures()
