"""The folder in which a plan is driven: a map for map_server, and a scenario with the robots at their starts."""
from __future__ import annotations

import math
import os
from typing import Any, List, NamedTuple, Tuple

import yaml

from move_base_abstract.common import own_files
from move_base_abstract.common.arguments import check_path
from move_base_abstract.common.bounded_yaml import load_yaml_file
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import shown
from move_base_abstract.common.units import seconds_to_ns
from move_base_abstract.maps.map_files import load_map, read_description, write_map
from move_base_abstract.scenario import Scenario, make_scenario, read_scenario

from .movingai import Cell, Problem, is_free

FOLDER = own_files.FolderKind('MAPF scenario', ['scenario.yaml', 'map.yaml', 'map.pgm'])
_RADIUS = 0.35  # cells


class Grid(NamedTuple):
    """Cells with sides of ``size`` [m], ``blocked`` as from read_map(); the map's south-western corner is (0, 0)."""

    blocked: Any
    size: float

    def place(self, cell: Cell) -> Tuple[float, float]:
        """Return the middle of a cell (x, y) [m]."""
        column, row = cell
        return (column + 0.5) * self.size, (self.blocked.shape[0] - row - 0.5) * self.size

    def pose(self, cell: Cell, towards: Cell) -> Tuple[float, float, float]:
        """Return the goal (x, y, yaw) [m, rad] of a move to ``cell`` from ``towards``; the yaw is that of the move."""
        return (*self.place(cell), math.atan2(towards[1] - cell[1], cell[0] - towards[0]))


class Site(NamedTuple):
    """The content of a folder: its Scenario, its Grid, and the duration of a step [ns]."""

    scenario: Scenario
    grid: Grid
    step_ns: int


def write_folder(folder: str, grid: Grid, problems: List[Problem], seconds: float, words: str) -> None:
    """Write the map and the scenario of robots agent_0, agent_1, ..., which take ``seconds`` from cell to cell.

    ``words``: the command, for a comment in the files.

    :raises ConfigurationError: if other files are in the folder, a problem is not on free cells, or the robots'
        numbers are out of their ranges.
    """
    for number, problem in enumerate(problems):
        for what, cell in zip(problem._fields, problem):
            if not is_free(grid.blocked, cell):
                raise ConfigurationError('problem {}: {}: got column {}, row {}; allowed: a free cell of the map'
                                         .format(number, what, *cell))
    head = '# Made by: {}\n'.format(words)
    robots = []
    for number, problem in enumerate(problems):
        x, y = grid.place(problem.start)
        robots.append({'name': 'agent_{}'.format(number), 'start_x': x, 'start_y': y})
    defaults = {'max_speed': grid.size / seconds, 'robot_radius': _RADIUS * grid.size, 'log_motion': True}
    try:
        make_scenario({'defaults': defaults, 'robots': robots})
    except ConfigurationError as error:
        raise ConfigurationError('cells of {} m, steps of {} s: {}'.format(grid.size, seconds, error)) from None
    marker = FOLDER.make(folder)
    try:
        write_map(folder, 'map', grid.blocked, grid.size, head=head)
        with own_files.whole_file(os.path.join(folder, 'scenario.yaml'), encoding='utf-8') as stream:
            stream.write(head + yaml.safe_dump({'defaults': defaults, 'robots': robots}, sort_keys=False,
                                               default_flow_style=None, width=120))
    finally:
        os.close(marker)


def read_folder(folder: str, seed: Any = None) -> Site:
    """Return the :class:`Site` in a folder; ``seed`` replaces the scenario's, unless it is None.

    :raises ConfigurationError: if a file cannot be used, or the robots have different speeds.
    """
    check_path(folder, 'folder')
    path = os.path.join(folder, 'scenario.yaml')
    scenario = read_scenario(path, None if seed is None else {'seed': seed})
    description = read_description(os.path.join(folder, 'map.yaml'))
    occupancy = load_map(description)
    if (occupancy.origin.x, occupancy.origin.y, occupancy.origin.yaw) != (0.0, 0.0, 0.0):
        raise ConfigurationError('{}: origin: got {}; allowed: [0, 0, 0]'.format(
            os.path.join(folder, 'map.yaml'), shown(load_yaml_file(os.path.join(folder, 'map.yaml')).get('origin'))))
    speeds = {spec.settings.limits.max_speed for spec in scenario.robots}
    if len(speeds) != 1:
        raise ConfigurationError('{}: max_speed: got {} different ones; allowed: one, because a step takes the same '
                                 'time for all robots'.format(path, len(speeds)))
    grid = Grid(occupancy.cells[::-1] > 0, occupancy.resolution)
    return Site(scenario, grid, seconds_to_ns(grid.size / speeds.pop()))
