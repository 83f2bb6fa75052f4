"""Robots that fail and are repaired: each kind, what counts, what clients are told, rates, and what is off."""
import math

import pytest
from scipy import stats

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.config.settings import read_settings
from move_base_abstract.engine.chance import Chance, Purpose
from move_base_abstract.engine.factors import Lognormal
from move_base_abstract.fleet import Fleet
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.leg import Leg, MotionLimits
from move_base_abstract.scenario import make_scenario

S = 1_000_000_000
HOUR = 3600 * S
FAILED = 'Aborting on the goal because the robot has failed'


def fleet_of(*names, on_end=None, **settings):
    """Return a Fleet of robots that stand at the origin and drive 2 m/s, at the time 0."""
    return Fleet(make_scenario({'defaults': {'max_speed': 2.0, **settings},
                                'robots': [{'name': name} for name in names or ('bot',)]}), 0, on_end)


def rows(fleet, *kinds):
    """Return [(time [s], kind, values)] of what was recorded, of these kinds if any."""
    return [(entry.time_ns / S, entry.kind, entry.values) for entry in fleet.trace if not kinds or entry.kind in kinds]


def endings(fleet):
    return [(time, *values[:2]) for time, _, values in rows(fleet, 'ended')]


# ---- each kind

def test_stall_it_stands_for_its_repair_time_and_goes_on():
    fleet = fleet_of(failure_kind='stall', failure_times=[4.0], repair_time=10.0)
    fleet.robot('bot').send(20.0, 0.0)
    fleet.run()
    assert rows(fleet) == [
        (0.0, 'goal', ('bot-1',)), (0.0, 'departed', (20.0, 0.0, 0.0)), (4.0, 'failed', ('stall', 'script')),
        (4.0, 'held', ('failure',)), (4.0, 'stands', (8.0, 0.0, 0.0)), (14.0, 'repaired', ()), (14.0, 'released', ()),
        (14.0, 'departed', (20.0, 0.0, 0.0)), (20.0, 'stands', (20.0, 0.0, 0.0)),
        (20.0, 'ended', ('bot-1', 'SUCCEEDED', 'Goal reached.'))]


def test_abort_it_stands_and_refuses_goals_until_it_is_repaired():
    fleet = fleet_of(failure_kind='abort', failure_times=[4.0], repair_time=10.0)
    fleet.robot('bot').send(20.0, 0.0)
    for at in (6, 14):
        fleet.run(at * S)
        fleet.robot('bot').send(0.0, 0.0)
    fleet.run()
    assert endings(fleet) == [(4.0, 'bot-1', 'ABORTED'), (6.0, 'bot-2', 'ABORTED'), (18.0, 'bot-3', 'SUCCEEDED')]
    assert {values[2] for _, _, values in rows(fleet, 'ended')[:2]} == {FAILED}


def test_silent_nothing_is_said_or_heard_until_it_is_repaired():
    fleet = fleet_of(failure_kind='silent', failure_times=[4.0], repair_time=10.0)
    fleet.robot('bot').send(20.0, 0.0)
    fleet.run(6 * S)
    fleet.robot('bot').cancel()
    fleet.robot('bot').send(0.0, 0.0)
    assert (fleet.robot('bot').condition.state_text, rows(fleet, 'ended')) == ('failed: silent', [])
    fleet.run()
    assert [row[:2] for row in rows(fleet)[5:]] == [
        (14.0, 'repaired'), (14.0, 'ended'), (14.0, 'goal'), (14.0, 'released'), (14.0, 'departed'), (18.0, 'stands'),
        (18.0, 'ended')]
    assert endings(fleet) == [(14.0, 'bot-1', 'PREEMPTED'), (18.0, 'bot-2', 'SUCCEEDED')]


def test_what_ends_while_a_robot_is_silent_is_said_when_it_is_repaired():
    ended = []
    fleet = fleet_of(on_end=lambda _robot, goal_id, state, _text, now_ns: ended.append(
        (goal_id, state.name, now_ns / S)),
                     failure_kind='silent', failure_times=[2.0], repair_time=100.0, abort_policy='upstream',
                     recovery_behavior_enabled=False, world_bounds=[-1.0, -1.0, 9.0, 1.0])
    fleet.robot('bot').send(20.0, 0.0)  # is given up after 5 s
    fleet.run()
    assert ended == [('bot-1', 'ABORTED', 102.0)]


@pytest.mark.parametrize('kind', ['abort', 'stall', 'silent'])
@pytest.mark.parametrize('act', [Fleet.reset, lambda fleet: fleet.remove('bot')])
def test_reset_and_removal_end_a_failure_and_its_goal(kind, act):
    fleet = fleet_of(failure_kind=kind, repair_time=1e6)
    fleet.robot('bot').send(20.0, 0.0)
    fleet.run(S)
    fleet.robot('bot').fail()
    fleet.robot('bot').send(10.0, 0.0)
    act(fleet)
    assert 'ABORTED' in [state for _, _, state in endings(fleet)]
    fleet.run()
    assert fleet.now_ns == S
    if fleet.names:
        fleet.robot('bot').send(2.0, 0.0)
        fleet.run()
        assert endings(fleet)[-1][::2] == (2.0, 'SUCCEEDED')


@pytest.mark.parametrize('kind', ['abort', 'stall', 'silent'])
def test_repaired_by_hand_it_does_as_if_its_time_were_over(kind):
    fleet = fleet_of(failure_kind=kind, failure_times=[1.0], repair_distribution='never')
    fleet.robot('bot').send(4.0, 0.0)
    fleet.run()
    assert (fleet.now_ns, fleet.robot('bot').condition.failing.failure.until_ns) == (S, None)
    fleet.run(5 * S)
    robot = fleet.robot('bot')
    assert (robot.repair(), robot.repair(), robot.condition.state_text) == (True, False, '')
    fleet.robot('bot').send(3.0, 0.0)
    fleet.run()
    assert endings(fleet)[-1][0] == 5.5


def test_a_failure_asked_for_has_the_kind_and_time_asked_for():
    fleet = fleet_of(failure_kind='stall', repair_time=5.0)
    assert fleet.robot('bot').fail('abort', 2.5) and not fleet.robot('bot').fail()
    fleet.run()
    assert rows(fleet) == [(0.0, 'failed', ('abort', 'request')), (2.5, 'repaired', ())]
    kinds = "'abort', 'stall', 'silent' or 'stuck'"
    with pytest.raises(ConfigurationError, match="robot 'bot'/kind: got 'nap'; allowed: " + kinds):
        fleet.robot('bot').fail('nap')
    with pytest.raises(ConfigurationError, match='failure_kind: got none'):
        fleet_of().robot('bot').fail()


def test_scripted_failures_may_be_each_of_its_own_and_one_during_another_is_left_out():
    fleet = fleet_of(failure_kind='stall', repair_time=2.0,
                     failure_times=[6.0, {'at': 1.0, 'kind': 'abort', 'repair': 3.0}, 2.0])
    fleet.run(20 * S)
    assert [row[:2] + row[2][:1] for row in rows(fleet, 'failed', 'repaired')] == [
        (1.0, 'failed', 'abort'), (4.0, 'repaired'), (6.0, 'failed', 'stall'), (8.0, 'repaired')]


# ---- exposures, to the nanosecond

def number(count, purpose, seed=0, robot='bot'):
    return -math.log(Chance(seed, robot).uniform(count, purpose))


def shuttle(fleet, seconds, names=('bot',), length=100.0):
    """Have robots drive to and fro, each goal sent as the one before ends, for so long."""
    for name in names:
        fleet.robot(name).send(length, 0.0)
    fleet.run(int(seconds * S))
    return fleet


def to_and_fro(length=100.0):
    def go(robot, _goal_id, _state, _text, _now_ns, fleet=None):
        x = fleet.robot(robot).pose.x
        fleet.robot(robot).send(0.0 if x > 0.5 * length else length, 0.0)
    return go


def driving(*names, length=100.0, **settings):
    made = []
    go = to_and_fro(length)
    fleet = fleet_of(*names, on_end=lambda *ending: go(*ending, fleet=made[0]), **settings)
    made.append(fleet)
    return fleet


def test_hours_count_while_there_is_a_goal_and_no_failure():
    fleet = fleet_of(failure_kind='stall', failures_per_hour=60.0, repair_time=7.0, max_speed=0.001)
    first, second = (int(number(count, Purpose.FAILURE_HOURS) / 60.0 * HOUR) for count in (1, 2))
    fleet.run(100 * S)
    fleet.robot('bot').send(80.0, 0.0)
    fleet.run(100 * S + first // 2)
    fleet.robot('bot').cancel()
    fleet.run(200 * S + first // 2)
    fleet.robot('bot').send(80.0, 0.0)
    fleet.run(207 * S + first + second)
    assert [entry.time_ns for entry in fleet.trace if entry.kind == 'failed'] == [
        200 * S + first, 207 * S + first + second]


def test_kilometres_count_by_the_odometer_from_leg_to_leg():
    fleet = driving(failure_kind='stall', failures_per_km=2.0, repair_time=7.0, acceleration=1.0, length=1000.0)
    shuttle(fleet, 4000.0, length=1000.0)
    failed = [entry.time_ns for entry in fleet.trace if entry.kind == 'failed']
    way = number(1, Purpose.FAILURE_KM) / 2.0 * 1000.0
    assert 0.0 < way < 1000.0
    leg = Leg(Pose2D(), Pose2D(1000.0, 0.0), MotionLimits(2.0, 1.0))
    assert leg.distance_at(failed[0]) >= way > leg.distance_at(failed[0] - 1)
    assert {values for _, _, values in rows(fleet, 'failed')} == {('stall', 'km')}


def test_goals_count_by_their_time_and_a_goal_that_is_left_counts_in_part():
    settings = {'failure_kind': 'stall', 'failures_per_goal': 0.4, 'repair_time': 0.0}
    first = number(1, Purpose.FAILURE_GOALS) / 0.4
    assert 0.5 < first < 3.0
    fleet = fleet_of(**settings)
    fleet.robot('bot').send(20.0, 0.0)
    fleet.run(5 * S)
    fleet.robot('bot').place(Pose2D(10.0, 5.0))  # half is done; the rest stands for the other half
    fleet.run(6 * S)
    fleet.robot('bot').cancel()
    way = math.hypot(10.0, 5.0) / 2.0
    done = 0.5 + 0.5 / way
    fleet.robot('bot').place(Pose2D())
    begin = fleet.now_ns
    while not rows(fleet, 'failed'):
        begin = fleet.now_ns
        fleet.robot('bot').send(20.0 - fleet.robot('bot').pose.x, 0.0)
        fleet.run()
        done += 1.0
    assert rows(fleet, 'failed')[0][0] == pytest.approx(begin / S + 10.0 * (first - (done - 1.0)), abs=1e-8)


def test_what_one_robot_draws_depends_on_no_other_and_a_seed_changes_it():
    settings = {'failure_kind': 'stall', 'failures_per_km': 5.0, 'failures_per_hour': 20.0, 'failures_per_goal': 0.1,
                'repair_distribution': 'lognormal', 'repair_cv': 1.0}

    def failed(fleet, *names):
        shuttle(fleet, 1000.0, names)
        return [(entry.time_ns, entry.kind, entry.values) for entry in fleet.trace if entry.robot == 'bot']

    alone = failed(driving('bot', **settings), 'bot')
    assert failed(driving('first', 'bot', **settings), 'first', 'bot') == alone
    assert failed(driving('bot', seed=1, **settings), 'bot') != alone


# ---- rates: the oracle

NAMES = tuple('robot_{}'.format(number) for number in range(20))


def test_failures_come_at_their_rates():
    """Exact Poisson intervals of 99 % (Garwood 1936) around the number of failures hold the exposure times the rate."""
    rates = {'hour': 12.0, 'km': 2.0, 'goal': 0.07}
    fleet = driving(*NAMES, failure_kind='stall', failures_per_hour=rates['hour'], failures_per_km=rates['km'],
                    failures_per_goal=rates['goal'], repair_distribution='lognormal', repair_time=20.0, repair_cv=0.8,
                    seed=11)
    shuttle(fleet, 20_000.0, NAMES)
    counts, repairs, driven, down = dict.fromkeys(rates, 0), [], 0.0, 0.0
    for name in NAMES:
        begin = None
        for entry in (entry for entry in fleet.trace if entry.robot == name):
            if entry.kind == 'failed':
                counts[entry.values[1]] += 1
                begin = entry.time_ns / S
            elif entry.kind == 'repaired':
                repairs.append(entry.time_ns / S - begin)
                begin = None
        down += fleet.now_ns / S - begin if begin is not None else 0.0
        driven += fleet.robot(name).distance
    hours = (len(NAMES) * fleet.now_ns / S - down - sum(repairs)) / 3600.0
    for cause, exposure in (('hour', hours), ('km', driven / 1000.0), ('goal', driven / 100.0)):
        count, expected = counts[cause], exposure * rates[cause]
        low, high = stats.chi2.ppf(0.005, 2 * count) / 2.0, stats.chi2.ppf(0.995, 2 * count + 2) / 2.0
        assert low <= expected <= high, (cause, count, expected)
        assert count > 400
    logs = [math.log(repair) for repair in repairs]
    sigma = math.sqrt(math.log1p(0.64))
    assert abs(sum(logs) / len(logs) - (math.log(20.0) - 0.5 * sigma ** 2)) < 2.576 * sigma / math.sqrt(len(logs))


def test_repairs_are_drawn_by_the_number_of_the_failure():
    fleet = driving(failure_kind='stall', failures_per_hour=60.0, repair_distribution='lognormal', repair_time=20.0,
                    repair_cv=0.5)
    shuttle(fleet, 1000.0)
    took = [ended.time_ns - begun.time_ns for begun, ended in zip(*(
        [entry for entry in fleet.trace if entry.kind == kind] for kind in ('failed', 'repaired')))]
    chance = Chance(0, 'bot')
    assert len(took) > 3
    assert took == [round(S * Lognormal(20.0, 0.5).draw(
        lambda place, count=count: chance.uniform(count, Purpose.REPAIR, place))) for count in range(1, len(took) + 1)]


# ---- settings

@pytest.mark.parametrize('wrong, text', [
    ({'failures_per_hour': 1.0}, "failure_kind: got 'none' with failures_per_hour; allowed: 'abort'"),
    ({'failure_times': [1.0]}, "failure_kind: got 'none' with failure_times"),
    ({'failure_kind': 'stall', 'repair_cv': 0.5}, 'repair_cv: got 0.5 with repair_distribution: fixed; allowed: > 0 '),
    ({'failure_kind': 'stall', 'repair_distribution': 'lognormal'}, 'repair_cv: got 0.0 with'),
    ({'failure_kind': 'sleep'}, "failure_kind: got 'sleep'; allowed: 'none', 'abort', 'stall', 'silent', 'stuck' or '"),
    ({'failure_kind': 'stall', 'failure_times': [{'when': 1.0}]}, 'failure_times: got '),
    ({'failure_kind': 'stall', 'failure_times': [-1.0]}, 'allowed: a list of seconds'),
    ({'failure_kind': 'stall', 'failures_per_km': -1.0}, r'allowed: a number in 0..1e6 \[1/km\]')])
def test_what_does_not_fit_is_an_error_that_names_it(wrong, text):
    with pytest.raises(ConfigurationError, match=text):
        read_settings(wrong, 'x')


@pytest.mark.parametrize('rate', ['failures_per_hour', 'failures_per_km', 'failures_per_goal'])
def test_the_smallest_rate_lets_nothing_fail(rate):
    fleet = shuttle(driving(failure_kind='stall', **{rate: 5e-324}), 20.0)
    assert fleet.robot('bot').condition.failing.count == 0


def test_without_a_kind_nothing_is_made_and_the_log_is_the_same():
    settings = {'duration_distribution': 'lognormal', 'duration_cv': 0.3}
    plain, with_kind = (shuttle(driving(**settings, **more), 2000.0) for more in ({}, {'failure_kind': 'stall'}))
    assert plain.robot('bot').condition.failing is None
    assert plain.trace == with_kind.trace != []
