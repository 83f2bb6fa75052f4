"""When robots that are driven by velocities enter and leave zones, against a search in small steps."""
import math
import random

import pytest
from night import times

from move_base_abstract.fleet import Fleet
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import make_scenario
from move_base_abstract.traffic.outline import Outline

S = 1_000_000_000
MS = 1_000_000


def fleet_of(zones, **parameters):
    """Return a fleet with a robot 'r' that is driven by velocities without a watchdog; it begins at 0 s."""
    robot = {'name': 'r', 'driven_by': 'velocities', 'cmd_vel_timeout': 0.0, 'holonomic': True, **parameters}
    return Fleet(make_scenario({'robots': [robot], 'zones': zones}), start_ns=0)


def passages(fleet):
    """Return [(time_ns, kind, area), ...]."""
    return [(row.time_ns, row.kind, row.values[0]) for row in fleet.trace if row.kind in ('entered', 'left')]


def star(chance, x, y):
    """Return the corners of a polygon around (x, y)."""
    count, turned = chance.randrange(3, 9), chance.uniform(0.0, 6.0)
    corners = [(chance.uniform(0.3, 2.0), turned + 2.0 * math.pi * number / count) for number in range(count)]
    return [[x + radius * math.cos(angle), y + radius * math.sin(angle)] for radius, angle in corners]


@pytest.mark.parametrize('seed', range(times(40, 400)))
def test_zones_are_entered_and_left_at_the_first_nanosecond(seed):
    chance = random.Random(seed)
    outlines = {f'zone z{number}': star(chance, chance.uniform(-3.0, 3.0), chance.uniform(-3.0, 3.0))
                for number in range(3)}
    fleet = fleet_of([{'name': name[len('zone '):], 'polygon': points} for name, points in outlines.items()])
    outlines = {name: Outline(points) for name, points in outlines.items()}
    robot, inside = fleet.robot('r'), {name: True for _, _, name in passages(fleet)}

    def is_in(name, at_ns):
        pose = robot.navigator.robot.pose_at(at_ns)
        return outlines[name].contains(pose.x, pose.y)

    for _ in range(6):
        robot.drive(chance.choice([0.0, 0.7, -0.4, chance.uniform(-1.5, 1.5)]),
                    chance.choice([0.0, 1e-11, 1e-4, 3.0, chance.uniform(-1.0, 1.0)]), chance.choice([0.0, 0.3]))
        begin_ns, seen = fleet.now_ns, len(passages(fleet))
        fleet.run(begin_ns + chance.randrange(1, 12 * S))
        told = passages(fleet)[seen:]
        for at_ns, kind, name in told:
            assert is_in(name, at_ns) == (kind == 'entered')
            assert at_ns == begin_ns or is_in(name, at_ns - 1) == (kind == 'left')
        for at_ns in range(begin_ns, fleet.now_ns, 5 * MS):
            while told and told[0][0] <= at_ns:
                _, kind, name = told.pop(0)
                inside[name] = kind == 'entered'
            assert [name for name in outlines if is_in(name, at_ns)] == [name for name in outlines if inside.get(name)]
        inside.update({name: kind == 'entered' for _, kind, name in told})


def test_a_circle_passes_a_zone_at_each_turn():
    fleet = fleet_of([{'name': 'right', 'rectangle': [0.0, -9.0, 9.0, 9.0]}], start_x=-1.0)
    fleet.robot('r').drive(1.0, 1.0)  # around (-1, 1), which the zone's border touches at x = 0
    fleet.run(20 * S)
    assert passages(fleet) == []
    fleet = fleet_of([{'name': 'right', 'rectangle': [0.0, -9.0, 9.0, 9.0]}], start_x=-0.5)
    fleet.robot('r').drive(1.0, 1.0)
    fleet.run()  # ends, though the robot drives on
    assert fleet.now_ns == 0
    fleet.run(20 * S)
    first, second = math.asin(0.5), math.pi - math.asin(0.5)
    expected = [(angle + turn * 2.0 * math.pi, kind) for turn in range(4)
                for angle, kind in ((first, 'entered'), (second, 'left')) if angle + turn * 2.0 * math.pi < 20.0]
    found = passages(fleet)
    assert [kind for _, kind, _ in found] == [kind for _, kind in expected]
    assert [at_ns / S for at_ns, _, _ in found] == pytest.approx([seconds for seconds, _ in expected], abs=3e-6)


def test_a_robot_without_a_place_drives_in_and_robots_with_goals_wait_until_it_has_left():
    scenario = make_scenario({
        'robots': [{'name': 'r', 'driven_by': 'velocities', 'start_y': -3.0, 'start_yaw': 0.5 * math.pi},
                   {'name': 'goes', 'start_x': -5.0, 'max_speed': 1.0}],
        'zones': [{'name': 'gate', 'rectangle': [-1.0, -1.0, 1.0, 1.0], 'capacity': 1}]})
    fleet = Fleet(scenario, start_ns=0)
    fleet.robot('goes').send(5.0, 0.0)
    for number in range(200):
        fleet.run(number * 100 * MS)
        fleet.robot('r').drive(0.25)
    fleet.run()
    rows = [(round(row.time_ns / S, 3), row.robot, row.kind) for row in fleet.trace if row.kind in (
        'entered', 'left', 'ended')]
    assert rows == [(4.0, 'goes', 'entered'), (6.0, 'goes', 'left'), (8.0, 'r', 'entered'), (10.0, 'goes', 'ended'),
                    (16.0, 'r', 'left')]
    fleet.robot('goes').send(-5.0, 0.0)
    fleet.run()
    fleet.robot('r').place(Pose2D())
    fleet.robot('goes').send(5.0, 0.0)
    fleet.run(fleet.now_ns + 20 * S)
    assert fleet.robot('goes').pose.x == pytest.approx(-1.0)
    fleet.robot('r').drive(3.0)
    fleet.run()
    assert fleet.robot('goes').pose.x == pytest.approx(5.0)


def test_a_charger_charges_a_robot_that_stands_in_its_zone():
    fleet = fleet_of([{'name': 'dock', 'rectangle': [1.0, -1.0, 2.0, 1.0], 'charger': 20.0}], battery_capacity=1.0,
                     battery_start=0.5)
    fleet.robot('r').drive(0.5)
    fleet.run(3 * S)
    fleet.robot('r').drive(0.0)
    fleet.run(30 * S)
    assert [(row.time_ns, row.kind) for row in fleet.trace if 'charging' in row.kind] == [(3 * S, 'charging_began')]
    assert fleet.robot('r').state_of_charge > 0.6


def test_the_laser_of_a_robot_on_an_arc_sees_the_other_one_from_where_both_are_then():
    robots = [{'name': 'r', 'start_y': -1.0}, {'name': 'other', 'start_x': 3.0, 'robot_radius': 0.5}]
    fleet = Fleet(make_scenario({'robots': robots, 'defaults': {
        'driven_by': 'velocities', 'cmd_vel_timeout': 0.0, 'use_map': False, 'scan_rate': 1.0, 'scan_beams': 3,
        'scan_angle_min': -0.5 * math.pi, 'scan_angle_max': 0.5 * math.pi}}), start_ns=0)
    fleet.robot('r').drive(math.pi / 2.0, math.pi / 2.0)  # a quarter of a circle around (0, 0) in 1 s
    fleet.robot('other').drive(0.0, 1.0)
    fleet.run(S)
    right, ahead, left = fleet.robot('r').scan().ranges.tolist()
    assert (right, ahead, left) == (pytest.approx(1.5, abs=1e-2), math.inf, math.inf)
