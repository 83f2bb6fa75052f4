"""Driven robots that touch walls and one another: where they stall, what the log says, and what sets them free."""
import random

import numpy as np
import pytest
from night import times

from move_base_abstract.driving.contact import REACH, Course, gap_of, polygon
from move_base_abstract.driving.walls import Walls
from move_base_abstract.fleet import Fleet
from move_base_abstract.maps.occupancy import OccupancyMap
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.pieces import stand
from move_base_abstract.scenario import make_scenario

S = 1_000_000_000
MS = 1_000_000
BOX = [[0.2, 0.15], [-0.2, 0.15], [-0.2, -0.15], [0.2, -0.15]]
SIDE = 0.1


def room(*inside):
    """Return a map of 10 m x 10 m with a border of walls, and these cells (row, column) inside."""
    cells = np.full((100, 100), 100, np.int8)
    cells[1:-1, 1:-1] = 0
    for row, column in inside:
        cells[row, column] = 100
    return OccupancyMap(cells, SIDE)


ROOM = room()
WALL = 99 * ROOM.resolution  # the inner face of the eastern border


def fleet_of(*robots, occupancy=ROOM, **defaults):
    """Return a fleet of (name, x, y, yaw), ... that begins at 0 s: discs of 0.3 m without a watchdog."""
    defaults = {'driven_by': 'velocities', 'cmd_vel_timeout': 0.0, 'robot_radius': 0.3,
                'use_map': occupancy is not None, **defaults}
    return Fleet(make_scenario({'defaults': defaults, 'robots': [
        {'name': name, 'start_x': x, 'start_y': y, 'start_yaw': yaw} for name, x, y, yaw in robots]}), 0,
        occupancy=occupancy)


def rows(fleet, *kinds):
    return [tuple(row) for row in fleet.trace if row.kind in kinds]


def stalls(fleet):
    """Return [(robot, by, s), ...] of the rows `stalled`."""
    return [(row.robot, *row.values, row.time_ns / 1e9) for row in fleet.trace if row.kind == 'stalled']


def test_a_robot_stands_at_a_wall_until_a_command_leads_away():
    fleet = fleet_of(('a', 5.0, 5.0, 0.0))
    robot = fleet.robot('a')
    robot.drive(0.5)
    fleet.run(20 * S)
    way = WALL - 0.3 - 5.0
    assert stalls(fleet) == [('a', 'wall', pytest.approx((way - REACH) / 0.5, abs=2e-9))]
    at_rest = robot.pose
    assert at_rest.x == pytest.approx(WALL - 0.3 - REACH, abs=1e-9)
    assert at_rest.x < WALL - 0.3 - REACH
    before = len(fleet.trace)
    for _ in range(100):  # pushing changes nothing
        robot.drive(0.5, 0.01)
        fleet.run_for(0.1)
        robot.drive(0.0)
        fleet.run_for(0.1)
    assert robot.pose == at_rest
    assert len(fleet.trace) == before
    robot.drive(0.0, 0.5)  # it may turn, since it is round
    fleet.run_for(1.0)
    robot.drive(-0.5)
    fleet.run_for(1.0)
    assert robot.distance_to(at_rest.x, at_rest.y) == pytest.approx(0.5)
    assert [row[2] for row in rows(fleet, 'stalled', 'driven', 'stands')] == [
        'driven', 'stands', 'stalled', 'driven', 'driven']


def test_a_robot_drives_along_the_wall_that_it_stands_at():
    fleet = fleet_of(('a', 9.0, 5.0, 0.0), holonomic=True)
    fleet.robot('a').drive(0.5)
    fleet.run(5 * S)
    fleet.robot('a').drive(0.0, lateral=0.5)
    fleet.run(30 * S)
    corner = 99 * ROOM.resolution - 0.3
    assert stalls(fleet)[1:] == [('a', 'wall', pytest.approx(5.0 + (corner - 5.0) / 0.5, abs=1e-4))]
    fleet.robot('a').drive(0.1, lateral=-0.5)  # not exactly along it
    fleet.run(31 * S)
    assert fleet.robot('a').pose.y == pytest.approx(corner, abs=1e-4)


@pytest.mark.parametrize('by', ['wall', 'b'])
@pytest.mark.parametrize('speed', [1e-9, 4e-9, 1e-8])
def test_a_robot_that_drives_along_and_by_a_hair_nearer_does_not_come_into_what_it_stands_at(by, speed):
    long = [[0.3, 4.0], [-0.3, 4.0], [-0.3, -4.0], [0.3, -4.0]]
    fleet = fleet_of(('a', 5.0, 5.0, 0.0), *([('b', 8.0, 5.0, 0.0)] if by == 'b' else []), holonomic=True,
                     occupancy=ROOM if by == 'wall' else None, footprint=BOX if by == 'wall' else long)
    robot = fleet.robot('a')
    robot.drive(0.5)
    fleet.run(20 * S)
    x = robot.pose.x
    robot.drive(speed, lateral=0.004)
    fleet.run_for(900.0)
    assert x < robot.pose.x < x + 0.6 * REACH
    robot.drive(0.5)
    fleet.run_for(5.0)
    assert robot.pose.x < x + 0.6 * REACH
    assert {row[:2] for row in stalls(fleet)} == {('a', by)}
    robot.drive(-0.5)
    fleet.run_for(1.0)
    assert robot.pose.x == pytest.approx(x - 0.5, abs=REACH)


@pytest.mark.parametrize('turning', [5e-324, 1e-17, 1e-12])
def test_a_robot_that_leaves_what_it_stands_at_may_turn_by_as_little_as_rounding_leaves(turning):
    fleet = fleet_of(('a', 9.0, 5.0, 0.0), ('b', 6.0, 5.0, 0.0))
    fleet.robot('a').drive(0.5)
    fleet.run(2 * S)
    fleet.robot('a').drive(-0.5, turning)
    fleet.run(20 * S)
    assert [row[:2] for row in stalls(fleet)] == [('a', 'wall'), ('a', 'b')]
    assert fleet.robot('a').pose.x == pytest.approx(6.6, abs=2.0 * REACH)


def test_a_limited_acceleration_and_a_watchdog_change_nothing_about_where_it_stands():
    fleet = fleet_of(('a', 9.0, 5.0, 0.0), cmd_vel_timeout=0.5, linear={'x': {
        'has_acceleration_limits': True, 'max_acceleration': 1.0}})
    for _ in range(40):
        fleet.robot('a').drive(1.0)
        fleet.run_for(0.1)
    fleet.run_for(2.0)
    assert len(stalls(fleet)) == 1
    assert WALL - 0.3 - 2.0 * REACH < fleet.robot('a').pose.x < WALL - 0.3


def test_two_that_drive_at_one_another_stall_at_one_instant_in_the_order_of_robots():
    fleet = fleet_of(('a', 3.0, 5.0, 0.0), ('b', 6.0, 5.0, np.pi))
    fleet.robot('b').drive(0.25)
    fleet.robot('a').drive(0.5)
    fleet.run(20 * S)
    instant = pytest.approx((3.0 - 0.6 - REACH) / 0.75, abs=2e-9)
    assert stalls(fleet) == [('a', 'b', instant), ('b', 'a', instant)]
    fleet.robot('a').drive(-0.5)
    fleet.robot('b').drive(0.5)  # it follows at the same speed
    fleet.run(40 * S)
    assert [row[:2] for row in stalls(fleet)[2:]] == [('a', 'wall'), ('b', 'a')]


def test_two_that_creep_at_one_another_both_stall_once_in_any_order_of_robots():
    starts = ('a', 3.0, 5.0, 0.0), ('b', 3.6001, 5.0, np.pi)
    found = []
    for robots in (starts, starts[::-1]):
        fleet = fleet_of(*robots)
        for name in 'ab':
            fleet.robot(name).drive(6e-6)  # too slow to touch the other one at once, if that stood
        fleet.run(20 * S)
        found.append(sorted(rows(fleet, 'driven', 'stands', 'stalled')))
    assert found[0] == found[1]
    assert [row[1:3] for row in found[0]] == [
        ('a', 'driven'), ('b', 'driven'), ('a', 'stalled'), ('a', 'stands'), ('b', 'stalled'), ('b', 'stands')]


@pytest.mark.parametrize('speed', [1e-8, 1e-7, 1e-5])
def test_two_that_stand_at_one_another_and_creep_nearer_do_not_set_one_another_off_for_ever(speed):
    fleet = fleet_of(('a', 3.0, 5.0, 0.0), ('b', 3.6002, 5.0, np.pi))
    fleet.robot('a').drive(0.001)
    fleet.run(2 * S)
    fleet.robot('b').drive(speed)
    fleet.robot('a').drive(9e-6)
    fleet.run(2 * S + 10 * MS)
    assert len(rows(fleet, 'driven', 'stalled', 'stands')) < 9


def test_of_two_that_touch_only_the_one_stalls_that_drives_at_the_other():
    fleet = fleet_of(('fast', 2.0, 5.0, 0.0), ('slow', 4.0, 5.0, 0.0), ('still', 9.0, 5.0, 0.0))
    fleet.robot('fast').drive(1.0)
    fleet.robot('slow').drive(0.2)
    fleet.run(40 * S)
    touch = (2.0 - 0.6 - REACH) / 0.8
    assert stalls(fleet) == [('fast', 'slow', pytest.approx(touch, abs=2e-9)),
                             ('slow', 'still', pytest.approx((5.0 - 0.6 - REACH) / 0.2, abs=1e-8)),
                             ('fast', 'slow', pytest.approx(22.0 + 0.2 * (22.0 - touch), abs=1e-4))]  # again


def test_one_that_is_pushed_from_aside_goes_on():
    fleet = fleet_of(('across', 5.0, 3.0, np.pi / 2.0), ('along', 3.0, 5.0, 0.0), footprint=BOX)
    fleet.robot('across').drive(0.5)
    fleet.robot('along').drive(0.49)
    fleet.run(6 * S)
    assert [row[:2] for row in stalls(fleet)] == [('along', 'across')]


def test_a_start_inside_a_wall_and_a_teleport_into_another_robot_may_be_left():
    fleet = fleet_of(('a', WALL - 0.25, 5.0, 0.0), ('b', 5.0, 5.0, 0.0))
    fleet.robot('a').drive(0.5)  # deeper, to the next cell
    fleet.run(1 * S)
    assert stalls(fleet) == [('a', 'wall', pytest.approx(0.05, abs=0.05))]
    fleet.robot('a').drive(-0.5)
    fleet.run(2 * S)
    assert fleet.robot('a').pose.x == pytest.approx(WALL - 0.25 - 0.5, abs=0.2)
    fleet.robot('a').place(Pose2D(5.1, 5.0, 0.0))
    fleet.robot('a').drive(0.5)
    fleet.run(4 * S)
    assert len(stalls(fleet)) == 1
    fleet.robot('a').drive(-0.5)  # now they are apart
    fleet.run(6 * S)
    assert [row[:2] for row in stalls(fleet)[1:]] == [('a', 'b')]
    assert fleet.robot('a').pose.x == pytest.approx(5.6, abs=2.0 * REACH)


def test_a_teleport_away_from_a_wall_lets_it_drive_on():
    fleet = fleet_of(('a', 9.0, 5.0, 0.0))
    fleet.robot('a').drive(0.5)
    fleet.run(5 * S)
    fleet.robot('a').place(Pose2D(5.0, 5.0, 0.0))
    fleet.run(6 * S)
    fleet.robot('a').drive(0.5)
    fleet.run(7 * S)
    assert fleet.robot('a').pose.x > 5.4


def test_a_robot_that_is_removed_blocks_no_longer_and_one_that_is_added_does():
    fleet = fleet_of(('a', 2.0, 5.0, 0.0), ('b', 4.0, 5.0, 0.0))
    fleet.robot('a').drive(0.5)
    fleet.run(1 * S)
    fleet.remove('b')
    fleet.run(6 * S)
    assert fleet.robot('a').pose.x == pytest.approx(5.0)
    fleet.add('c', start_x=7.0, start_y=5.0, driven_by='velocities', robot_radius=0.3)
    fleet.run(10 * S)
    assert [row[:2] for row in stalls(fleet)] == [('a', 'c')]


def test_a_stalled_robot_goes_on_when_the_other_one_leaves_or_is_removed_or_placed_elsewhere():
    for leave in ('drive', 'remove', 'place'):
        fleet = fleet_of(('a', 3.0, 5.0, 0.0), ('b', 5.0, 5.0, 0.0), cmd_vel_timeout=6.0)
        fleet.robot('a').drive(0.5)
        fleet.run(5 * S)
        assert [row[:2] for row in stalls(fleet)] == [('a', 'b')]
        if leave == 'drive':
            fleet.robot('b').drive(0.6)
        elif leave == 'remove':
            fleet.remove('b')
        else:
            fleet.robot('b').place(Pose2D(5.0, 8.0, 0.0))
        fleet.run(5 * S + S // 2)
        assert fleet.robot('a').pose.x == pytest.approx(4.4 + 0.25, abs=1e-5)
        fleet.run(9 * S)  # the watchdog still counts from the command on
        assert fleet.robot('a').pose.x == pytest.approx(4.4 + 0.5, abs=1e-5)
        assert len(stalls(fleet)) == 1


@pytest.mark.parametrize('how', ['hold', 'fail', 'empty', 'reset'])
def test_a_stalled_robot_that_something_else_stops_has_no_command_any_more(how):
    fleet = fleet_of(('a', 3.0, 5.0, 0.0), ('b', 4.0, 5.0, 0.0), failure_kind='abort', battery_capacity=1.0)
    robot, blocker = fleet.robots
    robot.drive(0.5)
    fleet.run(2 * S)
    {'hold': lambda: (robot.hold('a reason'), robot.release('a reason')), 'fail': robot.fail, 'reset': fleet.reset,
     'empty': lambda: robot.set_charge(0.0)}[how]()
    before = len(rows(fleet, 'driven'))
    blocker.place(Pose2D(5.0, 8.0, 0.0))
    fleet.run(4 * S)
    robot.place(Pose2D(3.0, 3.0, 0.0))
    fleet.run(100 * S)
    assert len(rows(fleet, 'driven')) == before


def test_a_stalled_robot_that_is_removed_with_the_one_at_which_it_stands_drives_no_more():
    fleet = fleet_of(('a', 3.0, 5.0, 0.0), ('b', 4.0, 5.0, 0.0))
    fleet.robot('a').drive(0.5)
    fleet.run(2 * S)
    fleet.remove('b')
    fleet.remove('a')
    fleet.run(100 * S)
    assert len(rows(fleet, 'driven')) == 1


def test_after_a_reset_the_same_happens_again():
    fleet = fleet_of(('a', 3.0, 5.0, 0.0), ('b', 6.0, 5.0, np.pi))
    found = []
    for _ in range(2):
        begin = len(fleet.trace)
        begin_ns = fleet.now_ns
        fleet.robot('a').drive(0.5)
        fleet.robot('b').drive(0.5)
        fleet.run_for(10.0)
        found.append([(row.time_ns - begin_ns, *row[1:]) for row in fleet.trace[begin:]])
        fleet.reset()
    assert found[0] == found[1]
    assert len(found[0]) >= 4


def test_after_a_restart_of_the_clock_robots_stand_where_they_were_and_stall_again_by_the_new_time():
    fleet = fleet_of(('a', 3.0, 5.0, 0.0), ('b', 6.0, 5.0, np.pi))
    for robot in fleet.robots:
        robot.drive(0.5)
    fleet.run(1 * S)
    fleet.simulation.restart(S // 10)
    for robot in fleet.robots:
        robot.navigator.restart(1 * S, S // 10)
    poses = [robot.pose for robot in fleet.robots]
    fleet.run(5 * S)
    assert [robot.pose for robot in fleet.robots] == poses
    assert stalls(fleet) == []
    for robot in fleet.robots:
        robot.drive(0.5)
    fleet.run(10 * S)
    assert stalls(fleet) == [(name, by, pytest.approx(5.0 + (2.0 - 0.6 - REACH), abs=2e-9))
                             for name, by in ('ab', 'ba')]


def test_another_map_counts_from_its_instant_on():
    fleet = fleet_of(('a', 3.0, 5.0, 0.0))
    fleet.robot('a').drive(0.5)
    fleet.run(1 * S)
    fleet.use_map(room(*((row, 60) for row in range(100))))
    fleet.run(10 * S)
    assert fleet.robot('a').pose.x == pytest.approx(60 * ROOM.resolution - 0.3, abs=2.0 * REACH)


def test_a_stalled_robot_goes_on_when_the_wall_is_no_longer_there():
    fleet = fleet_of(('a', 3.0, 5.0, 0.0), occupancy=room(*((row, 60) for row in range(100))))
    fleet.robot('a').drive(0.5)
    fleet.run(10 * S)
    fleet.use_map(room(*((row, 60) for row in range(100))))
    fleet.run(11 * S)
    assert len(rows(fleet, 'driven')) == 1
    fleet.use_map(ROOM)
    fleet.run(30 * S)
    assert fleet.robot('a').pose.x == pytest.approx(WALL - 0.3, abs=2.0 * REACH)


def test_without_a_map_and_with_use_map_false_nothing_but_robots_stops_one():
    for fleet in (fleet_of(('a', 8.0, 5.0, 0.0), occupancy=None), fleet_of(('a', 8.0, 5.0, 0.0), use_map=False)):
        fleet.robot('a').drive(0.5)
        fleet.run(10 * S)
        assert fleet.robot('a').pose.x == pytest.approx(13.0)


def drive_at_random(seed, names, step_ns=None):
    """Return the fleet after 20 s of random commands for robots of these names, each with chances of its own."""
    draw = random.Random(seed)
    occupancy = room(*((draw.randrange(100), draw.randrange(100)) for _ in range(40)))
    starts = {name: (4.0 + 0.8 * (number % 3), 4.0 + 0.8 * (number // 3)) for number, name in enumerate('abcdef')}
    fleet = Fleet(make_scenario({'defaults': {
        'driven_by': 'velocities', 'footprint': BOX, 'holonomic': True, 'use_map': True}, 'robots': [
        {'name': name, 'start_x': starts[name][0], 'start_y': starts[name][1]} for name in names]}), 0,
        occupancy=occupancy)
    commands = []
    for name in sorted(names):
        own = random.Random('{}/{}'.format(seed, name))
        now_ns = 0
        while now_ns < 20 * S:
            commands.append((now_ns, name, own.uniform(-0.5, 1.0), own.uniform(-1.5, 1.5),
                             own.choice([0.0, 0.0, 0.4])))
            now_ns += own.randint(100 * MS, 1000 * MS)
    for now_ns, name, *twist in sorted(commands, key=lambda command: command[0]):
        while step_ns and fleet.now_ns + step_ns < now_ns:
            fleet.run(fleet.now_ns + step_ns)
            yield fleet, occupancy
        fleet.run(now_ns)
        yield fleet, occupancy
        fleet.robot(name).drive(*twist)
    fleet.run(20 * S)
    yield fleet, occupancy


def last_of(*arguments):
    *_, (fleet, _) = drive_at_random(*arguments)
    return fleet


@pytest.mark.parametrize('seed', range(times(3, 100)))
def test_no_robot_is_ever_inside_of_a_wall_or_another_robot(seed):
    shape, inside = polygon(BOX), set()
    walls = None
    for fleet, occupancy in drive_at_random(seed, 'abcdef', 50 * MS):
        walls = walls or Walls(occupancy, shape)
        bodies = [Course(stand(robot.pose, 0), shape) for robot in fleet.robots]
        inside_now = {(one, other) for one in range(6) for other in range(one)
                      if gap_of(bodies[one], bodies[other], 0) < 0.5 * REACH}
        inside_now |= {(number, 'wall') for number, robot in enumerate(fleet.robots)
                       if walls.gap_at(robot.pose) < 0.5 * REACH}
        if fleet.now_ns == 0:
            inside = inside_now  # a random cell may be where one starts
        assert inside_now <= inside
    assert len(stalls(fleet)) > 2


@pytest.mark.parametrize('seed', [*range(times(2, 50)), 27])  # 27: one touches two others at one instant
def test_the_rows_do_not_depend_on_the_order_of_robots_or_on_when_somebody_looks(seed):
    def found(*arguments):
        return sorted(tuple(row) for row in last_of(seed, *arguments).trace)
    rows_of_all = found('abcdef')
    assert rows_of_all == found('fbdeca')
    assert rows_of_all == found('abcdef', 7 * MS)
    assert any(row[2] == 'stalled' and row[3][0] in 'abcdef' for row in rows_of_all)
