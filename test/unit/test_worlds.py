"""Stage's worlds, the maps and the scenarios say the same, and what ships with the package stands on free ground."""
import glob
import math
import os
import re
from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np
import pytest
import yaml

from move_base_abstract.common.map_images import MapMode
from move_base_abstract.maps.map_check import Ground
from move_base_abstract.maps.map_files import load_map, read_description, read_pixels
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import read_scenario

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..')
#: the scenario whose robots stand in the world of that name; stage.launch pairs them too (launch_files_test)
NEAR = 1e-5  # m: the side of a map's cell has 32 bits
SCENARIOS = {'farm_yard': 'scenario.yaml', 'field': 'soil_robots.yaml'}
CLEARANCE = 0.5  # m, around a robot's centre
DARKEST_FREE = 128  # Stage's polys_from_image_file draws what is at most 127, whatever the map's YAML says


@dataclass(frozen=True)
class Model:
    """One model of a world file: its kind and its properties, numbers as a list, texts as text."""

    kind: str
    properties: dict


def read_world(name):
    """Return the Models of worlds/NAME.world that are on a line of their own, in order."""
    with open(os.path.join(ROOT, 'worlds', name + '.world'), encoding='utf-8') as stream:
        lines = [line.partition('#')[0] for line in stream]
    found = [re.fullmatch(r'(\w+)\( (.*) \)\s*', line) for line in lines]
    return [Model(match.group(1), dict(properties(match.group(2)))) for match in found if match]


def properties(text):
    for key, value in re.findall(r'(\w+) ("[^"]*"|\[[^]]*\])', text):
        yield key, value[1:-1] if value[0] == '"' else [float(part) for part in value[1:-1].split()]


def path(*parts):
    return os.path.normpath(os.path.join(ROOT, *parts))


def read_map(name):
    return load_map(read_description(path('maps', name + '.yaml')))


def assert_free(grid, x, y, what):
    for angle in np.arange(0.0, 2.0 * math.pi, math.pi / 8):
        spot = x + CLEARANCE * math.cos(angle), y + CLEARANCE * math.sin(angle)
        assert grid.ground_at(*spot) is Ground.FREE, '{} at ({:g}, {:g}): {} at ({:.2f}, {:.2f})'.format(
            what, x, y, grid.ground_at(*spot).name, *spot)


def test_each_map_has_its_world_and_each_world_its_map():
    names = [sorted(os.path.splitext(os.path.basename(file))[0] for file in glob.glob(path(*pattern)))
             for pattern in (('maps', '*.yaml'), ('worlds', '*.world'))]
    assert names[0] == names[1] == sorted(SCENARIOS)


@pytest.mark.parametrize('name', SCENARIOS)
def test_the_floorplan_has_the_image_the_size_and_the_place_of_the_map(name):
    [floorplan] = [model for model in read_world(name) if model.kind == 'floorplan']
    description = read_description(path('maps', name + '.yaml'))
    assert path('worlds', floorplan.properties['bitmap']) == os.path.normpath(description.image)
    grid = read_map(name)
    middle = grid.origin.compose(Pose2D(grid.size[0] / 2, grid.size[1] / 2))
    x, y, z, degrees = floorplan.properties['pose']
    assert (x, y, z, degrees) == pytest.approx((middle.x, middle.y, 0.0, math.degrees(middle.yaw)), abs=NEAR)
    assert floorplan.properties['size'][:2] == pytest.approx(grid.size, abs=NEAR)


@pytest.mark.parametrize('name', SCENARIOS)
def test_what_stage_draws_of_the_image_reaches_all_its_edges(name):
    """Stage stretches the box around what it draws to the floorplan's size: that box has to be the whole image."""
    description = read_description(path('maps', name + '.yaml'))
    drawn = read_pixels(description.image)[:, :, 0] < DARKEST_FREE
    for edge in (drawn[0], drawn[-1], drawn[:, 0], drawn[:, -1]):
        assert edge.any()


@pytest.mark.parametrize('name', SCENARIOS)
def test_stage_has_walls_where_the_map_is_occupied(name):
    description = read_description(path('maps', name + '.yaml'))
    assert description.rule.mode is MapMode.TRINARY
    drawn = read_pixels(description.image)[::-1, :, 0] < DARKEST_FREE
    assert np.array_equal(drawn, load_map(description).cells == 100)


@pytest.mark.parametrize('name', SCENARIOS)
def test_the_robots_of_the_world_are_those_of_the_scenario_at_their_start_poses(name):
    robots = [model.properties for model in read_world(name) if model.kind == 'robot']
    specs = read_scenario(path('config', SCENARIOS[name])).robots
    assert [robot['name'] for robot in robots] == [spec.name for spec in specs]
    for robot, spec in zip(robots, specs):
        start = spec.settings.start
        assert robot['pose'] == pytest.approx([start.x, start.y, 0.0, math.degrees(start.yaw)], abs=1e-9)


@pytest.mark.parametrize('name', SCENARIOS)
def test_the_robots_of_the_scenarios_stand_on_free_ground(name):
    for spec in read_scenario(path('config', SCENARIOS[name])).robots:
        assert_free(read_map(name), spec.settings.start.x, spec.settings.start.y, spec.name)


def test_the_default_robots_of_the_simulator_stand_on_free_ground_of_the_yard():
    [text] = [arg.get('default') for arg in ElementTree.parse(path('launch', 'simulator.launch')).getroot()
              if arg.get('name') == 'robots']
    for robot in text.split(';'):
        name, x, y, _ = robot.split()
        assert_free(read_map('farm_yard'), float(x), float(y), name)


def test_the_demo_mission_begins_and_goes_to_free_ground_of_the_yard():
    with open(path('config', 'demo_mission.yaml'), encoding='utf-8') as stream:
        robots = yaml.safe_load(stream)['robots']
    for robot in robots:
        for x, y, *_ in [robot['start'], *robot['goals']]:
            assert_free(read_map('farm_yard'), x, y, robot['name'])
