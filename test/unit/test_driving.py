"""Robots that are driven by velocities, in plain Python: poses against an integral by hand, limits, watchdog, rows."""
import math
import random

import numpy as np
import pytest
from night import times

from driven_robots import MS, S, fleet_of, limited, rows
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.driving.drive_motion import HORIZON_NS
from move_base_abstract.fleet import Fleet
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import make_scenario

NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)


def velocity(fleet):
    """Return (forward, lateral, turning) of the robot now."""
    return fleet.robot('r').navigator.robot.velocity_at(fleet.now_ns)


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


def test_a_ramp_whose_first_part_ends_at_rest_goes_on():
    step = 2.0 ** -7
    fleet = fleet_of(control_period=0.02, linear={'x': limited(-9.0, 9.0, -50.0 * step, 50.0 * step)},
                     cmd_vel_timeout=0.0)
    fleet.robot('r').drive(-1000 * step)
    fleet.run(30 * S)
    fleet.robot('r').drive(1.0)
    fleet.run(60 * S)
    assert velocity(fleet)[0] == 1.0


def test_after_a_restart_of_the_clock_a_limited_robot_sets_off_from_rest_at_its_command():
    fleet = fleet_of(linear={'x': limited(-1.0, 1.0, -2.0, 2.0)})
    robot = fleet.robot('r')
    robot.drive(1.0)
    fleet.run(100 * S)
    fleet.simulation.restart(100 * MS)
    robot.navigator.restart(100 * S, 100 * MS)
    fleet.run(200 * MS)
    robot.drive(1.0)
    assert velocity(fleet)[0] == pytest.approx(0.04)
    fleet.run(300 * MS)
    assert velocity(fleet)[0] == pytest.approx(0.24)


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


def test_a_command_that_waits_while_its_robot_is_removed_is_lost():
    fleet = fleet_of(cmd_vel_timeout=0.0)
    driver = fleet.robot('r')._driver
    fleet.remove('r')
    driver.command(1.0, 0.0, 0.0, fleet.now_ns)  # as one in ROS that has waited for the lock
    fleet.run(100 * S)
    assert rows(fleet, 'driven') == []


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


def test_an_arc_that_leads_beyond_the_end_of_the_plane_and_back_stalls():
    fleet = fleet_of(start_x=1e9)
    fleet.robot('r').drive(1.0, 0.3)
    fleet.run()
    assert [row.values for row in fleet.trace if row.kind == 'stalled'] == [('farthest position',)]


@pytest.mark.parametrize('parameters, words', [
    ({'cmd_vel_timeout': 0.5, 'base_watchdog_timeout': 0.2},
     'base_watchdog_timeout: got 0.2 with cmd_vel_timeout: 0.5'),
    ({'linear': {'x': {'has_velocity_limits': True}}}, 'linear/x/max_velocity'),
    ({'linear': {'z': {}}}, 'did you mean|allowed: x, y'),
    ({'linear': {'x': {'has_jerk_limits': True}}}, 'the jerk is not limited here'),
    ({'angular': 3.0}, 'a mapping with z'),
    ({'angular': {'z': {'max_velocity': 'fast'}}}, '^parameter scenario: robots.0./angular/z/max_velocity: got .fast.'),
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
