"""Options that are written once: as words of a command line, as keys of a file, and where they are refused."""
import argparse
import dataclasses

import pytest
from hypothesis import example, given as drawn, strategies as st

from move_base_abstract.common import options
from move_base_abstract.common.bounded_yaml import load_yaml_text, yaml_line
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.lockstep.run_options import RunOptions
from move_base_abstract_ros.launching import command_line
from move_base_abstract_testing import settings

RUN = RunOptions(
    participant=('/a',), onlooker=('/b', '/c/d'), leave_out=('/rviz',), replace={'a/b': 'c/d'}, adopt=True,
    real_navigation=True, python2=('old',), tolerant=True, start={'/r/move_base': (1.0, -2.5, 1e-7)},
    param={'/a': [1, 2.5, 'x y'], '/b/c': '', '/d': {'e': '5', 'f': False}},
    add={'/map': "map_server/map_server 'a b.yaml'"}, node_args={'/n': '--x=3 y'}, no_respawn=True, until=60.0, seed=-4,
    sleep='simulated', stored_topics=('/x=/y', '/z'), network='n.yaml loss:=1', chaos_seed=7,
    chaos_delay=0.001, chaos_starts=0.25, chaos_only=('0123456789ab',), cores='all', crashes='allow',
    properties=('all', 'no_crash'))


def parser(**others):
    made = argparse.ArgumentParser(prog='program')
    options.add_arguments(made, RunOptions, **others)
    return made


def test_each_option_of_a_run_can_be_typed_and_is_read_as_it_was():
    windows = dataclasses.replace(RUN, chaos_seed=0, chaos_delay=0.0, chaos_starts=0.0, chaos_only=(),
                                  stored_topics=(), lookahead=0.25)
    assert all(getattr(RUN, one.field) != one.initial or getattr(windows, one.field) != one.initial
               for one in options.options_of(RunOptions).values())
    for one in (RUN, windows):
        assert options.of_words(RunOptions, options.words_of(one)) == one
    assert options.words_of(RunOptions()) == []


def test_what_is_given_on_a_command_line_is_as_in_a_file():
    found = options.given(RunOptions, parser().parse_args(['--param', '/a=[1, x]', '--start', 'r=1,2,0', '--adopt']))
    assert found == {'param': {'/a': [1, 'x']}, 'start': {'r': '1,2,0'}, 'adopt': True}
    assert options.read(RunOptions, '', found).start == {'/r': (1.0, 2.0, 0.0)}


def parsed(*words):
    reader = argparse.ArgumentParser('program')
    command_line.add_run(reader)
    return reader.parse_intermixed_args(words)


@pytest.mark.parametrize('words', [
    '--seed 3 --adopt PACKAGE a.launch x:=-1', 'PACKAGE a.launch --seed 3 x:=-1 --adopt',
    '--adopt PACKAGE --seed 3 a.launch x:=-1', '--adopt --seed 3 -- PACKAGE a.launch x:=-1'])
def test_options_among_the_words_of_the_file_count_like_those_before_them(words):
    found = parsed(*words.split())
    assert (found.seed, found.adopt, found.command) == (3, True, ['PACKAGE', 'a.launch', 'x:=-1'])


@pytest.mark.parametrize('word', ['-', '-3'])
def test_a_word_that_only_begins_like_an_option_is_a_word(word):
    assert parsed('a.launch', word).command == ['a.launch', word]


def test_an_option_after_the_file_that_there_is_not_is_an_error(capsys):
    with pytest.raises(SystemExit):
        parsed('a.launch', '--screen')
    assert 'unrecognized arguments: --screen' in capsys.readouterr().err


@example(['\x85'])
@example({'\u2028': '\u2029 ä'})
@drawn(st.recursive(st.booleans() | st.integers(-2**31, 2**31 - 1) | st.floats(allow_nan=False, allow_infinity=False)
                    | st.text(st.characters(min_codepoint=32, max_codepoint=0x17f, blacklist_characters='\x7f')),
                    lambda inner: st.lists(inner, max_size=3), max_leaves=5))
def test_a_parameter_keeps_its_type_as_yaml(value):
    assert load_yaml_text(yaml_line(value), 'x') == value or value == ''
    words = options.words_of(RunOptions(param={'/a': value}))
    assert options.of_words(RunOptions, words).param == {'/a': value}


@pytest.mark.parametrize(('words', 'says'), [
    (['--chaos-seed', '3'], 'program: error: --chaos-seed: not here; seeds say it'),
    (['--adopt'], 'program: error: --adopt: not here; nothing to adopt'),
    (['--start', '/a=1,2'], "argument --start: /a: got '1,2'; allowed: X,Y,YAW"),
    (['--start', '/a'], "argument --start: got '/a'; allowed: NODE=X,Y,YAW"),
    (['--param', '/a'], "argument --param: got '/a'; allowed: NAME=VALUE"),
    (['--param', '/a=[1'], "argument --param: '[1': is not YAML of plain values: "),
    (['--param', 'x:=5'], "argument --param: before '=': got 'x:'; allowed: the full name of a parameter"),
    (['--replace', 'a=b/c'], "argument --replace: before '=': got 'a'; allowed: PACKAGE/TYPE, such as"),
    (['--param', '/a=99999999999'], 'whole ones of 32 bits'), (['--param', '/a=~'], 'got None'),
    (['--until', 'x'], "got 'x'; allowed: a number in 1e-9..2147483647"),
    (['--add', '/a=b'], 'PACKAGE/TYPE [ARGUMENTS]')])
def test_what_cannot_be_used_here_is_refused_with_the_reason(words, says, capsys):
    with pytest.raises(SystemExit):
        parser(refused={'chaos_seed': 'seeds say it', 'adopt': 'nothing to adopt'}).parse_args(words)
    assert says in capsys.readouterr().err


TOGETHER = [({'chaos_delay': 0.1}, "need a 'chaos_seed'"), ({'chaos_starts': 0.1}, "need a 'chaos_seed'"),
            ({'chaos_only': ['none']}, "need a 'chaos_seed'"),
            ({'lookahead': 0.1, 'chaos_seed': 1}, 'no events are equal'),
            ({'lookahead': 0.1, 'stored_topics': ['/a']}, 'all takes time'),
            ({'lookahead': 'network'}, "without a 'network'")]


@pytest.mark.parametrize(('given', 'says'), TOGETHER)
def test_options_that_mean_nothing_together_are_refused_by_files_command_lines_and_tests(given, says, capsys):
    words = [word for name, value in given.items() for one in (value if isinstance(value, list) else [value])
             for word in ('--' + name.replace('_', '-').replace('topics', 'topic'), str(one))]
    with pytest.raises(SystemExit) as ended:
        options.of_arguments(RunOptions, parser(), parser().parse_args(words))
    error = capsys.readouterr().err
    assert ended.value.code == 2 and says in error and error.startswith('usage: program')
    for read in (lambda: options.read(RunOptions, '', given), lambda: settings.settings_of(given, '')):
        with pytest.raises(ConfigurationError, match=says):
            read()


def test_a_seed_of_a_test_takes_precedence_and_the_stated_order_has_no_delays():
    given = {'chaos_delay': 0.1, 'chaos_only': ['none'],
             'time_master': {'chaos_seed': 4, 'chaos_delay': 1, 'strict': True}}
    stated, other = settings.settings_of(given, '', 0), settings.settings_of(given, '', 3)
    assert (stated.chaos_seed, stated.chaos_delay, stated.chaos_only) == (0, 0.0, ())
    assert stated.time_master == {'strict': True, 'chaos_seed': 0}
    assert (other.chaos_seed, other.chaos_delay, other.chaos_only) == (3, 0.1, ('none',))
    assert other.time_master == {'chaos_delay': 1, 'strict': True}


def test_the_old_word_for_the_cores_is_not_handed_on():
    assert options.words_of(options.read(RunOptions, '', {'cores': 'auto'})) == ['--cores', 'one']


def test_a_name_of_earlier_releases_says_the_new_one(capsys):
    found = options.of_arguments(RunOptions, parser(), parser().parse_args(
        ['--args', '/n=x', '--node-args', '/m=y', '--properties', 'all']))
    assert (found.node_args, found.properties) == ({'/n': 'x', '/m': 'y'}, ('all',))
    assert capsys.readouterr().err == ('program: --args is called --node-args now\n'
                                       'program: --properties is called --property now\n')


def test_an_unknown_key_names_the_most_similar_one():
    with pytest.raises(ConfigurationError, match="the key 'leave_outs' is unknown; did you mean 'leave_out'?"):
        options.read(RunOptions, '', {'leave_outs': []})


def test_a_test_has_the_options_of_a_run_and_says_what_means_nothing(tmp_path):
    (tmp_path / 'x.launch').write_text('')
    found = settings.settings_of({'launch': tmp_path / 'x.launch', 'param': {'a': [1]}, 'start': {'r': (1, 2, 0)},
                                  'until': 5, 'wall_limit': 3, 'nodes': ('a/b c',)}, str(tmp_path))
    assert (found.param, found.start, found.nodes) == ({'/a': [1]}, {'/r': (1.0, 2.0, 0.0)}, ('a/b c',))
    assert (found.end, found.properties, found.log_messages) == ({'end_at': 5.0}, ('all',), True)
    with pytest.raises(ConfigurationError, match='crashes: not here; lockstep.allow'):
        settings.settings_of({'crashes': 'allow'}, '')
    with pytest.raises(ConfigurationError, match='lockstep: launch: .*nothing is not there'):
        settings.settings_of({'launch': 'nothing'}, '')
    with pytest.warns(FutureWarning, match='param now'):
        assert settings.settings_of({'parameters': {'/a': 1}, 'param': {'/b': 2}}, '').param == {'/a': 1, '/b': 2}
