"""The first difference of two runs: where, who sent what, and what the nodes had been told before."""
import json

import pytest

from move_base_abstract.runs import run_difference
from move_base_abstract.runs.event_log import EventLogError

SECOND = 10 ** 9


def message(time_s, topic, sender, *receivers, data='0'):
    return {'time_ns': time_s * SECOND, 'robot': topic, 'kind': 'message', 'values': [sender, *receivers, 8, data]}


def event(time_s, robot, kind, *values):
    return {'time_ns': time_s * SECOND, 'robot': robot, 'kind': kind, 'values': list(values)}


@pytest.fixture
def compare(tmp_path):
    def write(name, events, bags):
        end = {'end': {'events': len(events), 'repeatable': True, 'not_repeatable_because': [], 'degraded_because': [],
                       'reason': 'over', 'bags': bags}}
        lines = [json.dumps(record) for record in [{'event_log': 1, 'start_ns': SECOND}, *events, end]]
        (tmp_path / name).write_text('\n'.join(lines) + '\n')
        return str(tmp_path / name)

    def compare(first, second, bags=((), ()), **options):
        return run_difference.compare(write('a.jsonl', first, list(bags[0])), write('b.jsonl', second, list(bags[1])),
                                      **options)
    return compare


def test_equal_logs_are_counted(compare):
    events = [event(1, 'robot_0', 'goal'), message(1, '/a', '/x', '/y'), message(2, '/a', '/x', '/y')]
    found = compare(events, events)
    assert (found.events, found.messages, found.difference) == (1, 2, None)


def test_the_first_difference_has_both_versions_and_its_place_at_its_instant(compare):
    same = [event(1, 'robot_0', 'goal'), message(2, '/a', '/x', '/y'), message(2, '/b', '/x', '/y')]
    found = compare([*same, message(2, '/c', '/y', '/x', data='1')], [*same, message(2, '/c', '/y', '/x', data='2')])
    difference = found.difference
    assert (difference.time_ns, difference.place) == (2 * SECOND, 3)
    assert json.loads(difference.first.values)[-1] == '1'
    assert json.loads(difference.second.values)[-1] == '2'


def test_what_the_senders_of_both_versions_were_told_last_is_given(compare):
    same = [message(k, '/a', '/x', '/y', '/z') for k in range(1, 15)] + [message(15, '/b', '/y', '/x')]
    found = compare([*same, message(16, '/c', '/y', '/x')], [*same, message(16, '/d', '/x', '/y')])
    assert list(found.difference.told) == ['/y', '/x']
    assert [event.time_ns // SECOND for event in found.difference.told['/y']] == list(range(5, 15))
    assert [event.robot for event in found.difference.told['/x']] == ['/b']


def test_a_log_that_ends_sooner_differs_where_it_ends(compare):
    same = [message(1, '/a', '/x', '/y')]
    for first, second in ((same, [*same, event(1, 'r', 'more')]), ([*same, event(1, 'r', 'more')], same)):
        difference = compare(first, second).difference
        assert (difference.time_ns, difference.place) == (SECOND, 2)
        assert (difference.first is None) == (first is same)
        assert (difference.second is None) == (second is same)


def test_without_messages_only_the_other_events_count(compare):
    first = [event(1, 'r', 'goal'), message(2, '/a', '/fleet', '/y'), event(3, 'r', 'arrived')]
    second = [event(1, 'r', 'goal'), message(2, '/a', '/fleet_part_1', '/y'), event(3, 'r', 'arrived')]
    assert compare(first, second).difference is not None
    assert compare(first, second, with_messages=False).difference is None


def test_calls_and_answers_are_told_with_sender_and_receivers(compare):
    call = dict(message(1, '/s', '/x', '/y'), kind='call')
    answer = {'time_ns': SECOND, 'robot': '/s', 'kind': 'response', 'values': ['/y', '/x', 0, 5, 'abc']}
    found = compare([call, answer], [call, dict(answer, values=['/y', '/x', 1, 5, 'abc'])])
    assert run_difference.receivers(found.difference.first) == ['/x']
    assert run_difference.told_lines(found.difference.first) == (
        '1.000000000 s: response /s from /y to /x, 5 bytes, hash abc')
    assert [event.kind for event in found.difference.told['/y']] == ['call']


def test_a_file_that_is_no_log_is_refused(tmp_path):
    (tmp_path / 'a').write_text('nothing')
    with pytest.raises(EventLogError, match='is not JSON'):
        run_difference.compare(str(tmp_path / 'a'), str(tmp_path / 'a'))


def test_what_is_the_same_in_another_order_is_said(compare):
    same = [message(1, '/a', '/x', '/y')]
    one, other = message(2, '/b', '/x', '/y'), message(2, '/c', '/y', '/x')
    difference = compare(same + [one, other, message(3, '/d', '/x', '/y')], same + [other, one]).difference
    assert (difference.is_reordered, difference.number) == (True, 2)
    difference = compare(same + [one, other], same + [other, dict(one, time_ns=3 * SECOND)]).difference
    assert (difference.is_reordered, difference.number) == (False, 2)


def test_where_events_are_equal_the_bags_are_compared(compare):
    bags = [[{'node': '/recorder', 'name': 'x.bag', 'bytes': 3, 'sha256': digest}] for digest in ('1', '2')]
    events = [message(1, '/a', '/x', '/y')]
    found = compare(events, events, bags=bags)
    assert (found.identical, found.difference, found.bags.node) == (False, None, '/recorder')
    assert compare(events, events, bags=bags[:1] * 2).identical
    assert compare(events, events, bags=bags, with_messages=False).identical  # they hold the names of senders
