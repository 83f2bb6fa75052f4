"""Odometry that drifts: the shares by seed, the pose as a formula, and what does not change."""
import math

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.driving.drive_motion import Twist
from move_base_abstract.driving.odometry import Odometry, drawn_shares
from move_base_abstract.fleet import Fleet
from move_base_abstract.motion.geometry import Pose2D, normalize_angle
from move_base_abstract.scenario import make_scenario

S = 1_000_000_000
SHARES = Twist(1.02, 0.9, 0.95)
DRIVE = [(0.5, 0.0, 0.3), (0.0, 0.0, -1.0), (-0.4, 0.2, 0.0), (0.8, -0.1, 0.7), (0.0, 0.0, 0.0), (0.3, 0.0, 0.0)]


def fleet_of(**parameters):
    return Fleet(make_scenario({'robots': [{
        'name': 'r', 'driven_by': 'velocities', 'holonomic': True, 'cmd_vel_timeout': 0.0, 'start_x': 1.0,
        'start_y': 2.0, 'start_yaw': 0.5, **parameters}]}), 0)


def drive(fleet, odometry):
    """Drive for 6 s; yield the time [ns] every 0.25 s."""
    for forward, lateral, turning in DRIVE:
        fleet.robot('r').drive(forward, turning, lateral)
        for _ in range(4):
            fleet.run_for(0.25)
            yield fleet.now_ns


def by_hand(seconds, shares, start=(0.0, 0.0, 0.0)):
    """Return the pose in the odom frame after so many s, integrated in steps of 0.1 ms at the middle of each."""
    x, y, yaw = start
    for step in range(round(seconds * 10_000)):
        forward, lateral, turning = (one * share for one, share in zip(DRIVE[step // 10_000], shares))
        middle = yaw + turning * 0.5e-4
        x += (forward * math.cos(middle) - lateral * math.sin(middle)) * 1e-4
        y += (forward * math.sin(middle) + lateral * math.cos(middle)) * 1e-4
        yaw += turning * 1e-4
    return x, y, yaw


def test_the_pose_is_that_of_velocities_times_their_shares():
    fleet = fleet_of()
    robot = fleet.robot('r').navigator.robot
    odometry = Odometry(robot, Pose2D(1.0, 2.0, 0.5), 0, SHARES)
    for now_ns in drive(fleet, odometry):
        pose = odometry.pose_at(now_ns)
        x, y, yaw = by_hand(now_ns / S, SHARES)
        assert (pose.x, pose.y) == pytest.approx((x, y), abs=1e-8)
        assert normalize_angle(pose.yaw - yaw) == pytest.approx(0.0, abs=1e-9)
        assert odometry.velocity_at(now_ns) == pytest.approx([
            one * share for one, share in zip(robot.velocity_at(now_ns), SHARES)])
        true = robot.pose_at(now_ns)
        seen = odometry.origin_at(true, pose).compose(pose)
        assert (seen.x, seen.y, seen.yaw) == pytest.approx((true.x, true.y, true.yaw))
    past = odometry.pose_at(5 * S // 2)  # it remembers
    assert (past.x, past.y) == pytest.approx(by_hand(2.5, SHARES)[:2], abs=1e-8)
    assert odometry.drifts


def test_without_an_error_it_is_the_pose_from_the_origin():
    fleet = fleet_of()
    robot = fleet.robot('r').navigator.robot
    origin = Pose2D(-3.0, 1.0, 1.5)
    plain = Odometry(robot, origin, 0, drawn_shares((0.0, 0.0, 0.0), 1, 'r'))
    assert not plain.drifts
    for now_ns in drive(fleet, plain):
        true, again = robot.pose_at(now_ns), origin.compose(plain.pose_at(now_ns))
        assert (true.x, true.y) == pytest.approx((again.x, again.y), abs=1e-12)
        assert normalize_angle(true.yaw - again.yaw) == pytest.approx(0.0, abs=1e-12)


def test_a_teleport_changes_nothing_and_a_reset_begins_anew():
    fleet = fleet_of()
    robot = fleet.robot('r').navigator.robot
    odometry = Odometry(robot, Pose2D(), 0, SHARES)
    fleet.robot('r').drive(0.5)
    fleet.run(1 * S)
    before = odometry.pose_at(1 * S)
    fleet.robot('r').place(Pose2D(7.0, -3.0, 1.0))
    assert odometry.pose_at(1 * S) == before
    fleet.run(2 * S)  # it drives on
    pose = odometry.pose_at(2 * S)
    assert math.hypot(pose.x - before.x, pose.y - before.y) == pytest.approx(0.5 * 1.02)
    odometry.reset(2 * S)
    assert odometry.pose_at(2 * S) == robot.pose_at(2 * S)


@pytest.mark.parametrize('anew_ns', [0, 5 * S])  # before the motion began, and while it was under way
def test_when_the_clock_starts_anew_it_begins_at_the_true_pose(anew_ns):
    fleet = fleet_of()
    robot = fleet.robot('r').navigator.robot
    odometry = Odometry(robot, Pose2D(), 0, SHARES)
    fleet.run(1 * S)
    fleet.robot('r').drive(0.5)
    fleet.run(10 * S)
    odometry.forget()
    robot.restart(10 * S, anew_ns)
    assert odometry.pose_at(anew_ns) == robot.pose_at(anew_ns) != Pose2D(1.0, 2.0, 0.5)


def test_the_shares_are_drawn_by_the_seed_and_the_name_within_half_of_the_range():
    found = [drawn_shares((0.04, 0.0, 0.1), seed, 'r') for seed in range(200)]
    assert found == [drawn_shares((0.04, 0.0, 0.1), seed, 'r') for seed in range(200)]
    assert found[0] != drawn_shares((0.04, 0.0, 0.1), 0, 'other')
    for place, half in ((0, 0.02), (2, 0.05)):
        values = sorted(shares[place] - 1.0 for shares in found)
        assert -half <= values[0] < -0.95 * half
        assert 0.95 * half < values[-1] <= half
        assert abs(sum(values) / 200) < 0.2 * half
    assert {shares[1] for shares in found} == {1.0}


def test_the_truth_does_not_change():
    traces = []
    for parameters in ({}, {'odom_error': [0.03, 0.03, 0.0, 0.05]}):
        fleet = fleet_of(log_motion=True, **parameters)
        for _ in drive(fleet, None):
            pass
        traces.append(fleet.trace)
    assert traces[0] == traces[1]


def test_what_is_no_error_is_refused():
    for wrong in ([0.1, 0.1], [0.1, 0.1, 0.0, 2.0], 'much', [0.1, -0.1, 0.0, 0.0]):
        with pytest.raises(ConfigurationError, match='odom_error'):
            fleet_of(odom_error=wrong)
