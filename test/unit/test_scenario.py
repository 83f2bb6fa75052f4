"""Scenarios: robots, groups, defaults, and what is wrong with a file, said in one line."""
import os

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.config.settings import EVENTS_ONLY
from move_base_abstract.scenario import make_robot, make_scenario, read_scenario

CONFIG = os.path.join(os.path.dirname(__file__), '..', '..', 'config')


def refused(raw, *words):
    """Assert that ``raw`` is refused with a text that holds ``words``."""
    with pytest.raises(ConfigurationError) as error:
        make_scenario(raw, 's.yaml')
    for word in ('s.yaml', *words):
        assert word in str(error.value)


def test_robots_keep_the_order_of_the_file_and_their_own_settings_come_before_the_defaults():
    scenario = make_scenario({'seed': 7, 'defaults': {'max_speed': 2.0, 'acceleration': 1.0}, 'robots': [
        {'name': 'b', 'start_x': 3}, {'name': 'a', 'max_speed': 4.0}]})
    assert [(spec.name, spec.settings.limits.max_speed, spec.settings.limits.acceleration, spec.settings.start.x)
            for spec in scenario.robots] == [('b', 2.0, 1.0, 3.0), ('a', 4.0, 1.0, 0.0)]
    assert (scenario.seed, scenario.defaults) == (
        7, {'seed': 7, 'max_speed': 2.0, 'acceleration': 1.0})


def test_a_group_stands_in_a_row_from_its_start_on():
    scenario = make_scenario({'defaults': {'start_y': 1.0}, 'robots': [
        {'name': 'd', 'count': 3, 'start_x': 5.0, 'step_x': 2.0, 'step_y': -1.0}]})
    assert [(spec.name, spec.settings.start.x, spec.settings.start.y) for spec in scenario.robots] == [
        ('d_0', 5.0, 1.0), ('d_1', 7.0, 0.0), ('d_2', 9.0, -1.0)]


def test_overrides_replace_defaults_and_not_what_a_robot_says_of_itself():
    scenario = make_scenario({'defaults': {'use_map': False},
                              'robots': [{'name': 'a'}, {'name': 'b', 'use_map': False}]},
                             overrides={'use_map': True})
    assert [spec.settings.values['use_map'] for spec in scenario.robots] == [True, False]
    assert scenario.defaults == {'use_map': True}


def test_a_base_comes_behind_all_that_is_given_and_is_there_for_robots_that_come_later():
    scenario = make_scenario({'defaults': {'feedback_freq': 2.0}, 'robots': [{'name': 'a', 'pose_update_freq': 3.0}]},
                             base=EVENTS_ONLY)
    values = scenario.robots[0].settings.values
    assert (values['feedback_freq'], values['pose_update_freq'], values['tf_heartbeat_freq']) == (2.0, 3.0, 0.0)
    assert scenario.defaults == {'feedback_freq': 2.0, 'pose_update_freq': 0.0, 'tf_heartbeat_freq': 0.0}


def test_an_empty_scenario_has_no_robots():
    assert make_scenario({}).robots == ()


@pytest.mark.parametrize('raw, words', [
    (['robots'], ('a mapping with seed, defaults, robots',)),
    ({'robot': []}, ('robot: unknown key', "did you mean 'robots'?")),
    ({'robots': {'name': 'a'}}, ('robots', 'a list of robots')),
    ({'robots': 0}, ('robots', 'a list of robots')), ({'robots': False}, ('robots', 'a list of robots')),
    ({'robots': {}}, ('robots', 'a list of robots')), ({'robots': ''}, ('robots', 'a list of robots')),
    ({'defaults': 0}, ('defaults', 'a mapping of settings')), ({'defaults': []}, ('defaults', 'a mapping of settings')),
    ({'robots': ['a']}, ('robots[0]', 'a mapping with at least a name')),
    ({'robots': [{'name': 'a'}, {'name': 'b', 'max_sped': 1}]},
     ("robots[1].max_sped: unknown key; did you mean 'max_speed'?",)),
    ({'defaults': {'max_sped': 1}}, ("defaults.max_sped: unknown key; did you mean 'max_speed'?",)),
    ({'robots': [{'start_x': 1.0}]}, ('robots[0]', 'got None', 'a letter first')),
    ({'robots': [{'name': '7up'}]}, ("'7up'", 'a letter first')),
    ({'robots': [{'name': 'a/b'}]}, ("'a/b'",)),
    ({'robots': [{'name': 'a'}, {'name': 'a'}]}, ("the name 'a' is given to more than one robot",)),
    ({'robots': [{'name': 'a_1'}, {'name': 'a', 'count': 2}]}, ("the name 'a_1'",)),
    ({'robots': [{'name': 'a', 'count': 0}]}, ('count', 'got 0', 'a whole number in 1..100000')),
    ({'robots': [{'name': 'a', 'count': 2, 'step_x': float('nan')}]}, ('step_x', 'a finite number')),
    ({'robots': [{'name': 'a', 'max_speed': -1.0}]}, ('robots[0]', 'max_speed', '-1.0', 'a finite number > 0')),
    ({'robots': [{'name': 'a', 'start_x': 'left'}]}, ('start_x', "'left'")),
    ({'seed': -1}, ('seed', '-1')),
])
def test_what_is_wrong_is_said_with_file_place_and_what_is_allowed(raw, words):
    refused(raw, *words)


def test_a_file_that_is_not_there_or_no_yaml_is_named(tmp_path):
    with pytest.raises(ConfigurationError, match='nowhere.yaml'):
        read_scenario(tmp_path / 'nowhere.yaml')
    broken = tmp_path / 'broken.yaml'
    broken.write_text('robots: [', encoding='utf-8')
    with pytest.raises(ConfigurationError, match='broken.yaml'):
        read_scenario(broken)


def test_yaml_cannot_make_objects(tmp_path):
    evil = tmp_path / 'evil.yaml'
    evil.write_text('robots: !!python/object/apply:os.getcwd []', encoding='utf-8')
    with pytest.raises(ConfigurationError, match='evil.yaml'):
        read_scenario(evil)


def test_the_scenario_that_ships_with_the_package_is_readable():
    assert [spec.name for spec in read_scenario(os.path.join(CONFIG, 'scenario.yaml')).robots] == [
        'robot_{}'.format(number) for number in range(5)]


def test_a_robot_by_itself_is_checked_alike():
    with pytest.raises(ConfigurationError, match="did you mean 'turn_rate'"):
        make_robot('a', {'turn_rat': 1.0})


@pytest.mark.parametrize('groups', [
    [{'name': 'a', 'count': 1_000_000_000}], [{'name': 'a', 'count': 60_000}, {'name': 'b', 'count': 60_000}],
    [{'name': 'a', 'count': 10 ** 400}]])
def test_no_more_robots_are_made_than_anybody_can_drive(groups):
    with pytest.raises(ConfigurationError, match='100000|100,000'):
        make_scenario({'robots': groups})


@pytest.mark.parametrize('robots', [
    [{'name': 'a', 'tf_prefix': 'x'}, {'name': 'b', 'tf_prefix': 'x'}],
    [{'name': 'a'}, {'name': 'b', 'tf_prefix': 'a'}],
    [{'name': 'a', 'tf_prefix': ''}, {'name': 'b', 'tf_prefix': ''}], [{'name': 'a', 'count': 2, 'tf_prefix': 'x'}]])
def test_two_robots_of_one_tf_frame_are_refused(robots):
    with pytest.raises(ConfigurationError, match="would both publish the tf frame '.*base_link'"):
        make_scenario({'robots': robots})


def test_robots_of_one_tf_prefix_may_have_frames_of_their_own():
    make_scenario({'defaults': {'tf_prefix': ''}, 'robots': [
        {'name': 'a', 'robot_base_frame': 'a_base'}, {'name': 'b', 'robot_base_frame': 'b_base'}]})


@pytest.mark.parametrize('name', ['a b', 'a/b', '', 'a\n', '7up', 'gr\u00fcn', 'x' * 201, None, ['a']])
def test_only_names_of_the_ros_graph_name_robots(name):
    with pytest.raises(ConfigurationError, match='a letter first'):
        make_scenario({'robots': [{'name': name}]})


def test_relative_paths_are_paths_from_the_working_folder_or_from_the_folder_of_the_file(tmp_path, monkeypatch):
    (tmp_path / 'tasks.yaml').write_text('tasks: [{place: dock, time: 1.0, duration: 2.0}]')
    text = '{places: [{name: dock}], arrivals: [{name: t, file: tasks.yaml}]}'
    (tmp_path / 'scenario.yaml').write_text(text)
    raw = {'places': [{'name': 'dock'}], 'arrivals': [{'name': 't', 'file': 'tasks.yaml'}]}
    assert len(list(read_scenario(tmp_path / 'scenario.yaml').tasks())) == 1
    monkeypatch.chdir(tmp_path)
    assert len(list(make_scenario(raw).tasks())) == 1
    assert raw['arrivals'] == [{'name': 't', 'file': 'tasks.yaml'}]
    monkeypatch.chdir('/')
    with pytest.raises(ConfigurationError, match='/tasks.yaml: cannot be read'):
        make_scenario(raw)
