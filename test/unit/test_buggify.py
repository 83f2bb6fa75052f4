"""What goes wrong on purpose: each kind, what it follows from, that one alone can be left, and that off is off."""
import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.faults.buggify import CAUSE, name_of
from move_base_abstract.fleet import Fleet
from move_base_abstract.scenario import make_scenario

S = 1_000_000_000


def trace_of(goals=6, **settings):
    """Return what was recorded of two robots that each drive so many goals of 20 m at 2 m/s, one after the other."""
    left = {'a': goals, 'b': goals}

    def on_end(name, *_):
        left[name] -= 1
        if left[name]:
            fleet.send(name, 20.0 * (left[name] % 2), 0.0)
    fleet = Fleet(make_scenario({'defaults': {'max_speed': 2.0, **settings},
                                 'robots': [{'name': 'a'}, {'name': 'b'}]}), 0, on_end)
    for name in left:
        fleet.send(name, 20.0, 0.0)
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


@pytest.mark.parametrize(('settings', 'says'), [
    ({'buggify': {'jump': 0.5}}, 'late_result, abort, stop, silent'), ({'buggify': {'abort': 2.0}}, 'a chance in 0..1'),
    ({'buggify_seed': -1}, 'whole number'), ({'buggify_only': 'x'}, 'a list of names')])
def test_what_is_no_chance_is_refused(settings, says):
    with pytest.raises(ConfigurationError, match=says):
        trace_of(**settings)
