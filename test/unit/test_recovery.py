"""How long a goal that cannot be reached is tried, when each recovery behaviour begins, and what the client sees."""

import math

import pytest

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.goals.recovery import DEFAULT_BEHAVIORS, ROTATION_SECONDS, RecoveryBehavior, RecoveryPolicy
from move_base_abstract.maps.planning import WorldBounds
from move_base_abstract.motion.geometry import Pose2D

S = NS_PER_S
TURN_NS = 6_283_185_307
FIELD = WorldBounds(-10.0, -10.0, 10.0, 10.0)
OUTSIDE = Pose2D(20.0, 0.0)
BEYOND = ('warn', 'The goal (20, 0) lies outside of world_bounds, [-10, -10, 10, 10].')
STOP = ('stop wheels',)
ANOTHER = 'This goal was canceled because another goal was received by the simple action server'
NO_PLAN = 'Failed to find a valid plan. Even after executing recovery behaviors.'


# ---- the schedule

def test_the_behaviours_by_default_are_those_of_move_base():
    assert [(behavior.name, behavior.seconds) for behavior in DEFAULT_BEHAVIORS] == [
        ('conservative_reset', 0.0), ('rotate_recovery', 2 * math.pi),
        ('aggressive_reset', 0.0), ('rotate_recovery', 2 * math.pi)]
    assert 2 * math.pi == ROTATION_SECONDS


def test_the_fast_policy_gives_up_at_once():
    assert RecoveryPolicy().schedule(7 * S) == ([], 7 * S)
    assert RecoveryPolicy(fast=True, patience=99.0).schedule(0) == ([], 0)


def test_upstreams_policy_gives_up_after_25_seconds_and_two_rotations():
    begins, end_ns = RecoveryPolicy(fast=False).schedule(100 * S)
    assert begins == [(105 * S, 0), (110 * S, 1), (115 * S + TURN_NS, 2), (120 * S + TURN_NS, 3)]
    assert end_ns == 125 * S + 2 * TURN_NS
    assert end_ns / NS_PER_S == pytest.approx(125.0 + 4 * math.pi)


def test_without_behaviours_upstreams_policy_gives_up_after_its_patience():
    assert RecoveryPolicy(fast=False, behaviors=()).schedule(S) == ([], 6 * S)


def test_without_patience_the_behaviours_follow_one_another():
    behaviors = (RecoveryBehavior('wait', 1.5), RecoveryBehavior('reset'))
    assert RecoveryPolicy(False, 0.0, behaviors).schedule(0) == ([(0, 0), (1_500_000_000, 1)], 1_500_000_000)
    assert RecoveryPolicy(False, 0.0, ()).schedule(3) == ([], 3)


# ---- a goal out of reach

def begins(goal, time_ns):
    return [STOP, ('target', goal, time_ns), ('departed', goal, time_ns)]


def given_up(goal_id, time_ns):
    return [STOP, ('result', goal_id, 'ABORTED', NO_PLAN, time_ns)]


def make_robot(rig, policy=None):
    robot = rig(bounds=FIELD)
    if policy is not None:
        robot.navigator.set_recovery_policy(policy)
    return robot


def test_a_goal_out_of_reach_is_given_up_at_once_by_default(rig):
    robot = make_robot(rig)
    assert robot.send('g', 20.0, 0.0) == [STOP, ('target', OUTSIDE, 0), BEYOND, *given_up('g', 0)]
    assert robot.send('inside', 10.0, 0.0) == begins(Pose2D(10.0, 0.0), 0)


def test_a_goal_out_of_reach_is_given_up_as_upstream_does_after_25_seconds_and_two_rotations(rig):
    robot = make_robot(rig, RecoveryPolicy(fast=False))
    robot.advance(100.0)
    assert robot.send('g', 20.0, 0.0) == [STOP, ('target', OUTSIDE, 100 * S), BEYOND]
    assert robot.advance(999.0) == [
        ('recovery', 'conservative_reset', 0, 4, 105 * S), ('recovery', 'rotate_recovery', 1, 4, 110 * S),
        ('recovery', 'aggressive_reset', 2, 4, 115 * S + TURN_NS),
        ('recovery', 'rotate_recovery', 3, 4, 120 * S + TURN_NS), *given_up('g', 125 * S + 2 * TURN_NS)]
    assert robot.robot.pose_at(999 * S) == Pose2D()


def test_a_goal_out_of_reach_is_given_up_after_five_seconds_without_recoveries(rig):
    robot = make_robot(rig, RecoveryPolicy(fast=False, behaviors=()))
    robot.send('g', 20.0, 0.0)
    assert robot.advance(4.999999999) == []
    assert robot.advance(99.0) == given_up('g', 5 * S)


def test_recoveries_end_with_a_cancel_and_with_a_new_goal(rig):
    robot = make_robot(rig, RecoveryPolicy(False, 1.0, (RecoveryBehavior('wait', 5.0),) * 2))
    robot.send('a', 20.0, 0.0)
    assert robot.advance(2.0) == [('recovery', 'wait', 0, 2, S)]
    assert robot.cancel('a') == [STOP, ('result', 'a', 'PREEMPTED', '', 2 * S)]
    assert robot.advance(99.0) == []
    robot.send('b', 20.0, 0.0)
    assert robot.send('c', 2.0, 0.0) == [('result', 'b', 'PREEMPTED', ANOTHER, 99 * S),
                                         *begins(Pose2D(2.0, 0.0), 99 * S)[1:]]
    assert robot.advance(999.0)[-1] == ('result', 'c', 'SUCCEEDED', 'Goal reached.', 100 * S)
