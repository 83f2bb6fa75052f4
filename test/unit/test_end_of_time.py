"""Goals that simulated time is too short for: it ends with the largest ros::Duration, at 2^31 - 1 s."""
import pytest

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.fleet import Fleet
from move_base_abstract.goals.outcome import GoalState
from move_base_abstract.goals.recovery import RecoveryPolicy
from move_base_abstract.maps.planning import WorldBounds
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.leg import MotionLimits
from move_base_abstract.scenario import make_scenario

S = NS_PER_S
END = 2_147_483_647


def too_late(trace):
    """Return the text of the one ending in ``trace``, which aborts the goal 'g' without a departure."""
    (ending,) = [line for line in trace if line[0] == 'result']
    assert ending[1:3] == ('g', 'ABORTED')
    assert not [line for line in trace if line[0] == 'departed']
    return ending[3]


def test_a_goal_that_is_reached_in_the_last_instant_of_time_is_travelled_to(rig):
    robot = rig(limits=MotionLimits(0.25))
    robot.advance(7.0)
    goal = Pose2D(0.25 * (END - 7), 0.0)
    assert ('departed', goal, 7 * S) in robot.send('g', goal.x, 0.0)
    assert robot.advance(float(END))[-1] == ('result', 'g', 'SUCCEEDED', 'Goal reached.', END * S)


@pytest.mark.parametrize('x', [0.25 * (END - 6), 1e9])
def test_a_goal_that_is_reached_after_the_end_of_time_is_aborted_at_once(rig, x):
    robot = rig(limits=MotionLimits(0.25))
    robot.advance(7.0)
    text = too_late(robot.send('g', x, 0.0))
    assert text.startswith('The goal cannot be travelled to: the arrival would be at ')
    assert text.endswith('s, simulated time ends at 2147483647 s')
    assert robot.navigator.robot.leg is None
    assert robot.advance(1000.0) == []
    assert ('departed', Pose2D(2.0, 0.0), 1000 * S) in robot.send('h', 2.0, 0.0)


@pytest.mark.parametrize('limits', [MotionLimits(1e-12), MotionLimits(1e-320), MotionLimits(5e-324, 5e-324),
                                    MotionLimits(1.0, 1e-320), MotionLimits(1.0, 1.0, 1e-12)])
def test_a_robot_that_is_too_slow_for_a_goal_says_so_and_does_not_move(rig, limits):
    robot = rig(limits=limits)
    too_late(robot.send('g', 1e-4, 1.0))
    assert robot.navigator.robot.pose_at(S) == Pose2D()


def test_a_goal_whose_frame_is_asked_for_after_the_end_of_time_is_aborted_at_once(rig):
    robot = rig(longest_wait=2.0 * END)
    text = too_late(robot.send('g', 1.0, 0.0, frame='base_link', stamp=END + 1.0))
    assert text.startswith('The goal cannot be waited for: ')


def test_a_robot_that_would_give_up_after_the_end_of_time_gives_up_at_once(rig):
    robot = rig(bounds=WorldBounds(-5.0, -5.0, 5.0, 5.0))
    robot.navigator.set_recovery_policy(RecoveryPolicy(fast=False, patience=1e10))
    text = too_late(robot.send('g', 50.0, 0.0))
    assert text.startswith('The goal cannot be waited for: the robot would give up at ')
    assert robot.advance(100.0) == []


def test_a_fleet_in_plain_python_ends_and_goes_on():
    fleet = Fleet(make_scenario({'robots': [{'name': 'bot', 'max_speed': 1e-9}]}))
    fleet.robot('bot').send(10.0, 0.0)
    fleet.robot('bot').send(1e-9, 0.0)
    assert fleet.run() == 2 * S
    assert [entry.values[1] for entry in fleet.trace if entry.kind == 'ended'] == [
        GoalState.ABORTED.name, GoalState.SUCCEEDED.name]
