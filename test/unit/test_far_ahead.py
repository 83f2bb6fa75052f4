"""Goals that would have to wait, or travel, for longer than anybody means: a stamp of the wall clock, a wrong unit."""
import math

import pytest

from move_base_abstract.common.errors import TimeError
from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.fleet import Dispatch, Fleet
from move_base_abstract.goals.goal_pose import BadFramePolicy
from move_base_abstract.goals.outcome import GoalState
from move_base_abstract.goals.recovery import RecoveryPolicy
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import make_scenario
from test_goal_frames import Tractor

S = NS_PER_S
WALL = 1_795_872_674.0
NO_PLAN = 'Failed to find a valid plan. Even after executing recovery behaviors.'


@pytest.mark.parametrize('frame', ['base_link', 'tractor'])
def test_a_stamp_of_the_wall_clock_is_told_at_once_and_the_goal_cannot_be_reached(rig, frame):
    robot = rig(foreign={'tractor': Tractor(10.0)}, longest_wait=86400.0)
    robot.advance(10.0)
    warned, *rest = robot.send('g', 1.0, 0.0, frame=frame, stamp=WALL)
    assert warned == ('warn', "The goal cannot be reached: the goal's stamp is at 1795872674 s, 1795872664 s ahead, "
                      'more than longest_wait (86400 s): is it of the wall clock? Stamps are of /clock, which nodes '
                      'follow with use_sim_time')
    assert rest[-1] == ('result', 'g', 'ABORTED', NO_PLAN, 10 * S)
    assert robot.simulation.next_due_ns() is None


def test_as_long_as_upstream_would_try(rig):
    robot = rig(longest_wait=86400.0, recovery_policy=RecoveryPolicy(fast=False, behaviors=()))
    assert len(robot.send('g', 1.0, 0.0, frame='base_link', stamp=WALL)) == 1
    assert robot.advance(1e6)[-1] == ('result', 'g', 'ABORTED', NO_PLAN, 5 * S)


@pytest.mark.parametrize('ahead, state', [(86400.0, 'SUCCEEDED'), (86400.001, 'ABORTED')])
def test_a_day_may_be_waited_and_travelled_for(rig, ahead, state):
    for goal in ({'x': 0.0, 'frame': 'base_link', 'stamp': ahead}, {'x': 2.0 * ahead}):
        robot = rig(longest_wait=86400.0)
        robot.send('g', y=0.0, **goal)
        assert [line[2] for line in robot.advance(1e6) + robot.told() if line[0] == 'result'] == (
            ['SUCCEEDED'] if state == 'SUCCEEDED' else [])
        assert robot.navigator.robot.pose_at(S * 10 ** 6).x == (goal['x'] if state == 'SUCCEEDED' else 0.0)


def test_a_robot_in_plain_python_that_is_too_slow_stays_and_goes_on():
    fleet = Fleet(make_scenario({'robots': [{'name': 'bot', 'max_speed': 0.001}]}))
    bot = fleet.robot('bot')
    bot.send(100.0, 0.0)
    assert fleet.run() == S
    (warned,) = fleet.warnings
    assert warned.text.startswith('The goal cannot be reached: the arrival is at 100001 s, 100000 s ahead')
    assert warned.text.endswith('are the position (m) and the speed, 0.001 m/s, as they are meant?')
    bot.send(1.0, 0.0)
    assert fleet.run() == 1001 * S
    assert [entry.values[1] for entry in fleet.trace if entry.kind == 'ended'] == [
        GoalState.ABORTED.name, GoalState.SUCCEEDED.name]


def test_a_run_of_weeks_may_wait_longer_if_it_says_so():
    fleet = Fleet(make_scenario({'robots': [{'name': 'bot', 'max_speed': 0.001, 'longest_wait': 1e6}]}))
    fleet.robot('bot').send(100.0, 0.0)
    assert fleet.run() == 100_001 * S


def test_a_frame_that_is_looked_up_again_and_again_is_no_goal_far_ahead(rig):
    robot = rig(bad_frame_policy=BadFramePolicy.WAIT, foreign={}, longest_wait=0.01)
    robot.send('g', 0.0, 0.0, frame='dock')
    robot.advance(1.0)
    robot.foreign['dock'] = lambda _stamp_ns: Pose2D()
    assert robot.advance(2.0)[-1][:3] == ('result', 'g', 'SUCCEEDED')


@pytest.mark.parametrize('yaw', [math.inf, -math.inf, math.nan])
def test_a_heading_that_is_no_number_is_no_heading(yaw):
    fleet = Fleet(make_scenario({'robots': [{'name': 'bot'}]}))
    fleet.robot('bot').send(1.0, 0.0, yaw)
    fleet.run()
    assert [entry.values[1:] for entry in fleet.trace if entry.kind == 'ended'] == [
        ('ABORTED', 'Aborting on goal because it was sent with an invalid quaternion')]


@pytest.mark.parametrize('z', [math.nan, math.inf])
def test_a_height_that_is_no_number_is_no_place(rig, z):
    text = rig().send('g', 1.0, 0.0, height=z)[-1]
    assert text[2:4] == ('ABORTED', 'The goal is not a place: pose: z must be finite, got {!r}'.format(z))


@pytest.mark.parametrize('every, ahead', [(86400.0, []), (1e6, [
    'the arrival of the next order, o_1, is at 1000001 s, 1000000 s ahead, more than a day (86400 s)'])])
def test_the_first_order_that_comes_after_more_than_a_day_is_told(every, ahead):
    dispatch = Dispatch(make_scenario({'robots': [{'name': 'bot'}], 'dispatcher': {}, 'orders': [
        {'name': 'o', 'every': every, 'count': 3, 'stops': [{'x': 1.0}]}]}))
    assert [warning.text for warning in dispatch.fleet.warnings] == ahead
    dispatch.run()
    assert [warning.text for warning in dispatch.fleet.warnings] == ahead
    assert sum(entry.kind == 'order_done' for entry in dispatch.fleet.trace) == 3


@pytest.mark.parametrize('time_ns', [10 ** 400, 10 ** 4000, 2 ** 62])
def test_an_instant_of_any_size_is_refused_in_words(time_ns):
    with pytest.raises(TimeError, match='simulated time ends at 2147483647 s'):
        Fleet(make_scenario({'robots': [{'name': 'bot'}]})).at(time_ns, print)
