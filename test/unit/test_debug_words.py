"""The words of a debugger's commands: what they ask for, and what is said to those that ask for nothing."""
import pytest

from move_base_abstract_ros.debugging import stop_words
from move_base_abstract_ros.debugging.stop_words import Back, UntilBroken
from move_base_abstract_ros.debugging.stops import NEVER, ROW, Refused, Stop


@pytest.mark.parametrize('text, wanted', [
    ('result robot_1', Stop(ROW, kind='ended', robot='robot_1')),
    ('result /robot_1', Stop(ROW, kind='ended', robot='robot_1')),
    ('result /robot_9', Stop(ROW, kind='ended', robot='robot_9')),
    ('result ns/bot', Stop(ROW, kind='ended', robot='/ns/bot')),
    ('message /fleet/status', Stop(ROW, topic='/fleet/status')),
    ('message fleet/status', Stop(ROW, topic='/fleet/status')),
    ('row stands', Stop(ROW, kind='stands')),
    ('row stands /robot_1', Stop(ROW, kind='stands', robot='robot_1')),
    ('row uncaught /coordinator', Stop(ROW, kind='uncaught', robot='/coordinator')),
    ('12.5', Stop(ROW, times=0, row=NEVER, until_ns=12_500_000_000)),
    ('0.000000001', Stop(ROW, times=0, row=NEVER, until_ns=1)),
    ('deadlock', Stop(ROW, kind='deadlock')),
    ('end', Stop(ROW, times=0, row=NEVER)),
    ('broken', UntilBroken(('all',))),
    ('broken charged no_crash', UntilBroken(['charged', 'no_crash']))])
def test_until_asks_for_a_stop(text, wanted):
    assert stop_words.until(text.split(), ['robot_1', '/ns/bot']) == wanted


@pytest.mark.parametrize('text, said', [
    ('', "until takes result ROBOT, .*; got ''"), ('resultt a', "did you mean 'result'"), ('result', 'result ROBOT'),
    ('result a b', 'result ROBOT'), ('message', 'message TOPIC'), ('row', 'row KIND'), ('row a b c', 'row KIND'),
    ('deadlock x', 'deadlock'), ('end x', 'end'), ('broken nothing', 'no_crash'), ('1e99', 'number of simulated'),
    ('12.5 s', 'until takes'), ('-3', 'until takes'), ('1,5', 'number of simulated seconds')])
def test_other_words_are_refused_with_what_is_allowed(text, said):
    with pytest.raises(Refused, match=said):
        stop_words.until(text.split(), [])


@pytest.mark.parametrize('text, wanted', [
    ('', Back(rows=1)), ('5', Back(rows=5)), ('2.5s', Back(time_ns=2_500_000_000))])
def test_back_takes_rows_or_a_time(text, wanted):
    assert stop_words.back(text.split()) == wanted


@pytest.mark.parametrize('text', ['0', '-1', '1.5', 'x', '3 s', 'xs', 's', '1 2'])
def test_back_refuses_other_words(text):
    with pytest.raises(Refused, match='back'):
        stop_words.back(text.split())


@pytest.mark.parametrize('text', ['nan', 'inf', 'Infinity', '1_000', '²', ''])
def test_a_number_of_seconds_is_a_finite_number(text):
    with pytest.raises(Refused, match='must be a number of simulated seconds'):
        stop_words.nanoseconds(text, 'at')
