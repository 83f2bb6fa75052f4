"""Missions and field files: what is read, what is refused and with which words, and how chance is used."""

import math
import os

import pytest

from move_base_abstract import mission
from move_base_abstract.mission import FieldPoint, MissionError
from move_base_abstract.motion.geometry import Pose2D

CONFIG = os.path.join(os.path.dirname(__file__), '..', '..', 'config')
GOOD = {'robots': [{'name': 'a', 'start': [0, 0], 'goals': [[3, 4], [3, 4, 1.5]]}]}
POINTS = tuple(FieldPoint(float(i), float(i * i), 0.0) for i in range(20))


def robot_with(**changes):
    return {'robots': [dict(GOOD['robots'][0], **changes)]}


def field_file(tmp_path, text):
    path = tmp_path / 'field.csv'
    path.write_text(text)
    return path


# ---- the mission file

def test_a_mission_is_read_with_the_yaw_of_travel_where_none_is_given():
    robot, = mission.parse_mission(GOOD, 'm.yaml').robots
    assert robot.start == Pose2D(0.0, 0.0, 0.0)
    assert robot.goals == (Pose2D(3.0, 4.0, math.atan2(4, 3)), Pose2D(3.0, 4.0, 1.5))


def test_the_mission_that_ships_with_the_package_is_readable():
    shipped = mission.read_mission(os.path.join(CONFIG, 'demo_mission.yaml'))
    assert [robot.name for robot in shipped.robots] == ['robot_{}'.format(number) for number in range(5)]
    assert shipped.goal_count >= 9


@pytest.mark.parametrize('document, words', [
    (None, 'm.yaml: mission: must be a mapping with the keys robots, got None'),
    ({'robot': []}, "m.yaml: mission.robot: unknown key; did you mean 'robots'?"),
    ({}, "m.yaml: mission: the key 'robots' is missing"),
    ({'robots': []}, 'm.yaml: robots: must be a list of at least one robot, got []'),
    (robot_with(goal=[]), "m.yaml: robots[0].goal: unknown key; did you mean 'goals'?"),
    (robot_with(colour='red'), 'm.yaml: robots[0].colour: unknown key; known keys: name, start, goals'),
    ({'robots': [{'name': 'a', 'goals': [[1, 1]]}]}, "m.yaml: robots[0]: the key 'start' is missing"),
    (robot_with(name='/a'), 'm.yaml: robots[0].name: must be letters'),
    (robot_with(goals=[]), 'm.yaml: robots[0].goals: must be a list of at least one goal, got []'),
    (robot_with(goals=[[1, math.nan]]), 'm.yaml: robots[0].goals[0]: y must be a finite number, got nan'),
    (robot_with(start=[math.inf, 0]), 'm.yaml: robots[0].start: x must be a finite number, got inf'),
    (robot_with(start=[0, -1e12]), 'm.yaml: robots[0].start: pose: y must be within +-1e9 m, got -1000000000000.0'),
    (robot_with(start=[0, 0, True]), 'm.yaml: robots[0].start: yaw must be a finite number, got True'),
    (robot_with(start=['1e3', 0]), 'YAML takes 1e3 as text: write 1.0e+3'),
    (robot_with(start=[1]), 'm.yaml: robots[0].start: must be [x, y] or [x, y, yaw]'),
    ({'robots': GOOD['robots'] * 2}, "m.yaml: robots[1].name: 'a' is already the name of robots[0]"),
])
def test_a_wrong_mission_is_refused_with_the_place_and_what_is_allowed(document, words):
    with pytest.raises(MissionError) as error:
        mission.parse_mission(document, 'm.yaml')
    assert words in str(error.value)


def test_a_mission_can_be_cut_to_its_first_robots_but_not_widened():
    two = mission.parse_mission({'robots': [dict(GOOD['robots'][0], name=name) for name in 'ab']}, 'm.yaml')
    assert two.first_robots(1).robots == two.robots[:1]
    assert two.first_robots(None) == two
    with pytest.raises(MissionError, match='the mission has 2 robots: their number must be 1..2, got 3'):
        two.first_robots(3)


def test_a_missing_or_broken_file_is_named(tmp_path):
    with pytest.raises(MissionError, match='absent.yaml: cannot be read'):
        mission.read_mission(tmp_path / 'absent.yaml')
    (tmp_path / 'broken.yaml').write_text('robots: [\n')
    with pytest.raises(MissionError, match='broken.yaml: is not YAML.*line 2'):
        mission.read_mission(tmp_path / 'broken.yaml')


# ---- field readings

def test_readings_become_metres_from_the_south_west_corner(tmp_path):
    path = field_file(tmp_path, 'lat,lon,0.0 cm\n53.0,-0.5,700\n53.001,-0.5,710\n\n53.0,-0.499,720\n')
    corner, north, east = mission.read_field_points(path)
    assert corner == FieldPoint(0.0, 0.0, 700.0)
    # Length of one degree at the latitude p, by the usual series: an independent check of the closed form.
    p = math.radians(53.0005)
    north_m = 111132.954 - 559.822 * math.cos(2 * p) + 1.175 * math.cos(4 * p)
    east_m = 111412.84 * math.cos(p) - 93.5 * math.cos(3 * p) + 0.118 * math.cos(5 * p)
    assert (north.x, north.value) == (0.0, 710.0) and north.y == pytest.approx(north_m / 1000, abs=1e-3)
    assert (east.y, east.value) == (0.0, 720.0) and east.x == pytest.approx(east_m / 1000, abs=1e-3)


def test_the_value_column_can_be_chosen(tmp_path):
    path = field_file(tmp_path, 'depth,lat,value,lon,,\n1,53,7,0,,\n2,53,8,0,,\n3,53,9,0,,\n')  # as of a spreadsheet
    assert [point.value for point in mission.read_field_points(path)] == [7.0, 8.0, 9.0]
    assert [point.value for point in mission.read_field_points(path, 'depth')] == [1.0, 2.0, 3.0]


@pytest.mark.parametrize('text, words', [
    ('', ': line 1: got no columns'),
    ('lat,value\n1,2\n', ': no column lon; allowed: a table with lat, lon'),
    ('lat,lon\n1,2\n', ': no column value; allowed: a table with lat, lon and a value'),
    ('lat,lon,lat,v\n1,2,3,4\n', ": line 1: the column 'lat' is there 2 times"),
    ('lat,lon,v\n1,2,3\n1,2\n', ': line 3: got 2 cells; allowed: 3'),
    ('lat,lon,v\n1,2,nan\n', ": line 2: v: got 'nan'; allowed: a finite number"),
    ('lat,lon,v\n1,2,3\n1,east,3\n', ": line 3: lon: got 'east'; allowed: a finite number"),
    ('lat,lon,v\n91,2,3\n', ": line 2: lat: got '91'; allowed: -90..90"),
    ('lat,lon,v\n1,2,' + '1' * 5001 + '\n', ": line 2: v: got '1111"),
    ('lat,lon,' + 'v' * 5001 + '\n1,2,x\n', ': line 2: vvvv'),
    ('lat,lon,v\n1,2,3\n1,3,3\n', ': needs at least 3 points, got 2'),
])
def test_a_wrong_field_file_is_refused_with_file_and_line(tmp_path, text, words):
    with pytest.raises(MissionError) as error:
        mission.read_field_points(field_file(tmp_path, text))
    assert 'field.csv' + words in str(error.value)
    assert len(str(error.value)) < len(str(tmp_path)) + 400


def test_a_device_or_a_folder_is_no_field_file(tmp_path):
    for path in ('/dev/zero', tmp_path):
        with pytest.raises(MissionError, match=f'{path}: is a .*; allowed: a CSV file'):
            mission.read_field_points(path)


# ---- chance

def test_the_same_seed_gives_the_same_mission_and_another_seed_another():
    first = mission.mission_from_points(POINTS, 3, 5, seed=7)
    assert first == mission.mission_from_points(POINTS, 3, 5, seed=7)
    assert first != mission.mission_from_points(POINTS, 3, 5, seed=8)


def test_adding_a_robot_changes_no_other_robots_plan():
    few, many = (mission.mission_from_points(POINTS, n, 5, seed=7) for n in (2, 4))
    assert many.robots[:2] == few.robots
    assert many.goal_count == 20


def test_a_robot_visits_each_of_its_points_once_and_faces_where_it_travels():
    robot = mission.mission_from_points(POINTS, 1, len(POINTS) - 1).robots[0]
    stops = [(place.x, place.y) for place in (robot.start,) + robot.goals]
    assert sorted(stops) == [(point.x, point.y) for point in POINTS]
    assert robot.goals[0].yaw == robot.start.bearing_to(robot.goals[0])


@pytest.mark.parametrize('count, goals, words', [
    (0, 1, 'robot_count must be a whole number >= 1, got 0'),
    (1, 2.5, 'goals_each must be a whole number >= 1, got 2.5'),
    (1, 20, 'goals_each must be < the number of points, 20, got 20'),
])
def test_impossible_numbers_are_refused(count, goals, words):
    with pytest.raises(MissionError, match=words):
        mission.mission_from_points(POINTS, count, goals)
