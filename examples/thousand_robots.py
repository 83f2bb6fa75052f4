#!/usr/bin/env python3
"""A thousand robots drive for an hour in plain Python without ROS, each to one random place after the other.

    source .ws/setup.sh && python3 examples/thousand_robots.py [ROBOTS [HOURS]]

It prints the number of goals that ended, the distance that the robots drove, and the speed relative to real time.
"""
import random
import sys
import time

from move_base_abstract.fleet import Fleet
from move_base_abstract.scenario import make_scenario

FIELD = 300.0  # m, square
SEED = 1


def main(robots=1000, hours=1.0):
    """Simulate ``robots`` robots for ``hours`` hours and print the numbers of the run."""
    scenario = make_scenario({'seed': SEED, 'defaults': {'max_speed': 2.0, 'acceleration': 1.0},
                              'robots': [{'name': 'robot', 'count': robots, 'step_x': FIELD / robots}]})
    # One generator per robot, so that one more robot does not change what the others do.
    chance = {spec.name: random.Random('{}/{}'.format(SEED, spec.name)) for spec in scenario.robots}

    def send_next(name):
        fleet.robot(name).send(chance[name].uniform(0.0, FIELD), chance[name].uniform(0.0, FIELD))

    def on_end(name, _goal_id, _state, _text, _now_ns):
        send_next(name)

    fleet = Fleet(scenario, on_end=on_end)
    for name in fleet.names:
        send_next(name)
    begin = time.perf_counter()
    fleet.run_for(3600.0 * hours)
    wall = time.perf_counter() - begin
    goals = sum(1 for entry in fleet.trace if entry.kind == 'ended')
    distance = sum(robot.distance for robot in fleet.robots)
    print('{} robots, {:g} h: {} goals, {:.1f} km, {:.2f} s of wall time, {:.0f}x real time, {:.0f} goals/s'.format(
        robots, hours, goals, distance / 1000.0, wall, 3600.0 * hours / wall, goals / wall))


if __name__ == '__main__':
    main(*(kind(word) for kind, word in zip((int, float), sys.argv[1:])))
