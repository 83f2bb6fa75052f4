"""The odometry of a robot under velocities, and the parameters that say what it publishes."""
import math
import random

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.config.settings import read_settings
from move_base_abstract.driving.drive_motion import DriveMotion, Twist
from move_base_abstract.driving.odometry import Odometry
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.robot import Robot
from move_base_abstract.motion.told import ToldMotion, told

NS = 10 ** 9
ORIGIN = Pose2D(2.0, -1.0, 0.7)


def settings(**raw):
    return read_settings({'driven_by': 'velocities', **raw}, '/robot')


def driven(twists, start=Pose2D(3.0, 1.0, -2.5)):
    """Return (a robot that drives with each of the twists for a second, its odometry)."""
    robot = Robot(0, 'robot', start)
    odometry = Odometry(robot, ORIGIN, 0)
    robot.set_off(DriveMotion(start, [(at * NS, twist) for at, twist in enumerate(twists)], len(twists) * NS), 0)
    return robot, odometry


def test_it_is_the_motion_of_the_robot_seen_from_the_origin():
    chance = random.Random(3)
    twists = [Twist(*(chance.uniform(-1.0, 1.0) for _ in range(3))) for _ in range(20)]
    robot, odometry = driven(twists)
    for _ in range(500):
        now_ns = chance.randrange(21 * NS)
        seen, true = odometry.pose_at(now_ns), robot.pose_at(now_ns)
        again = ORIGIN.compose(seen)
        assert math.hypot(again.x - true.x, again.y - true.y) < 1e-12
        assert math.cos(again.yaw - true.yaw) == pytest.approx(1.0, abs=1e-12)
        assert odometry.velocity_at(now_ns) == robot.velocity_at(now_ns)


def test_what_is_told_of_it_has_its_poses_and_the_very_speed_of_a_robot_that_drives_straight_ahead():
    _, odometry = driven([Twist(0.3, 0.0, 0.0), Twist(0.3, 0.0, 0.4), Twist(-0.2, 0.0, -1.1)])
    motion = ToldMotion(told(odometry.motion))
    for now_ns in range(0, 4 * NS, NS // 7):
        assert motion.pose_at(now_ns) == odometry.pose_at(now_ns)
        assert motion.velocity_at(now_ns) == odometry.velocity_at(now_ns)


def test_it_has_no_motion_while_the_robot_stands_and_a_new_one_for_each_motion():
    robot, odometry = driven([Twist(0.3, 0.0, 0.0)])
    first = odometry.motion
    assert odometry.motion is first
    robot.stop(NS // 2)
    assert odometry.motion is None
    assert odometry.pose_at(NS) == ORIGIN.inverse().compose(robot.pose_at(NS))
    robot.place(Pose2D(9.0, 9.0), NS)
    assert odometry.pose_at(NS) == ORIGIN.inverse().compose(Pose2D(9.0, 9.0))


@pytest.mark.parametrize('theirs, own', [('base_frame_id', 'robot_base_frame'), ('odom_frame_id', 'odom_frame')])
def test_the_names_of_diff_drive_controller_count_and_both_are_an_error(theirs, own):
    assert settings(**{theirs: 'other'}).values[own] == 'other'
    with pytest.raises(ConfigurationError, match=f"/robot/{theirs}: got 'other' with {own}: mine"):
        settings(**{theirs: 'other', own: 'mine'})


def test_names_and_places_that_are_not_set_are_those_of_stage_ros():
    found = settings(start_x=1.0, start_yaw=0.5)
    assert found.odom_origin == Pose2D(1.0, 0.0, 0.5)
    assert (found.footprint_frame, found.values['scan_topic']) == ('base_footprint', 'base_scan')
    assert settings(odom_origin=[1, 2, 3.0]).odom_origin == Pose2D(1.0, 2.0, 3.0)
    with pytest.raises(ConfigurationError, match=r'odom_origin: got .*; allowed: a list .* in -1e9\.\.1e9'):
        settings(odom_origin=[0.0, 2e9, 0.0])
    assert settings(robot_base_frame='base_footprint').footprint_frame == ''
    assert settings(footprint_frame='').footprint_frame == ''
    assert settings(publish_rate=50.0).values['pose_update_freq'] == 50.0
    assert read_settings({}, '/robot').values['scan_topic'] == 'scan'


def test_without_driven_by_they_have_no_effect_and_are_listed():
    assert read_settings({'publish_rate': 50.0}, '/robot').needs == {'publish_rate': 'driven_by: velocities'}
