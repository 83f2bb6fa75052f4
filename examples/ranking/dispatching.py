"""Decides which robot drives to which task next: five coordinators in one class without ROS.

The ROS node and the trials in plain Python use the same class. Costs are straight lines at a nominal speed, since these
coordinators know neither the map nor the simulator.
"""
from math import hypot

from scipy.optimize import linear_sum_assignment

ATTEMPTS = 2  # for a task, before it counts as failed


class Robot:
    """What a coordinator knows about a robot: its last goal [m], its task, when it should be free [s], and its tour."""

    def __init__(self, place):
        self.place = place
        self.task = None
        self.free_at = 0.0
        self.tour = []


class Dispatcher:
    """Gives tasks to idle robots by one of :data:`POLICIES`.

    ``starts``: (x, y) of each robot; ``tasks``: (x, y) of each task [m]; ``speed``: nominal [m/s].
    """

    def __init__(self, policy, starts, tasks, speed=1.0):
        self.robots = [Robot(start) for start in starts]
        self.tasks = tasks
        self.open = list(range(len(tasks)))  # numbers of tasks that nobody has begun, in order
        self.done, self.failed = [], []
        self.speed = speed
        self._attempts = [0] * len(tasks)
        self._choose = POLICIES[policy]

    def begin(self, now):
        """Return [(robot's number, task's number)] for all tasks that begin at ``now`` [s]."""
        idle = [number for number, robot in enumerate(self.robots) if robot.task is None]
        pairs = self._choose(self, idle, now) if idle and self.open else []
        for number, task in pairs:
            robot = self.robots[number]
            robot.free_at = now + self.seconds(robot.place, task)
            robot.task, robot.place = task, self.tasks[task]
            self.open.remove(task)
        return pairs

    def ended(self, number, succeeded):
        """Note that a robot's task has ended; a failed one goes to the end of the open tasks until its last attempt."""
        robot = self.robots[number]
        task, robot.task = robot.task, None
        self._attempts[task] += 1
        if succeeded:
            self.done.append(task)
        elif self._attempts[task] >= ATTEMPTS:
            self.failed.append(task)
        else:
            self.open.append(task)
            robot.tour.append(task)

    @property
    def over(self):
        """Whether no task is open or under way."""
        return len(self.done) + len(self.failed) == len(self.tasks)

    def seconds(self, place, task):
        """Return the time from ``place`` to a task in a straight line [s]."""
        x, y = self.tasks[task]
        return hypot(x - place[0], y - place[1]) / self.speed


def fixed_order(dispatcher, idle, _now):
    """Give the tasks out in the order of their numbers."""
    return list(zip(idle, dispatcher.open))


def nearest_first(dispatcher, idle, _now):
    """Give each idle robot the nearest open task."""
    return one_by_one(dispatcher, idle, 1.0)


def farthest_first(dispatcher, idle, _now):
    """Give each idle robot the farthest open task."""
    return one_by_one(dispatcher, idle, -1.0)


def one_by_one(dispatcher, idle, sign):
    """Give each idle robot in turn the open task with the smallest ``sign`` times seconds."""
    left, pairs = list(dispatcher.open), []
    for number in idle[:len(left)]:
        place = dispatcher.robots[number].place
        best = min(left, key=lambda task: (sign * dispatcher.seconds(place, task), task))
        left.remove(best)
        pairs.append((number, best))
    return pairs


def auction(dispatcher, idle, _now):
    """Sell all tasks at the start, and give each idle robot the next task of its tour."""
    if not any(robot.tour for robot in dispatcher.robots) and not dispatcher.done and not dispatcher.failed:
        sell(dispatcher)
    pairs = []
    for number in idle:
        tour = dispatcher.robots[number].tour
        if tour:
            pairs.append((number, tour.pop(0)))
    return pairs


def sell(dispatcher):
    """Put every open task into a tour: in each round, the task and robot with the shortest resulting tour."""
    left = list(dispatcher.open)
    while left:
        bids = []
        for number, robot in enumerate(dispatcher.robots):
            for task in left:
                tours = [[*robot.tour[:at], task, *robot.tour[at:]] for at in range(len(robot.tour) + 1)]
                cost, tour = min((length(dispatcher, robot.place, one), one) for one in tours)
                bids.append((cost, number, task, tour))
        _, number, task, tour = min(bids)
        dispatcher.robots[number].tour = tour
        left.remove(task)


def length(dispatcher, place, tour):
    """Return the time that a tour from ``place`` takes in straight lines [s]."""
    total = 0.0
    for task in tour:
        total += dispatcher.seconds(place, task)
        place = dispatcher.tasks[task]
    return total


def batch(dispatcher, idle, now):
    """Assign open tasks to all robots at the least sum of seconds; begin those of idle robots.

    A busy robot counts from the time when it should be free.
    """
    costs = [[max(0.0, robot.free_at - now) + dispatcher.seconds(robot.place, task) for task in dispatcher.open]
             for robot in dispatcher.robots]
    rows, columns = linear_sum_assignment(costs)
    return [(int(row), dispatcher.open[column]) for row, column in zip(rows, columns) if row in idle]


POLICIES = {'fixed_order': fixed_order, 'nearest_first': nearest_first, 'farthest_first': farthest_first,
            'auction': auction, 'batch': batch}
