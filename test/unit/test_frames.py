"""The frames a goal may be given in: the robot's own in closed form, others by look-up, and what is refused."""

import math

import pytest

from move_base_abstract.common.errors import FrameError, TimeError
from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.goals.navigator import GoalPose
from move_base_abstract.motion.frames import RobotFrames
from move_base_abstract.motion.geometry import Pose2D, quaternion_fault, yaw_of_quaternion
from move_base_abstract.motion.leg import MotionLimits
from move_base_abstract.motion.robot import Robot

S = NS_PER_S


def make_frames(asked=None, error=None):
    """Return the frames of a robot that left (0, 0) at 1 s for (20, 0) at 2 m/s, in a tf that knows only 'dock'."""
    robot = Robot(0, 'robot_0', limits=MotionLimits(2.0), since_ns=S)
    robot.depart(Pose2D(20.0, 0.0), S)

    def lookup(frame_id, stamp_ns):
        if asked is not None:
            asked.append((frame_id, stamp_ns))
        if error is not None:
            raise error
        return Pose2D(7.0, 8.0, 1.0)

    return RobotFrames(robot, 'map', 'odom', 'base_link', lookup)


@pytest.mark.parametrize('frame_id, fixed, foreign', [
    ('map', True, False), ('odom', True, False), ('base_link', False, False), ('dock', False, True),
    ('/map', False, True), ('', False, False)])
def test_frames_are_told_apart(frame_id, fixed, foreign):
    frames = make_frames()
    assert (frames.is_fixed(frame_id), frames.is_foreign(frame_id)) == (fixed, foreign)


@pytest.mark.parametrize('frame_id', ['map', 'odom'])
@pytest.mark.parametrize('stamp_ns', [0, 2 * S, 99 * S])
def test_the_fixed_frames_are_the_global_one_at_any_time(frame_id, stamp_ns):
    assert make_frames().locate(frame_id, stamp_ns, 3 * S) == Pose2D()


@pytest.mark.parametrize('stamp_ns, x', [(0, 4.0), (3 * S, 4.0), (2 * S, 2.0), (S, 0.0)])
def test_the_base_is_where_the_robot_was_at_the_stamp_or_is_now(stamp_ns, x):
    assert make_frames().locate('base_link', stamp_ns, 3 * S) == Pose2D(x, 0.0)


def test_the_base_before_what_is_remembered_is_an_error_that_names_the_frame():
    with pytest.raises(FrameError) as error:
        make_frames().locate('base_link', S - 1, 3 * S)
    assert str(error.value) == (
        "Failed to transform the goal pose from 'base_link' into the 'map' frame: robot_0: the pose at 999999999 ns "
        'is asked for, but nothing before 1000000000 ns is remembered')


def test_a_foreign_frame_is_looked_up_with_the_goals_own_stamp():
    asked = []
    frames = make_frames(asked)
    places = [frames.locate('dock', stamp_ns, 3 * S) for stamp_ns in (0, 2 * S)]
    assert (places, asked) == ([Pose2D(7.0, 8.0, 1.0)] * 2, [('dock', 0), ('dock', 2 * S)])


@pytest.mark.parametrize('error', [FrameError('no such frame'), TimeError('no such frame')])
def test_a_look_up_that_fails_says_from_where_to_where(error):
    with pytest.raises(FrameError) as raised:
        make_frames(error=error).locate('dock', 0, 3 * S)
    assert str(raised.value) == "Failed to transform the goal pose from 'dock' into the 'map' frame: no such frame"


@pytest.mark.parametrize('frame_id, words', [
    ('', 'the frame_id is empty; a goal must name the frame it is given in'),
    ('/map', "a frame_id must not begin with a slash; did you mean 'map'?"),
    ('//base_link', "a frame_id must not begin with a slash; did you mean 'base_link'?")])
def test_a_name_that_tf_refuses_is_not_looked_up(frame_id, words):
    asked = []
    with pytest.raises(FrameError) as error:
        make_frames(asked).locate(frame_id, 0, 3 * S)
    assert str(error.value) == "Failed to transform the goal pose from '{}' into the 'map' frame: {}".format(
        frame_id, words)
    assert asked == []


@pytest.mark.parametrize('quaternion', [
    (0.0, 0.0, 0.0, 1.0), (-0.0, 0.0, -0.0, 1.0), (0.0, 0.0, 0.0, 2.0), (0, 0, 0, 1)])
def test_straight_ahead_in_a_fixed_frame_is_zero_without_a_sign(quaternion):
    pose = make_frames().place(GoalPose('map', 0, (-0.0, 2.0), quaternion), S)
    assert repr(pose) == repr(Pose2D(0.0, 2.0, 0.0))


def test_a_goals_orientation_is_as_it_was_sent_in_the_global_frame_and_turns_with_another():
    frames = make_frames()
    sent = GoalPose('map', 0, (1.0, 2.0), (0.01, 0.0, 0.0, 2.0), 0.5)
    assert frames.orientation(sent, frames.place(sent, S)) == (0.01, 0.0, 0.0, 2.0)
    ahead = GoalPose('dock', 0, (1.0, 2.0), (0.0, 0.0, 0.0, 1.0))
    place = frames.place(ahead, S)
    assert frames.orientation(ahead, place) == pytest.approx((0.0, 0.0, math.sin(0.5), math.cos(0.5)))
    tilted = GoalPose('dock', 0, (0.0, 0.0), (0.02, 0.0, math.sin(0.25), math.cos(0.25)))
    turned = frames.orientation(tilted, frames.place(tilted, S))
    assert yaw_of_quaternion(turned) == pytest.approx(1.0 + yaw_of_quaternion(tilted.quaternion))
    assert quaternion_fault(turned) is None
