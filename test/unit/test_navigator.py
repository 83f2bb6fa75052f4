"""The life of a goal: whole traces of what a client, RViz and a log would see, with poses and stamps exact."""

import math

import pytest
from hypothesis import given, strategies as st

from move_base_abstract.common.units import NS_PER_S, seconds_to_ns
from move_base_abstract.goals.navigator import BadFramePolicy
from move_base_abstract.goals.outcome import NODE_KILLED
from move_base_abstract.goals.recovery import RecoveryPolicy
from move_base_abstract.maps.planning import WorldBounds
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.leg import MotionLimits, Tolerances

S = NS_PER_S
UP = math.pi / 2
STOP = ('stop wheels',)
ANOTHER = 'This goal was canceled because another goal was received by the simple action server'
BAD_QUATERNION = 'Aborting on goal because it was sent with an invalid quaternion'
TILTED = 'Quaternion is invalid... for navigation the z-axis of the quaternion must be close to vertical.'
NO_PLAN = 'Failed to find a valid plan. Even after executing recovery behaviors.'


def begins(pose, time_ns):
    """Return what is told when the robot sets off for ``pose``."""
    return [STOP, ('target', pose, time_ns), ('departed', pose, time_ns)]


def reaches(goal_id, pose, time_ns, with_feedback=False):
    told = [('feedback', goal_id, pose, time_ns)] if with_feedback else []
    return [('stands', pose, time_ns), *told, STOP, ('result', goal_id, 'SUCCEEDED', 'Goal reached.', time_ns)]


def cancelled(goal_id, pose, time_ns):
    return [('stands', pose, time_ns), STOP, ('result', goal_id, 'PREEMPTED', '', time_ns)]


def replaced(goal_id, time_ns):
    return [('result', goal_id, 'PREEMPTED', ANOTHER, time_ns)]


def aborted(goal_id, text, time_ns):
    return [STOP, ('result', goal_id, 'ABORTED', text, time_ns)]


def bad_frame(frame_id, words):
    return "Failed to transform the goal pose from '{}' into the 'map' frame: {}".format(frame_id, words)


# ---- travelling

def test_a_goal_is_reached_at_start_plus_duration_however_late_the_clock_says_so(rig):
    robot = rig()
    robot.advance(1.25)
    goal = Pose2D(20.0, 0.0, 1.0)
    assert robot.send('g', 20.0, 0.0, 1.0) == begins(goal, 1_250_000_000)
    assert robot.advance(11.249999999) == []
    assert robot.advance(1000.0) == reaches('g', goal, 11_250_000_000)
    assert (robot.navigator.is_active, robot.simulation.next_due_ns()) == (False, None)


@given(st.floats(-100, 100), st.floats(-100, 100), st.floats(0.1, 5.0), st.floats(0.1, 5.0) | st.just(math.inf),
       st.integers(0, 10 ** 12))
def test_any_goal_is_reached_exactly_and_at_the_nanosecond_of_its_leg(rig, x, y, speed, acceleration, depart_ns):
    robot = rig(limits=MotionLimits(speed, acceleration))
    robot.simulation.advance(depart_ns)
    robot.send('g', x, y)
    distance = math.hypot(x, y)
    full = distance >= speed * speed / acceleration
    seconds = distance / speed + speed / acceleration if full else 2.0 * math.sqrt(distance / acceleration)
    arrive_ns = robot.simulation.next_due_ns()
    assert arrive_ns - depart_ns == pytest.approx(seconds * 1e9, abs=1, rel=1e-12)
    robot.simulation.advance(arrive_ns)
    assert robot.told() == reaches('g', Pose2D(x, y), arrive_ns)


def test_goals_in_a_row_accumulate_nothing(rig):
    robot = rig(limits=MotionLimits(0.3))
    for k in range(1, 1001):
        robot.send('g{}'.format(k), float(k), 0.0)
        robot.simulation.advance(robot.simulation.next_due_ns())
        assert robot.told()[-1] == ('result', 'g{}'.format(k), 'SUCCEEDED', 'Goal reached.', k * 3_333_333_333)
    assert robot.robot.distance_at(robot.simulation.now_ns) == 1000.0


def test_a_goal_where_the_robot_is_already_is_reached_at_that_instant(rig):
    robot = rig(start=Pose2D(1.0, 2.0, 3.0))
    robot.advance(4.0)
    place = Pose2D(1.0, 2.0, robot.robot.pose_at(0).yaw)
    robot.send('g', 1.0, 2.0, place.yaw)
    assert robot.advance(4.0)[-1] == ('result', 'g', 'SUCCEEDED', 'Goal reached.', 4 * S)
    assert robot.robot.pose_at(4 * S).distance_to(place) == 0.0


def test_the_robot_stops_within_its_tolerance(rig):
    robot = rig(tolerances=Tolerances(xy=0.5))
    robot.send('g', 4.5, 0.0)
    assert robot.advance(9.0) == reaches('g', Pose2D(4.0, 0.0), 2 * S)


def test_a_goal_too_far_for_any_arrival_time_ends_at_once(rig):
    robot = rig(start=Pose2D(-1e9, -1e9), limits=MotionLimits(1.0))
    trace = robot.send('g', 1e9, 1e9)
    assert trace[-1][:3] == ('result', 'g', 'ABORTED') and trace[-1][3].startswith('The goal cannot be travelled to: ')
    assert robot.send('h', 2.0 - 1e9, -1e9) == begins(Pose2D(2.0 - 1e9, -1e9), 0)


# ---- cancel, pre-emption, shut-down

@pytest.mark.parametrize('goal_id', ['', 'g'])
def test_a_cancel_leaves_the_robot_at_its_exact_pose_of_that_instant(rig, goal_id):
    robot = rig(start=Pose2D(1.0, 1.0))
    robot.send('g', 21.0, 1.0)
    robot.advance(3.5)
    assert robot.cancel(goal_id) == cancelled('g', Pose2D(8.0, 1.0), 3_500_000_000)
    assert robot.advance(99.0) == []
    assert robot.robot.pose_at(99 * S) == Pose2D(8.0, 1.0)


def test_a_cancel_for_somebody_else_lets_the_robot_go_on(rig):
    robot = rig()
    robot.send('g', 4.0, 0.0)
    assert robot.cancel('other') == []
    assert robot.advance(2.0) == reaches('g', Pose2D(4.0, 0.0), 2 * S)


def test_a_cancel_at_the_instant_of_the_arrival_comes_too_late(rig):
    robot = rig()
    robot.send('g', 4.0, 0.0)
    assert robot.advance(2.0) == reaches('g', Pose2D(4.0, 0.0), 2 * S)
    assert robot.cancel('g') == []


def test_a_new_goal_starts_from_the_exact_pose_of_its_instant_and_the_old_arrival_is_forgotten(rig):
    robot = rig()
    robot.send('old', 20.0, 0.0)
    robot.advance(3.5)
    assert robot.send('new', 7.0, 4.0) == [
        *replaced('old', 3_500_000_000), ('stands', Pose2D(7.0, 0.0), 3_500_000_000),
        *begins(Pose2D(7.0, 4.0), 3_500_000_000)[1:]]  # no word to the wheels
    assert robot.advance(99.0) == reaches('new', Pose2D(7.0, 4.0), 5_500_000_000)


def test_a_new_goal_in_the_midst_of_accelerating_starts_from_rest(rig):
    robot = rig(limits=MotionLimits(2.0, 1.0))
    robot.send('old', 20.0, 0.0)
    robot.advance(1.0)
    assert robot.send('new', 1.5, 0.0)[1] == ('stands', Pose2D(0.5, 0.0), S)
    assert robot.advance(99.0) == reaches('new', Pose2D(1.5, 0.0), 3 * S)


def test_of_three_quick_goals_the_last_one_runs(rig):
    robot = rig()
    robot.advance(1.0)
    trace = [line for k in (1, 2, 3) for line in robot.send('g{}'.format(k), 2.0 * k, 0.0)]
    assert [line for line in trace if line[0] == 'result'] == replaced('g1', S) + replaced('g2', S)
    assert robot.advance(9.0) == reaches('g3', Pose2D(6.0, 0.0), 4 * S)


def test_a_stale_goal_is_recalled_and_the_robot_goes_on(rig):
    robot = rig()
    robot.advance(5.0)
    robot.send('g', 4.0, 0.0, id_stamp=4.0)
    robot.advance(6.0)
    assert robot.send('stale', 0.0, 9.0, id_stamp=3.0) == [('result', 'stale', 'RECALLED', ANOTHER, 6 * S)]
    assert robot.send('g', 0.0, 9.0, id_stamp=6.0) == []
    assert robot.advance(9.0) == reaches('g', Pose2D(4.0, 0.0), 7 * S)


def test_a_killed_node_aborts_its_goal_where_the_robot_is(rig):
    robot = rig()
    robot.send('g', 20.0, 0.0)
    robot.advance(1.0)
    robot.navigator.shut_down(NODE_KILLED, S)
    assert robot.told() == [('stands', Pose2D(2.0, 0.0), S),
                            *aborted('g', 'Aborting on the goal because the node has been killed', S)]
    robot.navigator.shut_down(NODE_KILLED, S)
    assert robot.advance(99.0) == []


# ---- goals that are no goals

@pytest.mark.parametrize('quaternion, fault', [
    ((0.0, 0.0, math.nan, 1.0), 'Quaternion has nans or infs... discarding as a navigation goal'),
    ((0.0, 0.0, 0.0, 0.0), 'Quaternion has length close to zero... discarding as navigation goal'),
    ((1.0, 0.0, 0.0, 0.0), TILTED)])
def test_a_bad_quaternion_aborts_the_goal_and_ends_the_active_one_without_stopping_the_wheels(rig, quaternion, fault):
    robot = rig(feedback_freq=1.0)
    refused = [('warn', fault), ('result', 'bad', 'ABORTED', BAD_QUATERNION, 0)]
    assert robot.send('bad', 1.0, 1.0, quaternion=quaternion) == refused
    robot.send('good', 20.0, 0.0)
    robot.advance(1.0)
    assert robot.send('worse', 1.0, 1.0, quaternion=quaternion) == [
        *replaced('good', S), ('stands', Pose2D(2.0, 0.0), S), ('warn', fault),
        ('result', 'worse', 'ABORTED', BAD_QUATERNION, S)]
    assert robot.advance(99.0) == []


def test_a_quaternion_of_another_length_is_accepted(rig):
    robot = rig()
    assert robot.send('g', 2.0, 0.0, quaternion=(0.0, 0.0, 0.0, 7.0)) == begins(Pose2D(2.0, 0.0), 0)


@pytest.mark.parametrize('frame', ['map', 'base_link'])
@pytest.mark.parametrize('position', [(math.nan, 0.0), (0.0, math.inf)])
def test_a_position_that_is_not_finite_ends_at_once_and_the_next_goal_runs(rig, position, frame):
    robot = rig()
    name, value = ('x', math.nan) if math.isnan(position[0]) else ('y', math.inf)
    trace = robot.send('g', *position, frame=frame)
    assert [line[:3] for line in trace] == [STOP, ('result', 'g', 'ABORTED')]
    assert trace[-1][3].startswith('The goal is not a place: pose: {} must be finite, got {!r}'.format(name, value))
    assert robot.send('next', 2.0, 0.0) == begins(Pose2D(2.0, 0.0), 0)


@pytest.mark.parametrize('frame, words', [
    ('nowhere', "'nowhere' is not known to tf"),
    ('', 'the frame_id is empty; a goal must name the frame it is given in'),
    ('/map', "a frame_id must not begin with a slash; did you mean 'map'?")])
def test_a_goal_in_a_frame_that_is_not_known_ends_at_once_with_its_name(rig, frame, words):
    robot = rig()
    text = bad_frame(frame, words)
    assert robot.send('g', 1.0, 0.0, frame=frame) == [('warn', text), *aborted('g', text, 0)]
    assert robot.advance(9.0) == []


@pytest.mark.parametrize('frame', ['nowhere', '', '/map'])
def test_under_the_policy_wait_it_is_tried_twenty_times_a_second_until_it_is_cancelled(rig, frame):
    robot = rig(bad_frame_policy=BadFramePolicy.WAIT)
    warning, = robot.send('g', 1.0, 0.0, frame=frame)
    assert warning[1].startswith("Failed to transform the goal pose from '{}' into the 'map' frame: ".format(frame))
    assert robot.advance(1.0) == [warning] * 20
    assert robot.cancel('g') == [STOP, ('result', 'g', 'PREEMPTED', '', S)]
    assert robot.advance(9.0) == []


def test_under_the_policy_wait_the_robot_sets_off_as_soon_as_the_frame_is_known(rig):
    robot = rig(bad_frame_policy=BadFramePolicy.WAIT)
    robot.send('g', 1.0, 0.0, frame='dock')
    robot.advance(0.12)
    robot.foreign['dock'] = lambda _stamp_ns: Pose2D(3.0, 0.0)
    assert robot.advance(9.0) == begins(Pose2D(4.0, 0.0), 150_000_000) + reaches('g', Pose2D(4.0, 0.0), 2_150_000_000)


# ---- frames and stamps

@pytest.mark.parametrize('stamp', [0.0, 1.0, 50.0])
@pytest.mark.parametrize('frame', ['map', 'odom'])
def test_in_a_fixed_frame_no_stamp_makes_a_difference(rig, frame, stamp):
    robot = rig()
    robot.advance(3.0)
    assert robot.send('g', 4.0, 0.0, frame=frame, stamp=stamp) == begins(Pose2D(4.0, 0.0), 3 * S)


@pytest.mark.parametrize('stamp, x', [(0.0, 7.0), (3.0, 7.0), (2.0, 5.0)])
def test_a_goal_in_base_link_is_taken_from_the_pose_of_its_stamp_or_of_now(rig, stamp, x):
    robot = rig()
    robot.send('old', 20.0, 0.0)
    robot.advance(3.0)
    assert robot.send('g', 1.0, 0.0, frame='base_link', stamp=stamp)[-1] == ('departed', Pose2D(x, 0.0), 3 * S)


def test_a_goal_in_base_link_of_the_future_waits_and_then_takes_the_pose_of_that_instant(rig):
    robot = rig()
    robot.advance(1.0)
    assert robot.send('g', 1.0, 0.0, frame='base_link', stamp=3.5) == []
    robot.advance(2.0)
    assert robot.place(Pose2D(5.0, 5.0, UP)) == [('stands', Pose2D(5.0, 5.0, UP), 2 * S)]
    trace = robot.advance(99.0)
    assert [line[0] for line in trace] == ['stop wheels', 'target', 'departed', 'stands', 'stop wheels', 'result']
    assert (trace[1][1].x, trace[1][1].y, trace[1][1].yaw) == pytest.approx((5.0, 6.0, UP))
    assert [line[2] for line in trace[1:4]] == [3_500_000_000, 3_500_000_000, 4 * S]
    assert trace[-1] == ('result', 'g', 'SUCCEEDED', 'Goal reached.', 4 * S)


def test_a_goal_of_the_future_can_be_cancelled_and_replaced_while_it_waits(rig):
    robot = rig()
    robot.send('a', 1.0, 0.0, frame='base_link', stamp=5.0)
    robot.advance(1.0)
    assert robot.cancel('a') == [STOP, ('result', 'a', 'PREEMPTED', '', S)]
    robot.send('b', 1.0, 0.0, frame='base_link', stamp=5.0)
    assert robot.send('c', 2.0, 0.0) == [*replaced('b', S), *begins(Pose2D(2.0, 0.0), S)[1:]]
    assert robot.advance(99.0) == reaches('c', Pose2D(2.0, 0.0), 2 * S)


# ---- feedback

def feedback(goal_id, *samples):
    return [('feedback', goal_id, Pose2D(x, 0.0), seconds_to_ns(t)) for x, t in samples]


def test_feedback_comes_on_a_grid_from_the_goals_start_and_at_its_end(rig):
    robot = rig(feedback_freq=4.0)
    robot.advance(1.1)
    assert robot.send('g', 2.0, 0.0) == begins(Pose2D(2.0, 0.0), 1_100_000_000)
    trace = [line for k in range(200) for line in robot.advance(1.1 + k / 100.0)]
    assert trace == [*feedback('g', (0.0, 1.1), (0.5, 1.35), (1.0, 1.6), (1.5, 1.85)),
                     *reaches('g', Pose2D(2.0, 0.0), 2_100_000_000, with_feedback=True)]


def test_a_clock_that_leaps_over_the_arrival_has_feedback_end_at_the_goal_all_the_same(rig):
    robot = rig(feedback_freq=20.0)
    robot.send('g', 2.0, 0.0)
    assert robot.advance(0.4) == feedback('g', (0.0, 0.0))
    assert robot.advance(1000.0) == feedback('g', (0.9, 0.45)) + reaches('g', Pose2D(2.0, 0.0), S, with_feedback=True)


def test_feedback_that_the_clock_leaps_over_is_left_out(rig):
    robot = rig(feedback_freq=4.0)
    robot.send('g', 20.0, 0.0)
    assert [robot.advance(t) for t in (0.0, 1.1, 1.2, 1.25)] == [
        feedback('g', (0.0, 0.0)), feedback('g', (0.5, 0.25)), [], feedback('g', (2.5, 1.25))]


def test_feedback_starts_anew_with_each_goal_and_ends_with_a_cancel(rig):
    robot = rig(feedback_freq=1.0)
    robot.send('a', 20.0, 0.0)
    robot.advance(1.5)
    robot.send('b', 23.0, 0.0)
    assert robot.advance(3.0) == feedback('b', (3.0, 1.5))
    assert robot.advance(3.5) == feedback('b', (7.0, 3.5))
    robot.cancel()
    assert robot.advance(99.0) == []


def test_feedback_comes_while_a_goal_waits_and_while_it_is_out_of_reach(rig):
    robot = rig(feedback_freq=1.0, bounds=WorldBounds(-9.0, -9.0, 9.0, 9.0))
    robot.navigator.set_recovery_policy(RecoveryPolicy(fast=False, behaviors=(), patience=1.5))
    robot.send('a', 1.0, 0.0, frame='base_link', stamp=50.0)
    assert [robot.advance(t) for t in (0.0, 1.0)] == [feedback('a', (0.0, 0.0)), feedback('a', (0.0, 1.0))]
    robot.cancel()
    robot.send('b', 20.0, 0.0)
    assert [robot.advance(t) for t in (1.0, 2.0, 3.0)] == [
        feedback('b', (0.0, 1.0)), feedback('b', (0.0, 2.0)), aborted('b', NO_PLAN, 2_500_000_000)]


def test_the_feedbacks_frequency_can_be_changed_on_the_way(rig):
    robot = rig()
    robot.send('g', 20.0, 0.0)
    assert robot.advance(1.0) == []
    robot.navigator.feedback.set_frequency(2.0)
    assert [robot.advance(t) for t in (1.0, 1.5)] == [feedback('g', (2.0, 1.0)), feedback('g', (3.0, 1.5))]
    robot.navigator.feedback.set_frequency(0.0)
    assert robot.advance(9.0) == []


# ---- teleports

@pytest.mark.parametrize('place, arrive_s', [(Pose2D(20.0, 4.0, UP), 5), (Pose2D(-20.0, 0.0), 23)])
def test_a_teleport_on_the_way_goes_on_to_the_goal_from_there(rig, place, arrive_s):
    robot, goal = rig(), Pose2D(20.0, 0.0)
    robot.send('g', 20.0, 0.0)
    robot.advance(3.0)
    assert robot.place(place) == [('stands', place, 3 * S), ('departed', goal, 3 * S)]
    assert robot.advance(99.0) == reaches('g', goal, arrive_s * S)


def test_a_teleport_of_a_standing_robot_moves_it_and_starts_nothing(rig):
    robot = rig()
    robot.advance(3.0)
    assert robot.place(Pose2D(1.0, 2.0)) == [('stands', Pose2D(1.0, 2.0), 3 * S)]
    assert robot.advance(99.0) == []
    assert robot.robot.pose_at(99 * S) == Pose2D(1.0, 2.0)


def test_new_limits_take_effect_on_the_next_leg(rig):
    robot = rig()
    robot.send('a', 4.0, 0.0)
    robot.robot.set_motion(MotionLimits(1.0), Tolerances())
    assert robot.advance(2.0) == reaches('a', Pose2D(4.0, 0.0), 2 * S)
    robot.send('b', 8.0, 0.0)
    assert robot.advance(99.0) == reaches('b', Pose2D(8.0, 0.0), 6 * S)
