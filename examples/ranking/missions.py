#!/usr/bin/env python3
"""Writes a mission: starts of robots and tasks at free places of a map, drawn by a seed.

    .ws/bin/python3 examples/ranking/missions.py MAP.yaml SEED ROBOTS FOLDER

FOLDER/robots.yaml has the robots as a scenario does, and FOLDER/tasks.yaml the tasks for the coordinator.
"""
import os
import random
import sys
from math import hypot, pi

import yaml
from scipy.ndimage import distance_transform_edt, label

from move_base_abstract.maps.map_files import load_map, read_description

CLEARANCE = 1.0  # m, minimum from a place to the nearest cell that is not free
APART = 3.0  # m, minimum between the starts of robots
ROBOTS, TASKS = 3, 12


def free_places(occupancy):
    """Return the (x, y) [m] of all cells with clearance in the largest connected part of the map."""
    clear = distance_transform_edt(occupancy.cells == 0) * occupancy.resolution > CLEARANCE
    parts, count = label(clear)
    largest = max(range(1, count + 1), key=lambda part: (parts == part).sum())
    return [occupancy.from_cells(column + 0.5, row + 0.5) for row, column in zip(*(parts == largest).nonzero())]


def make_mission(places, seed):
    """Return {'starts': [[x, y, yaw]], 'tasks': [[x, y, yaw]]} (m, m, rad) at some of ``places``."""
    chance = random.Random('mission {}'.format(seed))

    def place(others=()):
        while True:
            x, y = chance.choice(places)
            if all(hypot(x - other[0], y - other[1]) >= APART for other in others):
                return [round(float(x), 3), round(float(y), 3), round(chance.uniform(-pi, pi), 3)]
    starts = []
    for _ in range(ROBOTS):
        starts.append(place(starts))
    return {'starts': starts, 'tasks': [place() for _ in range(TASKS)]}


def scenario_robots(starts):
    """Return the ``robots`` of a scenario in which they stand at ``starts``."""
    return [{'name': 'robot_{}'.format(number), 'start_x': x, 'start_y': y, 'start_yaw': yaw}
            for number, (x, y, yaw) in enumerate(starts)]


def main(path, seed, robots, folder):
    """Write one mission."""
    mission = make_mission(free_places(load_map(read_description(path))), int(seed))
    os.makedirs(folder, exist_ok=True)
    for name, content in (('robots', scenario_robots(mission['starts'][:int(robots)])), ('tasks', mission['tasks'])):
        with open(os.path.join(folder, name + '.yaml'), 'x', encoding='utf-8') as file:
            yaml.safe_dump({name: content}, file)


if __name__ == '__main__':
    main(*sys.argv[1:])
