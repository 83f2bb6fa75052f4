"""Robots carry goods in a warehouse made by ``scenario make``, in plain Python: from a bay to a station, for ever.

usage: warehouse.py SCENARIO.yaml [RUN.jsonl]     (RUN.jsonl is a log for ``replay``)
"""
import random
import sys

from move_base_abstract import Environment, read_scenario
from move_base_abstract.maps.map_files import load_map, read_description

MINUTES = 10
LOADING, UNLOADING = 8.0, 12.0  # s


def carry(env, robot, bays, stations, chance, delivered):
    """Fetch goods from a random bay, bring them to a random station, and begin again."""
    while True:
        for places, seconds in ((bays, LOADING), (stations, UNLOADING)):
            pose = chance.choice(places).pose
            while not (yield robot.go(pose.x, pose.y)).succeeded:
                yield env.timeout(5.0)
            yield env.timeout(seconds)
        delivered.append(robot.name)


def main(scenario_file, log=None):
    """Run for ten minutes of simulated time, print the deliveries, and write the log if it is named."""
    scenario = read_scenario(scenario_file, {'log_motion': True})
    chart = load_map(read_description(scenario_file.replace('scenario.yaml', 'map.yaml')))
    env = Environment(scenario, occupancy=chart)
    bays = [place for name, place in scenario.places.items() if name.startswith('bay')]
    stations = [place for name, place in scenario.places.items() if name.startswith('station')]
    delivered = []
    for robot in env.robots:
        env.process(carry(env, robot, bays, stations, random.Random(robot.name), delivered))
    env.run(until=60.0 * MINUTES)
    print('{} deliveries by {} robots in {} minutes'.format(len(delivered), len(env.robots), MINUTES))
    if log:
        env.fleet.write_log(log)


if __name__ == '__main__':
    main(*sys.argv[1:3])
