"""What follows from the arcs of robots that are driven by velocities: the log, replays, metrics, batteries."""
import json
import random

import pytest

from driven_robots import MS, S, fleet_of, limited
from move_base_abstract.fleet import Fleet
from move_base_abstract.motion.told import motion_of_row, packed, told, told_of
from move_base_abstract.scenario import make_scenario


def test_a_drive_that_was_told_is_the_drive_and_c_plus_plus_gets_its_pieces():
    fleet = fleet_of(holonomic=True, linear={'x': limited(-2.0, 2.0, -1.0, 1.0)}, cmd_vel_timeout=0.0)
    fleet.robot('r').drive(1.5, -0.7, 0.2)
    robot = fleet.robot('r').navigator.robot
    again = motion_of_row(json.loads(json.dumps(told(robot.leg))))
    assert (again.start, again.end, again.arrive_ns) == (robot.leg.start, robot.leg.end, robot.leg.arrive_ns)
    assert again.distance == pytest.approx(robot.leg.distance)
    for now_ns in range(0, 61 * S, 777 * MS):
        assert (again.pose_at(now_ns), again.velocity_at(now_ns)) == (robot.leg.pose_at(now_ns),
                                                                      robot.leg.velocity_at(now_ns))
        assert robot.leg.covers_ns(robot.leg.distance_at(now_ns)) == pytest.approx(now_ns, abs=1000)
    assert len(packed(told_of(robot, 0))) == 80 * (len(robot.leg.pieces) + 1)


@pytest.mark.parametrize('limits', [{}, {'x': limited(-1.0, 1.0, -4.0, 4.0)}])
def test_replay_and_metrics_have_the_way_and_the_energy_of_arcs(tmp_path, limits):
    from move_base_abstract_experiments.trials.metrics import summarise
    from move_base_abstract_replay.charges import Charges
    from move_base_abstract_replay.motions import Motions
    from move_base_abstract_replay.recording import read_recording
    from move_base_abstract_replay.world import make_world
    chance = random.Random(4)
    scenario = {'robots': [{'name': 'r', 'driven_by': 'velocities', 'log_motion': True, 'battery_capacity': 1.0,
                            'linear': limits}]}
    fleet = Fleet(make_scenario(scenario), start_ns=0)
    poses = []
    for number in range(600):
        fleet.run(number * 100 * MS)
        poses.append((fleet.now_ns, fleet.robot('r').pose))
        if number % 60 < 50:
            fleet.robot('r').drive(chance.uniform(-1.0, 1.0), chance.choice([0.0, 1.0]))
    fleet.run()
    path = tmp_path / 'run.jsonl'
    fleet.write_log(path)
    metrics = summarise(str(path)).robots['r']
    assert metrics['distance_m'] == pytest.approx(fleet.robot('r').distance, abs=1e-6)
    assert metrics['waiting_s'] == 0.0
    if not limits:
        assert metrics['moving_s'] == pytest.approx(10 * (4.9 + 0.5))
    recording, world = read_recording(path), make_world(make_scenario(scenario))
    charges = Charges(world, 0)
    driven = Motions(recording, world, charges).tracks['r'].driven
    if not limits:
        assert sum(one.motion.distance > 0.0 for one in driven) == 10  # from rest to rest
    for now_ns, pose in poses:
        motion = [one.motion for one in driven if one.motion.depart_ns <= now_ns][-1]
        end_ns = [one.end_ns for one in driven if one.motion.depart_ns <= now_ns][-1]
        found = motion.pose_at(min(now_ns, end_ns))
        assert (found.x, found.y, found.yaw) == pytest.approx((pose.x, pose.y, pose.yaw), abs=1e-9)
    last_ns, share = charges.knots['r'][-1]
    rest = 20.0 * (fleet.now_ns - last_ns) / S / (12.0 * 3600.0)  # 20 W, 1 Ah at 12 V
    assert share - rest == pytest.approx(fleet.robot('r').state_of_charge, abs=1e-9)


def test_without_pieces_a_replay_goes_straight_between_the_rows(tmp_path):
    from move_base_abstract_replay.motions import Motions
    from move_base_abstract_replay.recording import read_recording
    fleet = fleet_of(log_motion=False, start_x=3.0)
    for number, speed in enumerate((1.0, 0.5, -1.0)):
        fleet.run(number * 400 * MS)
        fleet.robot('r').drive(speed)
    fleet.run()
    fleet.write_log(tmp_path / 'run.jsonl')
    driven = Motions(read_recording(tmp_path / 'run.jsonl')).tracks['r'].driven
    for now_ns, x in ((200 * MS, 3.2), (400 * MS, 3.4), (600 * MS, 3.5), (1000 * MS, 3.4), (1300 * MS, 3.1)):
        end_ns, motion = [one for one in driven if one.motion.depart_ns <= now_ns][-1]
        assert motion.pose_at(min(now_ns, end_ns)).x == pytest.approx(x)


def test_a_battery_takes_energy_on_arcs_and_a_robot_without_charge_stands():
    fleet = fleet_of(battery_capacity=0.01, nominal_voltage=10.0, mass=10.0, friction_coefficient=0.2,
                     cmd_vel_timeout=0.0, ambient_power=0.0, tool_power=0.0, moment_of_inertia=1.0)
    robot = fleet.robot('r')
    robot.drive(1.0, 0.3)
    fleet.run(5 * S)
    energy = 0.2 * 10.0 * 9.81 * 5.0 + 5.0 + 0.045  # friction, and the start of driving and of turning
    assert robot.state_of_charge == pytest.approx(1.0 - energy / 360.0)
    fleet.run(60 * S)
    empty_s = (360.0 - 5.0) / (0.2 * 10.0 * 9.81)
    assert robot.distance == pytest.approx(empty_s, abs=0.3)
    robot.drive(1.0)
    fleet.run(70 * S)
    assert robot.distance == pytest.approx(empty_s, abs=0.3)


def test_a_change_of_the_velocity_takes_the_energy_of_the_change_alone():
    fleet = fleet_of(battery_capacity=1.0, nominal_voltage=1.0, mass=10.0, friction_coefficient=0.0, ambient_power=0.0,
                     moment_of_inertia=2.0, cmd_vel_timeout=0.0)
    robot, speeds = fleet.robot('r'), [1.0, 2.0, 0.5, -0.5, 0.5]
    for number, speed in enumerate(speeds):
        fleet.run(number * S)
        robot.drive(9.0)
        robot.drive(speed, 1.0)  # the last one counts
    fleet.run(100 * S)  # it has gone on by itself
    joules = 5.0 * (1.0 + 3.0 + 3.75) + 1.0
    assert robot.state_of_charge == pytest.approx(1.0 - joules / 3600.0, rel=1e-12)
    robot.drive(0.0)
    assert robot.state_of_charge == pytest.approx(1.0 - (joules + 5.0 * 0.25 + 1.0) / 3600.0, rel=1e-12)
