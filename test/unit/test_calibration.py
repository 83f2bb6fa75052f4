"""Robots as they were recorded: the file, what cannot be used of it, and goals that take what it says."""
import copy
import math
import os
import shutil

import pytest

from move_base_abstract.common.bounded_yaml import load_yaml_file
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.config.settings import read_settings
from move_base_abstract.engine.chance import Chance, Purpose
from move_base_abstract.fleet import Fleet
from move_base_abstract.motion.calibration import make_calibration, read_calibration
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.phased_route import PhasedRoute
from move_base_abstract.scenario import make_scenario, read_scenario

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..')
SHIPPED = 'move_base_dwa_stage'
PATH = os.path.join(ROOT, 'config', 'calibrated', SHIPPED + '.yaml')
RAW = load_yaml_file(PATH)
S = 1_000_000_000


def ends(fleet):
    return [entry for entry in fleet.trace if entry.kind == 'ended']


def test_the_one_that_ships_is_found_by_its_name_and_tells_its_source():
    settings = read_settings({'calibration': SHIPPED}, 'x')
    assert 'Stage' in read_calibration(SHIPPED, 'x').source
    assert settings.limits.max_speed == pytest.approx(1.0, abs=0.02)
    assert settings.tolerances.xy == pytest.approx(0.1, abs=0.01)
    assert settings.speed_source == 'calibration ' + SHIPPED
    assert settings.phases is not None


def test_a_goal_takes_the_delay_the_phases_and_what_is_drawn():
    fleet = Fleet(make_scenario({'seed': 4, 'defaults': {'calibration': SHIPPED}, 'robots': [{'name': 'bot'}]}),
                  start_ns=0)
    fleet.robot('bot').send(20.0, 5.0, 1.0)
    fleet.run()
    calibration = read_calibration(SHIPPED, 'x')
    leg = PhasedRoute(Pose2D(), Pose2D(20.0, 5.0, 1.0), (), calibration.limits, calibration.phases,
                      calibration.tolerances)
    chance = Chance(4, 'bot')
    delay, factor = calibration.durations.draw(leg, lambda purpose, place: chance.uniform(1, purpose, place))
    assert chance.uniform(1, Purpose.TAIL) > calibration.durations.tail_chance(leg.duration_ns / S, leg.start_turn)
    assert delay == RAW['start_delay']
    assert ends(fleet)[0].time_ns == round(delay * S) + round(leg.duration_ns * factor)
    assert fleet.robot('bot').pose == leg.end


def test_a_goal_of_the_tail_stands_first():
    raw = dict(copy.deepcopy(RAW), tail_chance_by_turn=[[0.0, 0.0], [3.0, 1.0]], tail_rate=0.0, tail_most=1000.0)
    durations = make_calibration(raw, 'x').durations
    leg = PhasedRoute(Pose2D(0.0, 0.0, 3.0), Pose2D(9.0, 0.0), (), make_calibration(raw, 'x').limits,
                      make_calibration(raw, 'x').phases)
    chance = Chance(1, 'a')
    drawn = [durations.draw(leg, lambda purpose, place, goal=goal: chance.uniform(goal, purpose, place))
             for goal in range(1, 2001)]
    assert {factor for _, factor in drawn} == {1.0}
    late = [delay - raw['start_delay'] for delay, _ in drawn]
    assert sum(late) / len(late) == pytest.approx(raw['tail_mean'], rel=0.07)


def test_the_tail_of_a_turn_is_no_longer_than_its_way_lets_it_be():
    raw = dict(copy.deepcopy(RAW), tail_chance_by_turn=[[0.0, 0.0], [3.0, 1.0]], tail_rate=0.0, tail_most=4.0)
    found = make_calibration(raw, 'x')
    free = make_calibration({key: value for key, value in raw.items() if key != 'tail_most'}, 'x').durations
    chance = Chance(1, 'a')
    for length in (0.5, 2.0, 20.0):
        leg = PhasedRoute(Pose2D(0.0, 0.0, 3.0), Pose2D(length, 0.0), (), found.limits, found.phases)
        for goal in range(1, 300):
            late, as_long = (durations.draw(leg, lambda purpose, place, goal=goal: chance.uniform(
                goal, purpose, place))[0] - raw['start_delay'] for durations in (found.durations, free))
            most = 4.0 * leg.distance
            assert late == pytest.approx(as_long * most / (as_long + most)) and late < most


def test_robots_with_and_without_a_calibration_live_in_one_fleet():
    fleet = Fleet(make_scenario({'robots': [{'name': 'a', 'calibration': SHIPPED}, {'name': 'b', 'max_speed': 1.0}]}),
                  start_ns=0)
    for name in fleet.names:
        fleet.robot(name).send(10.0, 0.0)
    fleet.run()
    assert [entry.time_ns for entry in ends(fleet) if entry.robot == 'b'] == [10 * S]
    assert [entry.time_ns > 12 * S for entry in ends(fleet) if entry.robot == 'a'] == [True]


def test_a_file_beside_the_scenario(tmp_path):
    shutil.copy(PATH, str(tmp_path / 'mine.yaml'))
    (tmp_path / 'fleet.yaml').write_text('defaults: {calibration: mine.yaml}\nrobots: [{name: bot}]\n')
    settings = read_scenario(tmp_path / 'fleet.yaml').robots[0].settings
    assert settings.phases == read_calibration(SHIPPED, 'x').phases


@pytest.mark.parametrize(('raw', 'words'), [
    ({'calibration': 'none_such'}, ("'none_such'", SHIPPED)),
    ({'calibration': 'mine.yaml'}, ("'mine.yaml'", 'an absolute path')),
    ({'calibration': '/none/such.yaml'}, ('/none/such.yaml', 'cannot be read')),
    ({'calibration': 3}, ('calibration', 'got 3')),
    ({'calibration': SHIPPED, 'max_speed': 2.0}, ('max_speed', 'one of the two')),
    ({'calibration': SHIPPED, 'goal_overhead': 2.0}, ('goal_overhead', 'one of the two')),
])
def test_what_cannot_be_used_is_said(raw, words):
    with pytest.raises(ConfigurationError) as error:
        read_settings(raw, '/robot_0/move_base')
    assert all(word in str(error.value) for word in ('/robot_0/move_base', *words)), str(error.value)


@pytest.mark.parametrize(('changes', 'words'), [
    ({'format': 2}, ('format: 1',)), ({'speed': 2.0}, ('speed: unknown key',)), ({'spread': None}, ('spread', 'None')),
    ({'braking_gain': 0.0}, ('braking_gain', '0.001..1000 [1/s]')), ({'max_speed': math.inf}, ('max_speed', 'inf')),
    ({'tail_chance_by_turn': []}, ('tail_chance_by_turn',)), ({'failure_by_length': [[0.0, 2.0]]}, ('chance in 0..1',)),
])
def test_a_file_that_is_no_calibration_is_named(changes, words):
    with pytest.raises(ConfigurationError) as error:
        make_calibration({**RAW, **changes}, 'mine.yaml')
    assert all(word in str(error.value) for word in ('mine.yaml', *words)), str(error.value)


@pytest.mark.parametrize('name', ['source', 'spread', 'bow_length'])
def test_a_value_that_is_missing_is_named(name):
    with pytest.raises(ConfigurationError, match='{} is missing'.format(name)):
        make_calibration({key: value for key, value in RAW.items() if key != name}, 'mine.yaml')
