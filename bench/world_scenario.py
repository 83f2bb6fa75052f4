"""The world that bench/world measures: a map of blocks, stations in its streets, scenarios with one part or all."""
import random

import lane_net
import numpy as np

from move_base_abstract.config.robot_table import OWN_NAMES
from move_base_abstract.maps.occupancy import OccupancyMap
from move_base_abstract.motion.geometry import Pose2D

CELLS, RESOLUTION = 1000, 0.1  # number of cells of a side; m
RADIUS = 0.4  # m, of the robots
_BLOCK, _STREET = 60, 40  # cells
_STATIONS = 40
_CROSSINGS = [((_BLOCK + _STREET) * column * RESOLUTION, (_BLOCK + _STREET) * row * RESOLUTION)
              for row in range(2, 9, 2) for column in range(2, 9, 2)]  # m, south-west corners
#: settings of robots
_SETTINGS = {
    'durations': {'duration_distribution': 'gamma', 'duration_cv': 0.3, 'goal_overhead': 1.0,
                  'failure_by_length': [[0.0, 0.01]]},
    'routes': {'routes': 'grid', 'use_map': True, 'robot_radius': RADIUS},
    'failures': {'failure_kind': 'stall', 'failures_per_hour': 6.0, 'repair_time': 20.0},
    'battery': {'battery_capacity': 1000.0, 'battery_thresholds': [0.5, 0.2]},
}
#: keys of the world; of robots that wait for each other in a circle, one gives up its goal
_WORLD = {
    'zones': {'deadlock': 'abort', 'zones': [
        {'name': f'crossing_{number}', 'rectangle': [x, y, x + _STREET * RESOLUTION, y + _STREET * RESOLUTION],
         'capacity': 4} for number, (x, y) in enumerate(_CROSSINGS)]},
    'places': {'places': [{'name': 'anywhere', 'duration': 5.0, 'reach': 1000.0}]},
}
PARTS = ('none', *(part for part, keys in _SETTINGS.items() if set(keys) <= set(OWN_NAMES)), *_WORLD, 'all')
#: calibrated robots, without and with encounters; their motion differs, so they are not in "all"
CALIBRATED = ('calibrated', 'encounters')
#: all parts, and lanes instead of ways around what the map shows
LANES = 'lanes and all'
_GAP = 2.5  # m, between nodes of the net


def make_map(cells=CELLS):
    """Return a square map of ``cells`` x ``cells`` cells, with blocks of 6 m and streets of 4 m."""
    grid = np.zeros((cells, cells), np.int8)
    period = _BLOCK + _STREET
    for south in range(_STREET, cells - _BLOCK, period):
        for west in range(_STREET, cells - _BLOCK, period):
            grid[south:south + _BLOCK, west:west + _BLOCK] = 100
    return OccupancyMap(grid, RESOLUTION, Pose2D())


def free_places(occupancy, count, chance):
    """Return ``count`` places [m] in the streets, 1 m from all blocks, and not on a crossing that is a zone."""
    reach, found = round(1.0 / RESOLUTION), []
    cells = occupancy.cells
    while len(found) < count:
        row, column = (chance.randrange(reach, side - reach) for side in cells.shape)
        x, y = RESOLUTION * (column + 0.5), RESOLUTION * (row + 0.5)
        is_crossing = any(west - 1.0 < x < west + 5.0 and south - 1.0 < y < south + 5.0 for west, south in _CROSSINGS)
        if not is_crossing and not cells[row - reach:row + reach, column - reach:column + reach].any():
            found.append((x, y))
    return found


_MAP = make_map()
#: the places [m] where robots start and to which they go
STATIONS = free_places(_MAP, _STATIONS, random.Random(7))


def make(robots, part):
    """Return (scenario of ``robots`` robots with the part, map); the map is None if the part does not need it."""
    chosen = PARTS[1:-1] if part == 'all' else (part,)
    scenario = {'seed': 1, 'defaults': {'max_speed': 2.0, 'acceleration': 1.0}, 'robots': [
        {'name': f'robot_{index}', 'start_x': x, 'start_y': y}
        for index, (x, y) in enumerate(STATIONS[index % _STATIONS] for index in range(robots))]}
    for one in chosen:
        scenario['defaults'].update(_SETTINGS.get(one, {}))
        scenario.update(_WORLD.get(one, {}))
    if part in CALIBRATED:
        scenario['defaults'] = {'calibration': 'move_base_dwa_stage'}
        scenario['encounters'] = 'calibrated' if part == 'encounters' else 'none'
    return scenario, _MAP if 'routes' in chosen else None


def make_lanes(robots, folder):
    """Return (scenario of ``robots`` robots on a net of 1,000 nodes with all other parts, places [m] to which they go).

    The net is written into ``folder``.
    """
    path, places = lane_net.write(folder, _GAP, capacity=2)
    stations = random.Random(7).sample(places, robots)
    scenario, _ = make(0, 'all')
    scenario['defaults'].update({'routes': 'lanes', 'lanes': path, 'use_map': False})
    scenario['robots'] = [{'name': f'robot_{index}', 'start_x': x, 'start_y': y}
                          for index, (x, y) in enumerate(stations)]
    return scenario, stations
