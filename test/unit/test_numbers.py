"""One grammar and one bound for numbers in YAML, CSV, options and files of others."""
import argparse

import pytest

from dispatches import told
from move_base_abstract.common import kinds
from move_base_abstract.common.bounded_yaml import load_yaml_text
from move_base_abstract.common.csv_files import number_in
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.options import word_of
from move_base_abstract.fleet import Dispatch
from move_base_abstract.lockstep.run_options import POSE
from move_base_abstract.maps.lane_map import read_lane_map
from move_base_abstract.scenario import make_scenario
from move_base_abstract.tasks.arrivals import as_value
from move_base_abstract_mapf import command, movingai
from move_base_abstract_mapf.plans import read_plan

GOOD = {'1': 1.0, '-2.5': -2.5, '+.5': 0.5, '3.': 3.0, '1e3': 1000.0, ' 7 ': 7.0, '1E-2': 0.01, '007': 7.0}
ODD = ('1_0', '\u0661', '\uff11', '1\u0660', 'inf', '-inf', 'nan', 'infinity', '0x1', '1e', '', '.', '1 0', '1,5',
       '1e1_0')


@pytest.mark.parametrize('text', ODD)
def test_what_is_no_number_in_ascii_digits_is_none_anywhere(text):
    with pytest.raises(ValueError):
        kinds.as_number(text)
    with pytest.raises(ValueError):
        kinds.as_whole(text)
    with pytest.raises(ConfigurationError, match='allowed: a finite number'):
        number_in({'x': text}, 'x', 'a.csv: line 2')
    assert as_value(text) == text
    for kind in (kinds.number(), kinds.integer(0)):
        with pytest.raises(argparse.ArgumentTypeError):
            word_of(kind)(text)
    with pytest.raises(ConfigurationError, match='allowed: X,Y,YAW'):
        POSE.check('pose', f'{text},0,0')


@pytest.mark.parametrize('text, value', GOOD.items())
def test_numbers_are_the_same_in_all_places(text, value):
    assert kinds.as_number(text) == number_in({'x': text}, 'x', '') == as_value(text) == word_of(
        kinds.number())(text) == POSE.check('pose', f'{text},0,0')[0] == value


@pytest.mark.parametrize('text', ['1_0', '-1_000.5', '1:30', '1:30.5', '010', '0x1_0', '0b11', '0x1f'])
def test_forms_that_only_yaml_takes_for_numbers_are_refused_with_the_place(text):
    with pytest.raises(ConfigurationError, match=r'f: line 1, column 4: got .*; allowed: a number in digits'):
        load_yaml_text('x: ' + text, 'f')
    assert load_yaml_text(f'x: "{text}"', 'f') == {'x': text}


def test_a_file_says_no_less_than_10_by_10():
    assert load_yaml_text('[10, 0, 0.5, +7, -0.0, .inf, 1.e+3]', 'f')[:4] == [10, 0, 0.5, 7]


@pytest.mark.parametrize('text', ['!!int "\u0661"', '!!float "\uff11.5"', '!!int "1_0"', '!!float "inf"', '!!int " 7"'])
def test_a_tag_makes_no_number_of_another_form(text):
    with pytest.raises(ConfigurationError, match='allowed: a number in digits'):
        load_yaml_text('x: ' + text, 'f')


@pytest.mark.parametrize('gap', [{'rate': 1e-12}, {'every': 2147483647.0}, {'rate_per_hour': 1e-9}])
def test_what_arrives_after_the_end_of_simulated_time_does_not_arrive(gap):
    dispatch = Dispatch(make_scenario({'robots': [{'name': 'a'}], 'orders': [
        {'name': 'one', **gap, 'stops': [{'x': 1.0}]},
        {'name': 'two', 'every': 10.0, 'count': 2, 'stops': [{'x': 2.0}]}]}))
    dispatch.run()
    assert [row[3] for row in told(dispatch, 'order_done')] == ['two_1', 'two_2']


@pytest.mark.parametrize('entry, text', [
    ({'area': [0.0, 0.0, 1e308, 1.0]}, 'area'), ({'area': [-1e308, 0.0, 1e308, 1.0]}, 'area'),
    ({'area': [0.0, 0.0, 1.1e9, 1.0]}, 'area')])
def test_an_area_lies_within_the_bound(entry, text):
    with pytest.raises(ConfigurationError, match=text):
        make_scenario({'arrivals': [{'name': 'field', 'rate': 0.1, 'duration': 1.0, **entry}]})


def test_a_tmap2_with_a_zero_quaternion_is_refused(tmp_path):
    (tmp_path / 'map.yaml').write_text(
        'nodes: [{node: {name: a, pose: {position: {x: 0, y: 0}, orientation: {x: 0, y: 0, z: 0, w: 0}}}}]')
    with pytest.raises(ConfigurationError, match='which is not a node of a topological map'):
        read_lane_map(str(tmp_path / 'map.yaml'), 'lanes')


@pytest.mark.parametrize('name', ['a b', 'a\n', '\u202ea', '\u0661', '1a', '/', 'a//b', 'a' * 201])
def test_a_topic_is_a_name_of_ros(name):
    for kind in (kinds.TOPIC, kinds.BELOW_ROOT):
        with pytest.raises(ConfigurationError, match='allowed: a topic name'):
            kind(name)
    assert (kinds.TOPIC('~a/b'), kinds.TOPIC('/a'), kinds.BELOW_ROOT('/a/b')) == ('~a/b', '/a', 'a/b')


# ---- MAPF

MAP = 'type octile\nheight 2\nwidth 3\nmap\n...\n.@.\n'
SCEN = '0\ta.map\t3\t2\t{}\t{}\t2\t1\t1.0\n'


@pytest.mark.parametrize('text, why', [
    (MAP.replace('octile', 'hex'), 'type octile'), (MAP[12:], 'type octile'), (MAP + '...\n', 'got 3 rows'),
    (MAP.replace('height 2', 'height \u0662'), 'height'), (MAP.replace('width 3', 'height 2'), 'each once')])
def test_a_map_of_another_type_or_with_more_rows_is_refused(text, why, tmp_path):
    (tmp_path / 'a.map').write_text(text, encoding='utf-8')
    with pytest.raises(ConfigurationError, match=why):
        movingai.read_map(str(tmp_path / 'a.map'))


@pytest.mark.parametrize('problems, why', [
    (SCEN.format(0, 0).replace('\t3\t2', '\t4\t2', 1), 'width 3 and height 2, as the map has'),
    (SCEN.format(0, 0) * 2, 'a cell of its own for each robot'), (SCEN.format('\u0661', 0), 'start column')])
def test_problems_of_another_map_or_with_one_start_for_two_are_refused(problems, why, tmp_path, capsys):
    (tmp_path / 'a.map').write_text(MAP)
    (tmp_path / 'a.scen').write_text(problems, encoding='utf-8')
    count = str(problems.count('\n'))
    with pytest.raises(SystemExit, match='2'):
        command.main(['import', str(tmp_path / 'a.map'), str(tmp_path / 'a.scen'), '--agents', count, '--out',
                      str(tmp_path / 'out')])
    assert why in capsys.readouterr().err
    assert not (tmp_path / 'out').exists()


def test_a_plan_has_ascii_digits(tmp_path):
    (tmp_path / 'plan').write_text('Agent 0: (0,\u0661)->(0,2)->\n', encoding='utf-8')
    with pytest.raises(ConfigurationError, match='allowed'):
        read_plan(str(tmp_path / 'plan'))
