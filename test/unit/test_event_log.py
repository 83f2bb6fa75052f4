"""Event logs of runs: reading them, and the first difference of two."""
import csv
import io
import json

import pytest

from move_base_abstract.runs import event_log
from move_base_abstract.runs.event_log import EventLog, EventLogError, compare, compare_bags, open_text

HEAD = '{"event_log":1,"start_ns":1000000000}'
EVENTS = ((1_000_000_000, 'robot_0', 'goal', [1.5, 'a']), (1_500_000_000, 'robot_1', 'arrived', []),
          (1_500_000_000, 'robot_0', 'arrived', [{'b': 1, 'a': None}]))


def end_record(count, not_repeatable=(), degraded=(), **more):
    return json.dumps({'end': {'events': count, 'repeatable': not not_repeatable, 'reason': 'SIGTERM',
                               'not_repeatable_because': list(not_repeatable), 'degraded_because': list(degraded),
                               **more}})


def json_text(events=EVENTS, end=True, **labels):
    lines = [HEAD] + [json.dumps(dict(zip(('time_ns', 'robot', 'kind', 'values'), event))) for event in events]
    return '\n'.join(lines + ([end_record(len(events), **labels)] if end else [])) + '\n'


def csv_text(events=EVENTS):
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator='\n')
    stream.write('# ' + HEAD + '\n')
    writer.writerow(('time_ns', 'robot', 'kind', 'values'))
    writer.writerows((*event[:3], json.dumps(event[3])) for event in events)
    stream.write('# ' + end_record(len(events)) + '\n')
    return stream.getvalue()


def log(text, name='a.jsonl'):
    return EventLog(io.StringIO(text, newline='\n'), name)


def compared(first, second):
    return compare(log(first), log(second, 'b.jsonl'))


def refused(text, *words):
    with pytest.raises(EventLogError) as error:
        list(log(text))
    for word in words:
        assert word in str(error.value)


@pytest.mark.parametrize('text', [json_text(), csv_text()])
def test_events_are_read_in_their_order_with_their_values(text):
    read = log(text)
    events = list(read)
    assert [(event.time_ns, event.robot, event.kind, json.loads(event.values)) for event in events] == list(EVENTS)
    assert read.end['reason'] == 'SIGTERM'
    assert read.remarks() == []


def test_equal_logs_are_identical_also_across_formats():
    for first, second in ((json_text(), json_text()), (json_text(), csv_text()), (csv_text(), json_text())):
        result = compared(first, second)
        assert result.identical
        assert result.counts == (3, 3)


def test_head_and_labels_are_not_compared_and_equal_values_may_be_spelled_differently():
    other = json_text(not_repeatable=['input from outside'], degraded=['/b died'])
    other = other.replace('"start_ns":1', '"start_ns":2').replace('[1.5, "a"]', '[ 1.50,"\\u0061"]')
    assert compared(json_text(), other).identical


@pytest.mark.parametrize('index, value', [(0, 1_500_000_001), (1, 'robot_10'), (2, 'failed'), (3, [0])])
def test_the_first_difference_is_found_whatever_part_of_the_event_it_is_in(index, value):
    changed = list(EVENTS[1])
    changed[index] = value
    result = compared(json_text(), json_text((EVENTS[0], tuple(changed), EVENTS[2])))
    assert not result.identical
    assert (result.first.line, result.second.line) == (3, 3)
    assert result.first.compared != result.second.compared
    assert result.counts == (3, 3)


@pytest.mark.parametrize('one, other', [(1, 1.0), (1, True), (0.0, -0.0), (0.1, 0.10000000000000002), ('1', 1)])
def test_values_of_different_kinds_or_in_the_last_bit_are_different(one, other):
    first, second = (json_text(((1, 'a', 'k', [value]),)) for value in (one, other))
    assert not compared(first, second).identical


def test_events_at_one_instant_in_another_order_are_different():
    assert not compared(json_text(), json_text((EVENTS[0], EVENTS[2], EVENTS[1]))).identical


def test_a_log_that_is_the_beginning_of_the_other_is_different_where_it_ends():
    result = compared(json_text(), json_text(EVENTS[:2]))
    assert (result.first.line, result.second, result.counts) == (4, None, (3, 2))


def test_line_numbers_of_csv_count_its_two_head_lines():
    result = compared(csv_text(), csv_text(EVENTS[1:]))
    assert (result.first.line, result.second.line) == (3, 3)
    assert result.first.text.startswith('1000000000,robot_0,goal,')


def test_a_run_without_an_end_record_is_told_and_a_cut_last_line_is_no_event():
    whole = json_text(end=False)
    for text in (whole, whole + '{"time_ns":20000', csv_text().split('# {"end"')[0] + '17'):
        read = log(text)
        assert len(list(read)) == 3
        assert read.end is None
        assert read.remarks() == ['has no end record: the run did not end properly']


def test_labels_are_told():
    read = log(json_text(not_repeatable=['input from outside'], degraded=['/b died']))
    list(read)
    assert read.remarks() == ['not repeatable: input from outside', 'degraded: /b died']


def test_a_run_that_was_cut_is_told_with_the_instant():
    read = log(json_text(cut_ns=12_300_000_000))
    list(read)
    [label] = event_log.labels_of(read.end)
    assert 'ended from outside at 12.300000000 s: it is repeatable up to there' in label
    assert read.remarks() == [label]


def test_a_fault_that_ended_the_run_is_told():
    for by_fault, remarks in ((True, ['ended by a fault: SIGTERM']), (False, [])):
        read = log(json_text(by_fault=by_fault))
        list(read)
        assert read.remarks() == remarks


def test_text_with_quotes_commas_and_bytes_that_are_no_text_survives():
    events = ((1, 'a "b", c', 'k', ['x,"y"', '\udcff']),)
    assert compared(json_text(events), csv_text(events)).identical


@pytest.mark.parametrize('text, words', [
    ('', ('a.jsonl:1', 'is not JSON')),
    ('time,robot\n', ('a.jsonl:1', 'is not JSON', "got 'time,robot'")),
    ('{"event_log":2}\n', ('a.jsonl:1', 'format 1', '"event_log":2')),
    ('{"event_log":true}\n', ('a.jsonl:1', 'format 1')),
    ('[1]\n', ('a.jsonl:1', 'format 1')),
    (f'# {HEAD}\ntime,robot\n', ('a.jsonl:2', 'time_ns,robot,kind,values')),
    (f'{HEAD}\nnonsense\n', ('a.jsonl:2', 'is not JSON', "got 'nonsense'")),
    (f'{HEAD}\n[]\n', ('a.jsonl:2', 'must hold time_ns')),
    (HEAD + '\n{"time_ns":1.0,"robot":"a","kind":"k","values":[]}\n', ('a.jsonl:2', 'must hold time_ns')),
    (HEAD + '\n{"time_ns":1,"robot":"a","kind":"k","values":{}}\n', ('a.jsonl:2', 'values (a list)')),
    (HEAD + '\n{"time_ns":1,"robot":"a","kind":"k"}\n', ('a.jsonl:2', 'must hold time_ns')),
    (HEAD + '\n{"end":{}}\n', ('a.jsonl:2', 'must be an end record')),
    (HEAD + '\n' + end_record(0, cut_ns=1.5) + '\n', ('a.jsonl:2', 'cut_ns')),
    (HEAD + '\n' + end_record(7) + '\n', ('a.jsonl:2', 'has another number of events than were read, 0')),
    (json_text() + 'more\n', ('a.jsonl:6', 'is not JSON')),
    (json_text() + json_text().split('\n')[1] + '\n', ('a.jsonl:6', 'after the end record')),
    (HEAD + '\n' + '[' * 100000 + '\n', ('a.jsonl:2', 'is not JSON')),
    (f'# {HEAD}\ntime_ns,robot,kind,values\n1,a,k\n', ('a.jsonl:3', 'must hold time_ns,robot,kind,values')),
    (f'# {HEAD}\ntime_ns,robot,kind,values\nx,a,k,[]\n', ('a.jsonl:3', 'must hold')),
    (f'# {HEAD}\ntime_ns,robot,kind,values\n1,a,k,"[]"x\n', ('a.jsonl:3', 'must hold')),
    (f'# {HEAD}\ntime_ns,robot,kind,values\n1,a,k,[\n', ('a.jsonl:3', 'is not JSON')),
])
def test_a_damaged_file_is_refused_with_line_and_reason(text, words):
    refused(text, *words)


def test_a_file_that_is_not_there_is_named_and_so_is_that_of_an_unfinished_run(tmp_path):
    path = str(tmp_path / 'run.jsonl')
    with pytest.raises(EventLogError, match=r'run\.jsonl: cannot be read: No such file or directory$'):
        open_text(path).__enter__()
    (tmp_path / 'run.jsonl.part').write_text(HEAD)
    with pytest.raises(EventLogError, match=r'run\.jsonl\.part is there'):
        open_text(path).__enter__()


def bag(node='/recorder', name='run.bag', size=10, sha256='aa'):
    return {'node': node, 'name': name, 'bytes': size, 'sha256': sha256}


def read_with_bags(*bags):
    lines = json_text().splitlines(True)
    end = json.loads(lines[-1])
    end['end']['bags'] = list(bags)
    read = log(''.join(lines[:-1]) + json.dumps(end) + '\n')
    list(read)
    return read


def test_bags_are_compared_by_their_digests_and_not_by_their_names():
    first = read_with_bags(bag('/b'), bag('/a', sha256='1'), bag('/a', sha256='2'))
    same = read_with_bags(bag('/a', name='other.bag', sha256='1'), bag('/a', sha256='2'), bag('/b'))
    assert compare_bags(first, same) == (None, [])
    for other, number, found in ((read_with_bags(bag('/a', sha256='1'), bag('/a', sha256='3'), bag('/b')), 2, '3'),
                                 (read_with_bags(bag('/a', sha256='1'), bag('/b')), 2, None)):
        difference, alone = compare_bags(first, other)
        assert (difference.node, difference.number, difference.first['sha256'], alone) == ('/a', number, '2', [])
        assert (difference.second or {}).get('sha256') == found


def test_whose_bags_only_one_run_has_is_told():
    assert compare_bags(read_with_bags(bag('/b'), bag('/a')), read_with_bags(bag('/b'))) == (None, ['/a'])
    assert compare_bags(read_with_bags(bag()), log_without_bags()) == (None, ['/recorder'])


def log_without_bags():
    read = log(json_text())
    list(read)
    return read


@pytest.mark.parametrize('bags', [{}, ['x'], [{'node': 1}], [dict(bag(), bytes='1')], None])
def test_bags_that_are_none_are_refused(bags):
    lines = json_text().splitlines(True)
    end = json.loads(lines[-1])
    end['end']['bags'] = bags
    refused(''.join(lines[:-1]) + json.dumps(end) + '\n', 'bags', ':5:')
