"""YAML that is made to hurt, and YAML that looks like it."""
import os
import re

import pytest

from move_base_abstract.common import bounded_yaml
from move_base_abstract.common.bounded_yaml import FILE, MAX_DEPTH, MAX_DIGITS, REQUEST, load_yaml_file, load_yaml_text
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.mission import MissionError, read_mission
from move_base_abstract.scenario import read_scenario


def refusal(text, bounds=FILE):
    with pytest.raises(ConfigurationError) as error:
        load_yaml_text(text, 'here', bounds)
    assert str(error.value).startswith('here: ')
    assert len(str(error.value)) < 400
    assert '\n' not in str(error.value)
    return str(error.value)


def aliases_of_aliases(levels, first='&l0 [x, x, x, x, x, x, x, x, x]'):
    """Return a few hundred bytes that stand for 9 ** levels values."""
    lines = ['l0: ' + first]
    lines += ['l{0}: &l{0} [{1}]'.format(level, ', '.join(['*l{}'.format(level - 1)] * 9))
              for level in range(1, levels)]
    return '\n'.join(lines) + '\n'


def test_plain_documents_come_as_they_are():
    assert load_yaml_text('a: [1, 2.5, x, true, null]\nb: {c: 16}\n', 'here') == {
        'a': [1, 2.5, 'x', True, None], 'b': {'c': 16}}
    assert load_yaml_text('', 'here') is None
    assert load_yaml_text('gr\u00fcn: 1'.encode(), 'here') == {'gr\u00fcn': 1}


def test_aliases_and_merged_keys_may_be_used():
    assert load_yaml_text('a: &a {x: 1, y: 2}\nb: {<<: *a, y: 3}\nc: *a\n', 'here') == {
        'a': {'x': 1, 'y': 2}, 'b': {'x': 1, 'y': 3}, 'c': {'x': 1, 'y': 2}}


@pytest.mark.parametrize('text', [
    aliases_of_aliases(9),
    aliases_of_aliases(9).replace('[*l', '[[*l').replace(']\n', ']]\n').replace('[x', '[[x'),
    '\n'.join(['a0: &a0 {k: v}'] + ['a{0}: &a{0} {{<<: [{1}]}}'.format(level, ', '.join(
        ['*a{}'.format(level - 1)] * 9)) for level in range(1, 9)])])
def test_aliases_that_stand_for_too_much_are_refused_before_anything_is_made(text):
    assert 'more than 500000 values or 16777216 characters' in refusal(text)


def test_characters_behind_aliases_count_too():
    text = 'a: &a {}\nb: [{}]'.format('x' * 60_000, ', '.join(['*a'] * 1000))
    assert 'more than 500000 values or 16777216 characters' in refusal(text)


def test_what_comes_by_a_service_is_bounded_more_closely():
    assert 'more than 10000 values' in refusal(aliases_of_aliases(5), REQUEST)
    assert 'got more than 65536 bytes of YAML' in refusal('x' * 65_537, REQUEST)


def test_an_alias_in_what_it_stands_for_is_refused():
    assert "line 1, column 5: the alias '*a' lies in its own value" in refusal('&a [*a]')


@pytest.mark.parametrize('text', ['[' * 100_000, '{a: ' * 100_000, '- ' * 100_000, '[' * 33 + ']' * 33])
def test_nesting_is_bounded(text):
    assert 'lists and mappings lie more than 32 deep in one another' in refusal(text)


def test_the_allowed_depth_is_allowed():
    load_yaml_text('[' * MAX_DEPTH + ']' * MAX_DEPTH, 'here')


@pytest.mark.parametrize('number', ['9' * 5001, '-0x' + 'f' * 5001, '1.' + '0' * 5001, '1' + ':1' * 5001])
def test_long_numbers_are_refused(number):
    assert 'a number of {} characters; allowed: at most {}'.format(len(number), MAX_DIGITS) in refusal('a: ' + number)


@pytest.mark.parametrize('text, key, line', [
    ('a: 1\nb: 2\na: 3', "'a'", 3), ('1: x\n+1: y', '1', 2), ('{"a": 1, a: 2}', "'a'", 1),
    ('x: [{n: 1, n: 1}]', "'n'", 1),
    ('a: !!set {k, k}', "'k'", 1)])
def test_a_key_twice_is_an_error(text, key, line):
    message = refusal(text)
    assert 'line {}, column '.format(line) in message
    assert 'the key {} is there twice'.format(key) in message


@pytest.mark.parametrize('text', [
    'a: 2001-13-40', 'a: !!int x', 'a: !!int ""', 'a: !!float x', 'a: !!bool x', 'a: !!timestamp x', 'a: !!binary "x"',
    '? [a]\n: b', 'a: *nobody', 'a: [', '\x07', b'\xff', '--- 1\n--- 2', '!!map x', 'a: <<\n<<: 3',
    '!!python/object/apply:os.getcwd []', '!!python/name:os.system', '"' + 'x' * 100_000,
    '!<' + 'x' * 100_000 + '> y', '&' + 'x' * 100_000 + ' [*' + 'x' * 100_000 + ']', '*' + 'x' * 100_000])
def test_what_is_no_plain_value_is_refused_in_a_short_line(text):
    refusal(text)


def test_files_are_read_up_to_their_bound_only(tmp_path):
    with pytest.raises(ConfigurationError, match='/dev/zero: is a device; allowed: a file of YAML'):
        load_yaml_file('/dev/zero')
    with pytest.raises(ConfigurationError, match=r'absent\.yaml: cannot be read: No such file or directory'):
        load_yaml_file(tmp_path / 'absent.yaml')
    with pytest.raises(ConfigurationError, match='is a folder; allowed: a file of YAML'):
        load_yaml_file(tmp_path)
    with pytest.raises(ConfigurationError, match='cannot be read: embedded null byte'):
        load_yaml_file('a\0b')


@pytest.mark.parametrize('read, error', [(read_scenario, ConfigurationError), (read_mission, MissionError)])
@pytest.mark.parametrize('text', [aliases_of_aliases(9), 'robots: ' + '[' * 100_000, 'robots: ' + '9' * 5001,
                                  'robots: []\nrobots: []', aliases_of_aliases(5) + 'robots: *l4\n',
                                  aliases_of_aliases(5) + 'robots: [*l4]\n'])
def test_scenarios_and_missions_are_read_with_it(tmp_path, read, error, text):
    path = tmp_path / 'file.yaml'
    path.write_text(text)
    with pytest.raises(error) as caught:
        read(path)
    assert str(caught.value).startswith(str(path))
    assert len(str(caught.value)) < 600


def test_nobody_else_reads_yaml():
    """A second reader would have other bounds, or none."""
    source = os.path.dirname(os.path.dirname(bounded_yaml.__file__))
    readers = []
    for folder, _, names in os.walk(source):
        for name in names:
            path = os.path.join(folder, name)
            if name.endswith('.py') and path != bounded_yaml.__file__:
                with open(path, encoding='utf-8') as stream:
                    readers += [path] if re.search(r'\byaml\.(?!safe_dump\b)\w|from yaml', stream.read()) else []
    assert readers == []
