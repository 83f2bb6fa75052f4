"""How long goals take beside the law of motion: overhead, factor and failures, in the plain fleet and for one robot."""
import math

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.config.settings import read_settings
from move_base_abstract.engine.chance import Chance, Purpose
from move_base_abstract.fleet import Fleet
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.leg import Leg, MotionLimits
from move_base_abstract.motion.pace import Pace, PacedLeg
from move_base_abstract.motion.route import Route
from move_base_abstract.scenario import make_scenario, read_scenario

S = 1_000_000_000
NO_CONTROL = 'Failed to find a valid control. Even after executing recovery behaviors.'
SPREAD = {'duration_distribution': 'lognormal', 'duration_cv': 0.2, 'goal_overhead': 1.5, 'duration_factor': 1.25}


def fleet_of(*names, seed=7, **settings):
    defaults = {'max_speed': 2.0, 'acceleration': 1.0, 'turn_rate': 1.0, **settings}
    return Fleet(make_scenario({'seed': seed, 'defaults': defaults,
                                'robots': [{'name': name, 'start_y': 1.0 * at} for at, name in enumerate(names)]}),
                 start_ns=0)


def ends(fleet, name='bot'):
    """Return [(time [ns], state, text)] of a robot's goals that have ended."""
    return [(entry.time_ns, *entry.values[1:]) for entry in fleet.trace
            if (entry.robot, entry.kind) == (name, 'ended')]


def durations(fleet, name, goals):
    """Send a robot to and fro; return how long each goal took [ns]."""
    found = []
    for number in range(goals):
        begin_ns = fleet.now_ns
        fleet.robot(name).send(10.0 * (number + 1) % 20.0, 0.0)
        fleet.run()
        found.append(fleet.now_ns - begin_ns)
    return found


# ---- a leg at another pace

LEG = Leg(Pose2D(1.0, 2.0, 0.5), Pose2D(9.0, 8.0, -1.0), MotionLimits(2.0, 1.0, 0.7), depart_ns=3 * S)
ROUTE = Route(Pose2D(1.0, 2.0, 0.5), Pose2D(9.0, 8.0, -1.0), [(4.0, 2.0), (4.0, 7.0)], MotionLimits(2.0, 1.0, 0.7),
              depart_ns=3 * S)


@pytest.mark.parametrize('leg', [LEG, ROUTE])
@pytest.mark.parametrize('factor', [0.5, 1.0, 1.7])
def test_a_paced_leg_has_the_same_poses_at_stretched_instants(leg, factor):
    paced = PacedLeg(leg, Pace(2 * S, factor))
    assert paced.arrive_ns == leg.depart_ns + 2 * S + round(factor * leg.duration_ns)
    assert paced.duration_ns == paced.arrive_ns - paced.depart_ns
    assert (paced.start, paced.end, paced.distance, paced.corners) == (leg.start, leg.end, leg.distance, leg.corners)
    for share in (0.0, 0.03, 0.2, 0.5, 0.9, 0.999, 1.0):
        leg_ns = leg.depart_ns + int(share * leg.duration_ns)
        now_ns = leg.depart_ns + 2 * S + int(share * leg.duration_ns * factor)
        assert paced.pose_at(now_ns).distance_to(leg.pose_at(leg_ns)) < 1e-8
        assert paced.distance_at(now_ns) == pytest.approx(leg.distance_at(leg_ns), abs=1e-8)
        assert paced.corners_ahead(now_ns) == leg.corners_ahead(leg_ns) or share == 0.0
    assert paced.pose_at(paced.arrive_ns) == leg.end
    assert paced.pose_at(0) == paced.pose_at(5 * S - 1) == leg.start
    assert paced.distance_at(5 * S - 1) == 0.0


def test_the_speed_of_a_paced_leg_is_that_of_its_poses():
    paced = PacedLeg(ROUTE, Pace(S, 1.6))
    for at in range(0, paced.duration_ns, paced.duration_ns // 37):
        forward, _, turning = paced.velocity_at(paced.depart_ns + at)
        one, other = (paced.pose_at(paced.depart_ns + at + step) for step in (0, 1000))
        if one.distance_to(other) * math.fabs(other.yaw - one.yaw) == 0.0:  # neither corners nor changes of part
            assert one.distance_to(other) / 1e-6 == pytest.approx(forward, abs=1e-2)
            assert (other.yaw - one.yaw) / 1e-6 == pytest.approx(turning, abs=1e-2)
    assert paced.velocity_at(paced.depart_ns + S - 1) == paced.velocity_at(paced.arrive_ns) == (0.0, 0.0, 0.0)


def test_a_leg_without_length_takes_its_delay():
    paced = PacedLeg(Leg(Pose2D(), Pose2D(), MotionLimits(1.0), depart_ns=5), Pace(10, 3.0))
    assert (paced.arrive_ns, paced.pose_at(5), paced.velocity_at(15)) == (15, Pose2D(), (0.0, 0.0, 0.0))


def test_until_its_delay_is_over_a_robot_that_turns_in_no_time_has_not_turned():
    start, goal = Pose2D(1.0, 2.0, 0.5), Pose2D(1.0, 9.0, -1.0)
    for place in (goal, Pose2D(1.0, 2.0, 2.0)):  # the second one is a turn alone
        paced = PacedLeg(Leg(start, place, MotionLimits(1.0)), Pace(2 * S, 1.5))
        assert paced.pose_at(0) == paced.pose_at(2 * S - 1) == start
        assert paced.pose_at(2 * S).yaw == pytest.approx(math.pi / 2 if place is goal else 2.0)


# ---- goals

def test_overhead_and_factor_to_the_nanosecond():
    fleet = fleet_of('bot', goal_overhead=1.5, duration_factor=1.25, turn_rate=0.0)
    fleet.robot('bot').send(10.0, 0.0)
    fleet.run(int(1.5 * S))
    assert fleet.robot('bot').pose == Pose2D()
    fleet.run()
    assert ends(fleet) == [(int((1.5 + 1.25 * 7.0) * S), 'SUCCEEDED', 'Goal reached.')]
    assert fleet.robot('bot').distance == 10.0


def test_a_drawn_factor_is_the_one_of_seed_robot_and_goal():
    plain = durations(fleet_of('bot'), 'bot', 3)
    factor = read_settings(SPREAD, 'x').durations.factor
    chance = Chance(7, 'bot')
    drawn = [factor.draw(lambda place, goal=goal: chance.uniform(goal, Purpose.FACTOR, place)) for goal in (1, 2, 3)]
    assert durations(fleet_of('bot', **SPREAD), 'bot', 3) == [
        int(1.5 * S) + round(own * each) for own, each in zip(plain, drawn)]
    assert len(set(drawn)) == 3


def test_what_one_robot_draws_depends_on_no_other():
    alone = durations(fleet_of('bot', **SPREAD), 'bot', 4)
    fleet = fleet_of('first', 'bot', **SPREAD)
    fleet.robot('bot').place(Pose2D())
    durations(fleet, 'first', 5)
    assert durations(fleet, 'bot', 4) == alone
    assert durations(fleet_of('bot', seed=8, **SPREAD), 'bot', 4) != alone


def test_a_goal_that_is_replaced_changes_nothing_for_those_after_it():
    fleet, other = fleet_of('bot', **SPREAD), fleet_of('bot', **SPREAD)
    for one, seconds in ((fleet, 0.5), (other, 5.0)):
        one.robot('bot').send(10.0, 0.0)
        one.run_for(seconds)
        one.robot('bot').place(Pose2D())
        one.robot('bot').send(5.0, 0.0)
        one.run()
    assert ends(fleet)[-1][0] - int(0.5 * S) == ends(other)[-1][0] - 5 * S


def test_a_goal_that_goes_on_from_elsewhere_keeps_its_factor_and_has_waited_already():
    fleet = fleet_of('bot', **SPREAD)
    fleet.robot('bot').send(10.0, 0.0)
    fleet.run_for(4.0)
    fleet.robot('bot').place(Pose2D())
    fleet.run()
    chance = Chance(7, 'bot')
    factor = read_settings(SPREAD, 'x').durations.factor.draw(lambda place: chance.uniform(1, Purpose.FACTOR, place))
    assert ends(fleet)[0][0] == 4 * S + round(7 * S * factor)


def test_of_the_overhead_only_the_rest_is_waited_for():
    fleet = fleet_of('bot', goal_overhead=3.0)
    fleet.robot('bot').send(10.0, 0.0)
    fleet.run_for(1.0)
    fleet.robot('bot').place(Pose2D())
    fleet.run()
    assert ends(fleet)[0][0] == 10 * S


def test_a_robot_that_is_stopped_while_it_waits_looks_where_it_looked():
    fleet = fleet_of('bot', goal_overhead=3.0, turn_rate=0.0)
    goal = fleet.robot('bot').send(0.0, 10.0)
    fleet.run_for(1.0)
    fleet.robot('bot').cancel(goal)
    assert fleet.robot('bot').pose == Pose2D()


def test_a_goal_that_no_time_reaches_is_aborted_with_durations_too():
    fleet = fleet_of('bot', duration_factor=1.1, max_speed=0.1)
    fleet.robot('bot').send(1e9, 0.0)
    fleet.run()
    (_, state, text), = ends(fleet)
    assert state == 'ABORTED'
    assert 'cannot be travelled to: the arrival would be' in text


# ---- failures

def test_as_many_goals_fail_as_their_length_says_and_on_the_way():
    fleet = fleet_of('bot', failure_by_length=[[5.0, 0.0], [10.0, 0.25], [15.0, 1.0]])
    for number in range(400):
        fleet.robot('bot').send(0.0, 10.0 * (number % 2))
        fleet.run()
        fleet.robot('bot').place(Pose2D(0.0, 10.0 * (number % 2), 0.0))
    states = [state for _, state, _ in ends(fleet)]
    assert abs(states.count('ABORTED') - 100) < 2.6 * math.sqrt(400 * 0.25 * 0.75)
    assert {text for _, state, text in ends(fleet) if state == 'ABORTED'} == {NO_CONTROL}


def test_a_goal_fails_where_the_robot_is_at_that_instant():
    fleet = fleet_of('bot', failure_by_length=[[0.0, 1.0]])
    fleet.robot('bot').send(10.0, 0.0)
    fleet.run()
    share = Chance(7, 'bot').uniform(1, Purpose.FAILURE_PLACE)
    leg = Leg(Pose2D(), Pose2D(10.0, 0.0), MotionLimits(2.0, 1.0, 1.0))
    assert ends(fleet) == [(int(share * 7 * S), 'ABORTED', NO_CONTROL)]
    assert fleet.robot('bot').pose == leg.pose_at(fleet.now_ns) != leg.end
    assert [entry.kind for entry in fleet.trace] == ['goal', 'departed', 'stands', 'ended']


def test_a_goal_shorter_than_the_first_length_has_the_first_chance():
    fleet = fleet_of('bot', failure_by_length=[[5.0, 0.0], [10.0, 1.0]])
    fleet.robot('bot').send(4.0, 0.0)
    fleet.run()
    assert ends(fleet)[0][1] == 'SUCCEEDED'


# ---- settings

def test_without_any_of_it_there_is_nothing_to_draw():
    assert read_settings({}, 'x').durations is None
    assert read_settings({'seed': 5, 'duration_factor': 1}, 'x').durations is None


@pytest.mark.parametrize(('raw', 'words'), [
    ({'goal_overhead': -1.0}, ('goal_overhead', '-1.0', '0..86400 [s, simulated]')),
    ({'duration_factor': 0}, ('duration_factor', 'got 0', '0.001..1000')),
    ({'duration_cv': 0.2}, ('duration_cv', '0.2', 'constant', 'lognormal and gamma')),
    ({'duration_distribution': 'gamma'}, ('duration_cv', 'got 0', 'gamma')),
    ({'duration_distribution': 'normal'}, ('duration_distribution', "'normal'", "'constant', 'lognormal', 'gamma'")),
    ({'duration_distribution': 'quantiles'}, ('duration_quantiles', 'None', 'quantiles')),
    ({'duration_quantiles': '/a.yaml'}, ('duration_quantiles', "'/a.yaml'", 'constant')),
    ({'duration_distribution': 'quantiles', 'duration_quantiles': 'a.yaml'}, ("'a.yaml'", 'an absolute path')),
    ({'duration_distribution': 'quantiles', 'duration_quantiles': '/none.yaml'}, ('/none.yaml', 'cannot be read')),
    ({'failure_by_length': []}, ('failure_by_length', '[]', 'ascending')),
    ({'failure_by_length': [[5.0, 0.1], [5.0, 0.2]]}, ('failure_by_length', 'ascending')),
    ({'failure_by_length': [[5.0, 1.1]]}, ('failure_by_length', 'chance in 0..1')),
    ({'failure_by_length': [5.0]}, ('failure_by_length', '[5.0]')),
    ({'failure_by_length': [['5', 0.1]]}, ('failure_by_length',)),
    ({'failure_by_length': 'often'}, ('failure_by_length', "'often'")),
    ({'seed': -1}, ('seed', '-1', '>= 0')),
])
def test_what_cannot_be_used_is_said(raw, words):
    with pytest.raises(ConfigurationError) as error:
        read_settings(raw, '/robot_0/move_base')
    assert all(word in str(error.value) for word in ('/robot_0/move_base', *words)), str(error.value)


def test_quantiles_come_from_a_file_beside_the_scenario(tmp_path):
    (tmp_path / 'factors.yaml').write_text('quantiles: [[0, 1.5], [1, 1.5]]\n')
    (tmp_path / 'fleet.yaml').write_text(
        'defaults: {duration_distribution: quantiles, duration_quantiles: factors.yaml, max_speed: 1.0}\n'
        'robots: [{name: bot}]\n')
    fleet = Fleet(read_scenario(tmp_path / 'fleet.yaml'), start_ns=0)
    fleet.robot('bot').send(10.0, 0.0)
    fleet.run()
    assert ends(fleet)[0][0] == 15 * S


@pytest.mark.parametrize('text', ['[1, 2]', 'factors: [[0, 1], [1, 2]]', 'quantiles: 3',
                                  'quantiles: [[0, 1], [0.9, 2]]',
                                  'quantiles: [[0, 2], [1, 1]]', 'quantiles: [[0, 0], [1, 1]]', 'quantiles: [[0, 1]]'])
def test_a_file_that_holds_no_quantiles_is_named(tmp_path, text):
    path = tmp_path / 'factors.yaml'
    path.write_text(text)
    with pytest.raises(ConfigurationError, match='factors.yaml'):
        read_settings({'duration_distribution': 'quantiles', 'duration_quantiles': str(path)}, 'x')


def test_the_seed_of_a_scenario_is_that_of_its_robots_unless_they_have_their_own():
    raw = {'seed': 3, 'robots': [{'name': 'a'}, {'name': 'b', 'seed': 4}]}
    assert [spec.settings.values['seed'] for spec in make_scenario(raw).robots] == [3, 4]
    scenario = make_scenario(raw, overrides={'seed': 9})
    assert (scenario.seed, [spec.settings.values['seed'] for spec in scenario.robots]) == (9, [9, 4])
