"""Robots that are driven by velocities, in plain Python: poses against an integral by hand, limits, watchdog, rows."""
import json
import math
import random

import numpy as np
import pytest
from night import times

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.driving.drive_motion import HORIZON_NS
from move_base_abstract.fleet import Fleet
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.told import motion_of_row, packed, told, told_of
from move_base_abstract.scenario import make_scenario

S = 1_000_000_000
MS = 1_000_000
NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)


def fleet_of(**parameters):
    """Return a fleet with one robot, 'r', that is driven by velocities; it begins at 0 s."""
    robot = {'name': 'r', 'driven_by': 'velocities', 'log_motion': True, **parameters}
    return Fleet(make_scenario({'robots': [robot]}), start_ns=0)


def rows(fleet, *kinds):
    """Return [(time_ns, kind), ...] of the rows of these kinds."""
    return [(row.time_ns, row.kind) for row in fleet.trace if row.kind in kinds]


def velocity(fleet):
    """Return (forward, lateral, turning) of the robot now."""
    return fleet.robot('r').navigator.robot.velocity_at(fleet.now_ns)


def limited(low, high, slowing, speeding):
    """Return the parameters of an axis with these limits."""
    return {'has_velocity_limits': True, 'min_velocity': low, 'max_velocity': high,
            'has_acceleration_limits': True, 'min_acceleration': slowing, 'max_acceleration': speeding}


class ByHand:
    """A robot that is integrated in time: nothing of it is the product's."""

    def __init__(self, timeout_ns, period_ns, accelerations):
        self.timeout_ns, self.period_ns, self.accelerations = timeout_ns, period_ns, accelerations
        self.now_ns, self.stepped_ns, self.due_ns = 0, -10 ** 18, None
        self.pose, self.twist, self.wanted = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]

    def to(self, now_ns):
        """Drive up to ``now_ns``, without what happens then."""
        while self.now_ns < now_ns:
            if self.due_ns == self.now_ns:
                self.wanted, self.due_ns = [0.0, 0.0, 0.0], None
            self._step()
            ends = [now_ns] if self.due_ns is None else [now_ns, self.due_ns]
            if self.twist != self.wanted:
                ends.append(self.stepped_ns + self.period_ns)
            end_ns = min(ends)
            self._integrate((end_ns - self.now_ns) / 1e9)
            self.now_ns = end_ns

    def command(self, twist):
        self.wanted, self.due_ns = list(twist), self.now_ns + self.timeout_ns

    def _step(self):
        if self.twist == self.wanted or self.now_ns < self.stepped_ns + self.period_ns and self.accelerations:
            return
        self.stepped_ns = self.now_ns
        if not self.accelerations:
            self.twist = list(self.wanted)
            return
        for number, (value, wanted, rate) in enumerate(zip(self.twist, self.wanted, self.accelerations)):
            change, most = wanted - value, rate * self.period_ns / 1e9
            self.twist[number] = wanted if abs(change) <= most * (1.0 + 1e-9) else value + math.copysign(most, change)

    def _integrate(self, seconds):
        forward, lateral, turning = self.twist
        parts = 1 + int(abs(turning) * seconds)
        for _ in range(parts):  # Gauss, a radian at most
            share = seconds / parts
            headings = self.pose[2] + turning * share * 0.5 * (NODES + 1.0)
            self.pose[0] += 0.5 * share * float(WEIGHTS @ (forward * np.cos(headings) - lateral * np.sin(headings)))
            self.pose[1] += 0.5 * share * float(WEIGHTS @ (forward * np.sin(headings) + lateral * np.cos(headings)))
            self.pose[2] += turning * share


def a_drive(chance):
    """Return (instants, twists) of commands; some come at one instant, some when the watchdog acts."""
    instants, now_ns = [], 0
    for _ in range(chance.randrange(1, 12)):
        now_ns += chance.choice([0, 500 * MS, 20 * MS, 1, chance.randrange(1, 900 * MS)])
        instants.append(now_ns)
    twists = [tuple(chance.choice([0.0, chance.uniform(-2.0, 2.0)]) for _ in range(3)) for _ in instants]
    return instants, twists


@pytest.mark.parametrize('part', range(10))
def test_poses_are_those_of_an_integral_by_hand(part):
    worst = 0.0
    for number in range(times(100, 400)):
        chance = random.Random(1000 * number + part)
        accelerations = chance.choice([None, (chance.uniform(0.5, 9.0), chance.uniform(0.5, 9.0), 3.0)])
        limits = {} if accelerations is None else {
            'linear': {axis: limited(-2.0, 2.0, -one, one) for axis, one in zip('xy', accelerations)},
            'angular': {'z': limited(-2.0, 2.0, -3.0, 3.0)}}
        fleet = fleet_of(holonomic=True, control_period=0.02, **limits)
        by_hand = ByHand(500 * MS, 20 * MS, accelerations)
        for now_ns, twist in zip(*a_drive(chance)):
            fleet.run(now_ns)
            by_hand.to(now_ns)
            fleet.robot('r').drive(twist[0], twist[2], twist[1])
            by_hand.command(twist)
        for now_ns in (fleet.now_ns + 70 * MS, fleet.now_ns + 3 * S):
            fleet.run(now_ns)
            by_hand.to(now_ns)
            pose, (x, y, yaw) = fleet.robot('r').pose, by_hand.pose
            worst = max(worst, abs(pose.x - x), abs(pose.y - y), abs(math.remainder(pose.yaw - yaw, 2.0 * math.pi)))
    assert worst < 1e-9


def test_the_watchdog_stops_the_robot_to_the_nanosecond_and_0_stands_for_never():
    for name, timeout in (('cmd_vel_timeout', 0.5), ('cmd_vel_timeout', None), ('base_watchdog_timeout', 0.2)):
        fleet = fleet_of(**({} if timeout is None else {name: timeout}))
        fleet.robot('r').drive(1.0)
        fleet.run()
        assert rows(fleet, 'driven', 'stands') == [(0, 'driven'), (int((timeout or 0.5) * S), 'stands')]
        assert fleet.robot('r').pose == Pose2D(timeout or 0.5)
    fleet = fleet_of(base_watchdog_timeout=0.0)
    fleet.robot('r').drive(1.0, 0.5)
    fleet.run()  # ends, though the robot drives on
    assert fleet.now_ns == 0
    fleet.run(150 * S)
    assert rows(fleet, 'driven') == [(number * HORIZON_NS, 'driven') for number in range(3)]
    pose = fleet.robot('r').pose
    assert (pose.x, pose.y) == pytest.approx((2.0 * math.sin(75.0), 2.0 - 2.0 * math.cos(75.0)), abs=1e-9)
    assert fleet.robot('r').distance == pytest.approx(150.0)


def test_a_command_at_the_instant_of_the_watchdog_comes_after_it_and_counts_alone():
    speeds = []
    for at_ns in (500 * MS - 1, 500 * MS):
        fleet = fleet_of(linear={'x': limited(-1.0, 1.0, -2.0, 2.0)})
        fleet.robot('r').drive(1.0)
        fleet.run(at_ns)
        fleet.robot('r').drive(1.0)
        fleet.robot('r').drive(-1.0)  # the last one counts, as if the others had not come
        fleet.robot('r').drive(1.0)
        fleet.run(600 * MS)
        speeds.append(velocity(fleet)[0])
    assert speeds == [pytest.approx(1.0)] * 2  # no step back
    fleet = fleet_of()
    fleet.robot('r').drive(1.0)
    fleet.run(500 * MS)
    fleet.robot('r').drive(1.0)
    fleet.run()
    assert rows(fleet, 'driven', 'stands') == [
        (0, 'driven'), (500 * MS, 'stands'), (500 * MS, 'driven'), (S, 'stands')]
    assert fleet.robot('r').pose == Pose2D(1.0)


def test_commands_that_change_nothing_make_no_row():
    fleet = fleet_of()
    for number in range(100):
        fleet.run(number * 100 * MS)
        fleet.robot('r').drive(0.3, 0.1)
    fleet.run()
    assert rows(fleet, 'driven', 'pieces', 'stands') == [
        (0, 'driven'), (0, 'pieces'), (9900 * MS + 500 * MS, 'stands')]


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


def test_an_acceleration_is_limited_in_steps_of_the_control_period():
    fleet = fleet_of(control_period=0.1, linear={'x': limited(-0.5, 1.0, -4.0, 2.0)}, cmd_vel_timeout=1.0)
    fleet.robot('r').drive(7.0)
    found = []
    for number in range(16):
        fleet.run(number * 100 * MS)
        found.append(velocity(fleet)[0])
        if number == 3:
            fleet.robot('r').drive(7.0)  # changes nothing, and no step comes sooner
    assert found == pytest.approx([0.2, 0.4, 0.6, 0.8] + [1.0] * 9 + [0.6, 0.2, 0.0])
    fleet.run(fleet.now_ns + 50 * MS)
    fleet.robot('r').drive(-3.0)
    fleet.run(fleet.now_ns + 40 * MS)
    assert velocity(fleet)[0] == 0.0  # the last step was less than a period ago
    fleet.run(fleet.now_ns + 200 * MS)
    assert velocity(fleet)[0] == pytest.approx(-0.5)


def test_a_long_ramp_goes_on_in_parts():
    fleet = fleet_of(control_period=0.01, linear={'x': limited(-9.0, 9.0, -0.5, 0.5)}, cmd_vel_timeout=0.0)
    fleet.robot('r').drive(9.0)
    fleet.run(30 * S)
    assert velocity(fleet)[0] == 9.0
    steps = [0.005 * number for number in range(1, 1801)]
    assert fleet.robot('r').distance == pytest.approx(0.01 * sum(steps) + 9.0 * (30.0 - 18.0))
    assert len(rows(fleet, 'driven')) == 2


@pytest.mark.parametrize('kind', ['abort', 'stuck', 'silent'])
def test_a_robot_that_has_failed_or_is_held_stands_and_its_commands_are_lost(kind):
    fleet = fleet_of(failure_kind=kind)
    robot = fleet.robot('r')
    robot.drive(1.0)
    fleet.run(100 * MS)
    assert robot.fail()
    robot.drive(1.0)
    fleet.run(S)
    assert robot.pose == Pose2D(0.1) and robot.repair()
    fleet.run(2 * S)
    assert robot.pose == Pose2D(0.1)
    robot.drive(1.0)
    robot.hold('a reason')
    robot.drive(1.0)
    robot.release('a reason')
    fleet.run(3 * S)
    assert robot.pose == Pose2D(0.1)
    robot.drive(1.0)
    fleet.run(4 * S)
    assert robot.pose == Pose2D(0.6)


@pytest.mark.parametrize('rate', [{'failures_per_km': 200.0}, {'failures_per_hour': 720.0}])
def test_failures_come_by_the_distance_and_by_the_time_driven(rate):
    fleet = fleet_of(failure_kind='abort', cmd_vel_timeout=0.0, repair_time=1.0, holonomic=True, **rate)
    robot = fleet.robot('r')
    for number in range(300):
        fleet.run(number * S)
        robot.drive(1.0, 0.2 * (-1) ** number)
    assert robot.condition.failing.count == len(rows(fleet, 'failed'))
    assert len(rows(fleet, 'failed')) == pytest.approx(0.2 * robot.distance, rel=0.4)


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


def test_goals_are_refused_in_words_and_do_not_stop_the_robot():
    fleet = fleet_of()
    fleet.robot('r').drive(1.0)
    fleet.run(200 * MS)
    fleet.robot('r').send(3.0, 4.0)
    fleet.run()
    [ended] = [row for row in fleet.trace if row.kind == 'ended']
    assert ended.values[1] == 'ABORTED' and 'driven by velocities' in ended.values[2]
    assert fleet.robot('r').pose == Pose2D(0.5)


def test_a_robot_that_is_put_elsewhere_drives_on_and_one_that_is_reset_stands():
    fleet = fleet_of()
    fleet.robot('r').drive(1.0)
    fleet.run(200 * MS)
    fleet.robot('r').place(Pose2D(5.0, 5.0, 0.5 * math.pi))
    fleet.run()
    pose = fleet.robot('r').pose
    assert (pose.x, pose.y) == pytest.approx((5.0, 5.3))
    fleet.robot('r').drive(1.0)
    fleet.reset()
    fleet.run(5 * S)
    assert fleet.robot('r').pose == Pose2D()


class Wall:
    """A body that is blocked while ``is_there``."""

    is_there = True

    def is_blocked(self, _motion, _now_ns):
        return self.is_there

    def leave(self):
        pass


def test_a_robot_that_stalls_stands_until_a_command_leads_away():
    fleet = fleet_of()
    driver = fleet.robot('r')._driver
    driver.body = Wall()
    fleet.robot('r').drive(1.0)
    fleet.run(100 * MS)
    driver.stall(fleet.now_ns, 'wall')
    for _ in range(2):
        fleet.robot('r').drive(1.0)
    fleet.run(200 * MS)
    assert driver.is_stalled and fleet.robot('r').pose == Pose2D(0.1)
    driver.body.is_there = False
    fleet.robot('r').drive(1.0)
    fleet.run()
    assert not driver.is_stalled and fleet.robot('r').pose == Pose2D(0.6)
    assert rows(fleet, 'driven', 'stands', 'stalled') == [
        (0, 'driven'), (100 * MS, 'stands'), (100 * MS, 'stalled'), (200 * MS, 'driven'), (700 * MS, 'stands')]


def test_the_end_of_the_plane_stalls():
    fleet = fleet_of(start_x=1e9 - 10.0)
    fleet.robot('r').drive(1.0)
    fleet.run()
    fleet.robot('r').drive(1.0)
    assert [row.values for row in fleet.trace if row.kind == 'stalled'] == [('farthest position',)]
    fleet.robot('r').drive(-1.0)
    fleet.run()
    assert fleet.robot('r').pose == Pose2D(1e9 - 10.5)


@pytest.mark.parametrize('parameters, words', [
    ({'cmd_vel_timeout': 0.5, 'base_watchdog_timeout': 0.2},
     'base_watchdog_timeout: got 0.2 with cmd_vel_timeout: 0.5'),
    ({'linear': {'x': {'has_velocity_limits': True}}}, 'linear/x/max_velocity'),
    ({'linear': {'z': {}}}, 'did you mean|allowed: x, y'),
    ({'linear': {'x': {'has_jerk_limits': True}}}, 'the jerk is not limited here'),
    ({'angular': 3.0}, 'a mapping with z'),
    ({'angular': {'z': {'max_velocity': 'fast'}}}, 'angular/z/max_velocity'),
    ({'driven_by': 'wheels'}, 'goals')])
def test_parameters_that_are_not_allowed_are_refused_in_words(parameters, words):
    with pytest.raises(ConfigurationError, match=words):
        fleet_of(**parameters)


@pytest.mark.parametrize('key, value', [('dispatcher', {'policy': 'nearest'}), (
    'orders', [{'name': 'picks', 'rate_per_hour': 20.0, 'stops': [{'place': 'dock'}]}])])
def test_a_dispatcher_has_no_robots_that_are_driven_by_velocities(key, value):
    with pytest.raises(ConfigurationError, match="robot 'r': driven_by: got 'velocities' with orders or a dispatcher"):
        make_scenario({'robots': [{'name': 'g'}, {'name': 'r', 'driven_by': 'velocities'}],
                       'places': [{'name': 'dock', 'x': 1.0, 'y': 2.0}], key: value})


def test_calls_that_are_not_allowed_are_refused_in_words():
    robot = fleet_of().robot('r')
    for values, words in (((math.nan,), 'finite'), ((0.0, 2e6), 'within'), ((1.0, 0.0, 0.5), 'holonomic: true'),
                          (('fast',), 'a number')):
        with pytest.raises(ConfigurationError, match=words):
            robot.drive(*values)
    with pytest.raises(ConfigurationError, match='driven_by: got .goals.; allowed: velocities'):
        Fleet(make_scenario({'robots': [{'name': 'r'}]})).robot('r').drive(1.0)
