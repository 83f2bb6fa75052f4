"""Robots that are driven by velocities beside real Stage: test/data/stage_drives.json holds what Stage does."""
import functools
import json
import math
from pathlib import Path

import numpy as np
import pytest

from move_base_abstract.driving.contact import polygon
from move_base_abstract.driving.drive_motion import Twist
from move_base_abstract.driving.odometry import Odometry
from move_base_abstract.driving.walls import Walls
from move_base_abstract.fleet import Fleet
from move_base_abstract.maps.occupancy import OccupancyMap
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import make_scenario

MS = 1_000_000
RECORDED = json.loads(Path(__file__).parents[1].joinpath('data/stage_drives.json').read_text())
DRIVES = RECORDED['drives']


@functools.lru_cache(maxsize=None)
def map_of(seed):
    drive, = (drive for drive in DRIVES if drive['seed'] == seed)
    cells = np.zeros((RECORDED['rows'], RECORDED['columns']), np.int8)
    for left, low, columns, rows in drive['boxes']:
        cells[low:low + rows, left:left + columns] = 100
    return OccupancyMap(cells, RECORDED['side'])


def fleet_of(drive):
    """Return the fleet of a drive at its start, at 0 s."""
    return Fleet(make_scenario({
        'defaults': {'driven_by': 'velocities', 'cmd_vel_timeout': 0.0, 'use_map': True},
        'robots': [{'name': robot['name'], 'holonomic': robot['holonomic'],
                    'footprint': RECORDED['shapes'][robot['shape']],
                    **dict(zip(('start_x', 'start_y', 'start_yaw'), robot['start']))} for robot in drive['robots']]}),
        0, occupancy=map_of(drive['seed']))


def run(drive, fleet):
    """Drive as in Stage; yield (index of a robot, a recorded row [ms, x, y, yaw]) at the instant of the row."""
    turns = sorted([(row[0], 0, number, row) for number, robot in enumerate(drive['robots']) for row in robot['poses']]
                   + [(command[0], 1, number, command) for number, robot in enumerate(drive['robots'])
                      for command in robot['commands']])
    for at_ms, is_command, number, values in turns:
        fleet.run(at_ms * MS)
        if is_command:
            _, forward, lateral, turning = values
            fleet.robots[number].drive(forward, turning, lateral)
        else:
            yield number, values


def apart(pose, row):
    """Return (m, degrees) between a pose and a recorded one."""
    return math.dist((pose.x, pose.y), row[1:3]), math.degrees(abs(math.remainder(pose.yaw - row[3], 2.0 * math.pi)))


@functools.lru_cache(maxsize=None)
def compared(seed):
    """Return for each robot [(ms, m, degrees), ...]: how far it is from Stage's, every 0.5 s."""
    drive, = (drive for drive in DRIVES if drive['seed'] == seed)
    fleet, found = fleet_of(drive), [[] for _ in drive['robots']]
    for number, row in run(drive, fleet):
        found[number].append((row[0], *apart(fleet.robots[number].pose, row)))
    return found


def first_beyond(rows):
    """Return the first ms at which a robot is more than 1 cm or 1 degree from Stage's, or None."""
    return next((ms for ms, metres, degrees in rows if metres > 0.01 or degrees > 1.0), None)


def test_most_robots_are_where_they_are_in_stage_for_60_s():
    found = {(drive['seed'], robot['name']): first_beyond(rows)
             for drive in DRIVES for robot, rows in zip(drive['robots'], compared(drive['seed']))}
    within = [key for key, ms in found.items() if ms is None]
    assert len(within) >= 16, found


def test_until_it_first_stalls_a_robot_is_within_2_mm_of_stage():
    for drive in DRIVES:
        for robot, rows in zip(drive['robots'], compared(drive['seed'])):
            stall_ms = min([60_000, *(stall[0] for stall in robot['stalls'])])
            for ms, metres, degrees in rows:
                assert ms >= stall_ms - 50 or metres < 0.002 and degrees < 0.01, (drive['seed'], ms)


def test_each_stall_is_at_the_same_place_from_where_stage_has_the_robot_just_before():
    alone = [drive for drive in DRIVES if len(drive['robots']) == 1]
    both = []
    for drive in alone:
        robot, = drive['robots']
        walls = Walls(map_of(drive['seed']), polygon(RECORDED['shapes'][robot['shape']]))
        for row in robot['poses'][:-1]:
            pose = Pose2D(*row[1:])
            if gap_below(walls, pose, 1e-3):
                continue  # it may be nearer there, or farther away, than Stage's raster says
            stalls = [stall for stall in robot['stalls'] if row[0] < stall[0] <= row[0] + 500]
            mine = stalled_from(drive, row)
            assert (mine is None) == (not stalls), (drive['seed'], row[0])
            if stalls:
                both.append(apart(mine, stalls[0]))
    assert len(both) > 80
    assert max(metres for metres, _ in both) < 0.003
    assert sum(degrees > 1.0 for _, degrees in both) <= 1


def gap_below(walls, pose, gap):
    """Return whether the body at ``pose`` is nearer than ``gap`` [m] to a wall: moved by so much, it touches it."""
    return any(walls.gap_at(Pose2D(pose.x + gap * math.cos(turn), pose.y + gap * math.sin(turn), pose.yaw)) == 0.0
               for turn in (0.0, 0.25 * math.pi, 0.5 * math.pi, 0.75 * math.pi, math.pi, -0.75 * math.pi,
                            -0.5 * math.pi, -0.25 * math.pi))


def stalled_from(drive, row):
    """Return the pose at which the robot stalls within 0.5 s from a recorded row on, or None."""
    robot, = drive['robots']
    fleet = fleet_of(drive)
    member = fleet.robots[0]
    member.place(Pose2D(*row[1:]))
    before = [command for command in robot['commands'] if command[0] <= row[0]][-1]
    later = [command for command in robot['commands'] if row[0] < command[0] < row[0] + 500]
    for at_ms, forward, lateral, turning in [before, *later]:
        fleet.run(max(0, at_ms - row[0]) * MS)
        if any(entry.kind == 'stalled' for entry in fleet.trace):
            return member.pose
        member.drive(forward, turning, lateral)
    fleet.run(500 * MS)
    return member.pose if any(entry.kind == 'stalled' for entry in fleet.trace) else None


def test_odometry_that_is_wrong_by_the_same_shares_drifts_as_in_stage():
    ahead, _, _, turned = RECORDED['odom_error']
    shares = Twist(1.0 + ahead, 1.0, 1.0 + math.radians(turned))
    checked = 0
    for drive in DRIVES:
        fleet = fleet_of(drive)
        odometries = [Odometry(robot.navigator.robot, Pose2D(), 0, shares) for robot in fleet.robots]
        rows = [{row[0]: row for row in robot.get('odometry', ())} for robot in drive['robots']]
        for number, row in run(drive, fleet):
            if row[0] in rows[number] and not drive['robots'][number]['holonomic']:
                metres, degrees = apart(odometries[number].pose_at(fleet.now_ns), rows[number][row[0]])
                assert metres < 0.005
                assert degrees < 0.1
                checked += 1
    assert checked == 242


@pytest.mark.parametrize('seed', [20, 21])
def test_robots_first_stall_at_one_another_when_and_where_they_do_in_stage(seed):
    drive, = (drive for drive in DRIVES if drive['seed'] == seed)
    fleet, checked = fleet_of(drive), set()
    for _ in run(drive, fleet):
        pass
    at_rest = {(entry.time_ns, entry.robot): entry.values for entry in fleet.trace if entry.kind == 'stands'}
    for entry in fleet.trace:
        if entry.kind == 'stalled' and entry.values[0] != 'wall' and entry.robot not in checked:
            if entry.time_ns > 10_000 * MS:
                continue  # their ways are no longer the same
            checked.add(entry.robot)
            robot, = (robot for robot in drive['robots'] if robot['name'] == entry.robot)
            nearest = min(robot['stalls'], key=lambda stall: abs(stall[0] - entry.time_ns / MS))
            assert nearest[0] == pytest.approx(entry.time_ns / MS, abs=10.0)
            metres, degrees = apart(Pose2D(*at_rest[entry.time_ns, entry.robot]), nearest)
            assert metres < 0.003
            assert degrees < 0.5
    assert len(checked) == 2
