"""Values in error texts are short, and cost nothing to shorten."""
import subprocess

import pytest

from move_base_abstract.common.bounded_yaml import load_yaml_text
from move_base_abstract.common.shown import MAX_LENGTH, first_lines, first_of, pasted, printable, shown, shown_text


def doubled(times):
    """Return a list that would be written out as 2 ** ``times`` numbers."""
    value = [7]
    for _ in range(times):
        value = [value, value]
    return value


def deep(times):
    value = []
    for _ in range(times):
        value = [value]
    return value


@pytest.mark.parametrize('value', [None, True, 3, -2.5, 'two words', "it's", [1, 2], {'a': [1.0]}, (1, 'x'), {1}])
def test_what_is_short_is_written_as_python_writes_it(value):
    assert shown(value) == repr(value)


@pytest.mark.parametrize('value', [
    doubled(200), deep(100_000), 'x' * 10_000_000, {'k' * 500: 'v' * 500, 2: doubled(200)},
    [list(range(1000))] * 1000, {str(key): key for key in range(1000)}, {(number,) for number in range(1000)}])
def test_what_is_long_is_cut_without_making_all_of_it(value):
    assert len(shown(value)) <= MAX_LENGTH


def test_a_number_that_python_refuses_to_write_is_described():
    assert shown(10 ** 5000) == 'a whole number of about 5001 digits'
    assert shown(-10 ** 5000) == 'a whole number of about 5001 digits'
    assert shown([10 ** 5000]) == '[a whole number of about 5001 digits]'
    assert shown(10 ** 50) == repr(10 ** 50)


def test_texts_stand_as_they_are_but_for_control_characters():
    assert shown_text('max_speed') == 'max_speed'
    assert shown_text('gr\u00fcn \u2713') == 'gr\u00fcn \u2713'
    assert shown_text('a\nb\x1b[31m') == 'a\\nb\\x1b[31m'
    assert shown_text(7) == '7'
    assert len(shown_text('x' * 10_000_000)) == MAX_LENGTH
    assert len(shown_text('\x00' * 1000)) <= MAX_LENGTH
    assert len(shown_text(doubled(200))) <= MAX_LENGTH


@pytest.mark.parametrize(('text', 'has_note'), [
    ('1e308', True), ('-2E-3', True), ('1.5e3', True), ('1.e3', True), ('1e', False), ('e3', False), ('1e3 m', False)])
def test_a_number_that_yaml_reads_as_a_text_has_a_note(text, has_note):
    assert isinstance(load_yaml_text(text, 'here'), str)
    assert ('1.0e+3' in shown(text)) == has_note
    assert isinstance(load_yaml_text('1.0e+3', 'here'), float)


@pytest.mark.parametrize('word', ['plain', 'a b', "it's", '', 'größe', '\u202egnp.x', "a\n'\\", '\x1b[2J',
                                  '\udcff\u061c', '\U000e0001'])
def test_what_people_paste_has_nothing_that_cannot_be_seen_and_means_the_same(word):
    text = pasted('printf', '%s', word)
    assert text.isprintable()
    done = subprocess.run(['bash', '-c', text], env={'LC_ALL': 'C.UTF-8'}, stdout=subprocess.PIPE, check=True)
    assert done.stdout == word.encode('utf-8', 'surrogateescape')


def test_of_many_names_and_lines_the_first_ones_are_shown_and_the_others_counted():
    assert first_of(['a', 'b'], 2) == 'a, b'
    assert first_of(['a', 'b', 'c', 'd'], 2) == 'a, b and 2 more'
    assert first_of([], 2) == ''
    assert first_lines(['a', 'b'], 2) == ['a', 'b']
    assert first_lines(('a', 'b', 'c'), 2, '... and {} more that wait') == ['a', 'b', '... and 1 more that wait']


def test_signs_that_end_a_line_or_control_a_terminal_are_shown_as_codes():
    assert printable('a\nb\x1b\u2028ö') == r'a\nb\x1b\u2028ö'
