"""Sequential auction: each robot bids the length that a target adds to its tour, and the lowest bid wins the target.

robot_0: 4 targets, 13.1 m
robot_1: 3 targets, 12.0 m
robot_2: 5 targets, 11.5 m
all visited after 12.1 s
"""
import random

from move_base_abstract import Environment, make_scenario


def length(start, tour):
    """Return the length of a tour from ``start`` [m]."""
    points = [start, *tour]
    return sum(((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2) ** 0.5 for a, b in zip(points, points[1:]))


def best_insertion(start, tour, target):
    """Return (added length [m], new tour) for the cheapest position of ``target`` in ``tour``."""
    tours = [[*tour[:k], target, *tour[k:]] for k in range(len(tour) + 1)]
    return min((length(start, one) - length(start, tour), one) for one in tours)


def drive(robot, tour):
    """Visit all targets of a tour."""
    for x, y in tour:
        yield robot.go(x, y)


env = Environment(make_scenario({'robots': [{'name': 'robot', 'count': 3, 'step_x': 8.0, 'max_speed': 1.0}]}))
chance = random.Random(1)
tours = {robot.name: [] for robot in env.robots}
for target in [(chance.uniform(0, 20), chance.uniform(0, 10)) for _ in range(12)]:
    bids = []
    for robot in env.robots:
        cost, with_target = best_insertion((robot.pose.x, robot.pose.y), tours[robot.name], target)
        bids.append((cost, robot.name, with_target))
    _, winner, tours[winner] = min(bids)
for robot in env.robots:
    env.process(drive(robot, tours[robot.name]))
env.run()
for robot in env.robots:
    print('{}: {} targets, {:.1f} m'.format(robot.name, len(tours[robot.name]), robot.distance))
print('all visited after {:.1f} s'.format(env.now - 1.0))  # time begins at 1 s
