"""What goes wrong on purpose: each kind, what it follows from, that one alone can be left, and that off is off."""
import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.faults.buggify import CAUSE, JUMP, MUTE, Lapsing, name_of
from move_base_abstract.fleet import Fleet
from move_base_abstract.goals.events import Lapse, robot_stream
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.leg import MotionLimits
from move_base_abstract.scenario import make_scenario

S = 1_000_000_000


def trace_of(goals=6, **settings):
    """Return what was recorded of two robots that each drive so many goals of 20 m at 2 m/s, one after the other."""
    left = {'a': goals, 'b': goals}

    def on_end(name, *_):
        left[name] -= 1
        if left[name]:
            fleet.robot(name).send(20.0 * (left[name] % 2), 0.0)
    fleet = Fleet(make_scenario({'defaults': {'max_speed': 2.0, **settings},
                                 'robots': [{'name': 'a'}, {'name': 'b'}]}), 0, on_end)
    for name in left:
        fleet.robot(name).send(20.0, 0.0)
    fleet.run()
    return [(entry.time_ns / S, entry.robot, entry.kind, entry.values) for entry in fleet.trace]


def failed(trace):
    return [(robot, *values) for _, robot, kind, values in trace if kind == 'failed']


def test_without_a_seed_or_a_chance_nothing_changes():
    plain = trace_of()
    assert trace_of(buggify={'abort': 1.0}) == trace_of(buggify_seed=3) == trace_of(
        buggify={'abort': 0.0}, buggify_seed=3) == plain
    assert not failed(plain)


@pytest.mark.parametrize(('kind', 'failure'), [('late_result', 'stall'), ('stop', 'stall'), ('abort', 'abort'),
                                               ('silent', 'silent')])
def test_each_kind_comes_with_every_goal_where_its_chance_is_one(kind, failure):
    trace = trace_of(buggify={kind: 1.0}, buggify_seed=3)
    ends = [values[1] for _, _, what, values in trace if what == 'ended']
    assert set(ends) == {'ABORTED' if kind == 'abort' else 'SUCCEEDED'} and len(ends) == 12
    names = [name_of(robot, kind, number) for number in range(1, 7) for robot in 'ab']
    found = failed(trace)
    assert [one[1] for one in found] == [failure] * len(found)
    assert {one[2] for one in found} <= {CAUSE + name for name in names}
    if kind != 'abort':  # an aborted robot may be where its next goal is already
        assert sorted(one[2] for one in found) == sorted(CAUSE + name for name in names)


def test_a_result_is_late_by_less_than_ten_seconds_and_at_the_goal():
    plain = [time for time, robot, kind, _ in trace_of(goals=1) if kind == 'ended']
    late = [time for time, robot, kind, _ in trace_of(goals=1, buggify={'late_result': 1.0}, buggify_seed=3)
            if kind == 'ended']
    assert all(0.0 < second - first < 10.1 for first, second in zip(sorted(plain), sorted(late)))


def test_it_follows_from_the_seed_and_one_alone_can_be_left():
    settings = {'buggify': {'abort': 0.2, 'stop': 0.3}, 'buggify_seed': 5}
    trace = trace_of(goals=20, **settings)
    assert trace == trace_of(goals=20, **settings) != trace_of(goals=20, **{**settings, 'buggify_seed': 6})
    robot, kind, cause = failed(trace)[-1]
    alone = trace_of(goals=20, buggify_only=[cause[len(CAUSE):]], **settings)
    assert failed(alone) == [(robot, kind, cause)]
    assert not failed(trace_of(goals=20, buggify_only=['none'], **settings))


@pytest.mark.parametrize('kind', [JUMP, MUTE])
def test_a_lapse_is_told_for_less_than_ten_seconds_and_changes_nothing_else(kind):
    settings = {'buggify': {kind: 0.5}, 'buggify_seed': 5}
    trace = trace_of(goals=12, **settings)
    lapses = [entry for entry in trace if entry[2].startswith('lapse')]
    assert [entry for entry in trace if entry not in lapses] == trace_of(goals=12)
    for robot in 'ab':
        told = [(time, what, values) for time, who, what, values in lapses if who == robot]
        assert 4 <= len(told) < 24
        assert [what for _, what, _ in told] == ['lapse_began', 'lapse_ended'] * (len(told) // 2)
        for (began, _, values), (ended, _, after) in zip(told[::2], told[1::2]):
            assert 0.0 < ended - began < 10.0 and values[:2] == after and after[0] == kind
            assert [limit > abs(by) > 0.0 for by, limit in zip(values[2:], (1.0, 1.0, 0.2))] == [True] * 3 * (
                kind == JUMP)
    assert trace == trace_of(goals=12, **settings) != trace_of(goals=12, **{**settings, 'buggify_seed': 6})
    alone = trace_of(goals=12, buggify_only=[lapses[0][3][1][len(CAUSE):]], **settings)
    assert [entry for entry in alone if entry[2].startswith('lapse')] == [
        entry for entry in lapses if entry[3][1] == lapses[0][3][1]]


def lapse(rig, kind):
    """Return what a robot told that drives at 1 m/s and has a lapse from 1.5 s to 3.5 s: feedback, and its lapses."""
    robot = rig(feedback_freq=1.0, limits=MotionLimits(1.0))
    told, stream = [], robot_stream()
    stream.subscribe('users', {Lapse: told.append})
    lapsing = Lapsing(robot.robot, robot.simulation.queue, stream)
    robot.send('g', 6.0, 0.0)
    trace = robot.advance(0.5) + robot.advance(1.0) + robot.advance(1.5)
    lapsing.begin(kind, 'why', 3 * S // 2, 7 * S // 2, (0.0, 0.5, 0.0))
    lapsing.begin(kind, 'one at a time', 3 * S // 2, 9 * S // 2, (0.0, 9.0, 0.0))
    for instant in range(2, 9):  # feedback of instants that the clock leaps over is left out
        trace += robot.advance(instant)
    assert [(event.time_ns, event.cause, event.begins) for event in told] == [
        (3 * S // 2, 'why', True), (7 * S // 2, 'why', False)]
    return {one[3] // S: one[2] for one in trace if one[0] == 'feedback'}


def test_feedback_tells_the_pose_that_jumped_and_nothing_while_it_is_mute(rig):
    right = {second: Pose2D(float(second), 0.0) for second in range(7)}
    assert lapse(rig, JUMP) == {**right, 2: Pose2D(2.0, 0.5), 3: Pose2D(3.0, 0.5)}
    assert lapse(rig, MUTE) == {second: pose for second, pose in right.items() if second not in (2, 3)}


def test_a_pose_that_jumps_turns_about_the_robot(rig):
    robot = rig(start=Pose2D(3.0, 4.0, 1.0))
    robot.robot.reported.jump(0, 0.5, -0.25, 0.1)
    told = robot.robot.reported.pose_at(0)
    assert (told.x, told.y, told.yaw) == pytest.approx((3.5, 3.75, 1.1)) and robot.robot.pose_at(0).x == 3.0


@pytest.mark.parametrize(('settings', 'says'), [
    ({'buggify': {'leap': 0.5}}, 'late_result, abort, stop, silent, jump, mute'),
    ({'buggify': {'abort': 2.0}}, 'a chance in 0..1'),
    ({'buggify_seed': -1}, 'whole number'), ({'buggify_only': 'x'}, 'a list of names')])
def test_what_is_no_chance_is_refused(settings, says):
    with pytest.raises(ConfigurationError, match=says):
        trace_of(**settings)
