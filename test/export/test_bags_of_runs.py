"""Bags of runs: the topics that a recorder leaves out, digests in event logs, the first message that differs."""
import json
import os
import sys
from pathlib import Path

import pytest
import rosbag
import rospy

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / 'src'))

from geometry_msgs.msg import PoseArray, PoseStamped  # noqa: E402
from std_msgs.msg import Float64, String  # noqa: E402

from move_base_abstract.common.input_files import sha256_of  # noqa: E402
from move_base_abstract.fleet import Fleet  # noqa: E402
from move_base_abstract.runs.event_log import EventLog  # noqa: E402
from move_base_abstract.scenario import make_scenario  # noqa: E402
from move_base_abstract_ros.launching import (  # noqa: E402
    bag_difference,
    bags,
    message_fields,  # noqa: E402
)
from move_base_abstract_ros.lockstep.programs import recorders  # noqa: E402
from move_base_abstract_ros.nodes import compare  # noqa: E402

PAST = '/clock|/rosout|/rosout_agg|/time_master/.*'


@pytest.mark.parametrize('words, expected', [
    ('-a', f'-a -x {PAST}'), ('-aO run.bag', f'-aO run.bag -x {PAST}'), ('-e /robot.*', f'-e /robot.* -x {PAST}'),
    ('--all -x /a.*', f'--all -x (?:/a.*)|{PAST}'), ('-a -x/a|/b -q', f'-a -x(?:/a|/b)|{PAST} -q'),
    ('-aqx /a', f'-aqx (?:/a)|{PAST}'), ('--al --excl=/a', f'--al --excl=(?:/a)|{PAST}'),
    ('--exclude /a --regex /b', f'--exclude (?:/a)|{PAST} --regex /b'), ('--node /n', f'--node /n -x {PAST}'),
    ('-O -a /odom', '-O -a /odom'), ('/odom /tf __name:=a', '/odom /tf __name:=a'), ('-o all /odom', '-o all /odom'),
    ('--duration=30 --split /a', '--duration=30 --split /a'), ('--output-name --all /a', '--output-name --all /a')])
def test_who_looks_for_topics_leaves_out_those_that_go_past_lockstep(words, expected):
    assert ' '.join(recorders.without_past_lockstep(words.split())).replace('\\', '') == expected


def test_what_a_recorder_names_although_it_goes_past_lockstep_is_told():
    assert recorders.past_lockstep(['-a'], '/') == (['/clock', '/rosout', '/rosout_agg', '/time_master/...'], [])
    assert recorders.past_lockstep(['rosout', '/odom', '/noise', '/time_master/state'], '/', ['/noise']) == (
        [], ['rosout', '/noise', '/time_master/state'])
    assert recorders.past_lockstep(['rosout'], '/robot') == ([], [])  # the node's own topic, /robot/rosout


def test_scripts_that_record_are_known(tmp_path):
    for text, starts, becomes in (('#!/bin/sh\nexec rosbag record -a\n', True, True),
                                  ('#!/bin/bash\nrosbag record -a "$@"\n', True, True),
                                  ('#!/bin/bash\nrosrun rosbag record -a "$@"\n', True, False),
                                  ('#!/bin/bash\nrosbag record -a &\nexec ./a.py "$@"\n', True, False),
                                  ('#!/bin/sh\nrosbag info a.bag\n', False, False)):
        (tmp_path / 'script').write_text(text)
        assert (recorders.starts_recorder(str(tmp_path / 'script')),
                recorders.becomes_recorder(text.encode())) == (starts, becomes), text


def test_the_front_end_says_what_program_it_starts():
    path, words = recorders.behind_front_end('/usr/bin/rosbag', ['record', '-a', '-O', 'x', '__name:=recorder'])
    assert recorders.is_program(path)
    assert words[-4:] == ['-O', 'x', '--all', '__name:=recorder']
    assert recorders.behind_front_end('/usr/bin/rosbag', ['play', 'x.bag']) is None


def write_bag(path, values, topic='/said', kind=String):
    with rosbag.Bag(str(path), 'w') as bag:
        for second, value in enumerate(values, 1):
            bag.write(topic, kind(value), rospy.Time(second))
    return str(path)


def write_log(path, events=0):
    end = {'events': events, 'repeatable': True, 'not_repeatable_because': [], 'degraded_because': [], 'reason': 'é'}
    head = '# ' if path.suffix == '.csv' else ''
    columns = 'time_ns,robot,kind,values\n' if head else ''
    path.write_text(f'{head}{{"event_log":1,"start_ns":0}}\n{columns}{head}{json.dumps({"end": end})}\n')
    return str(path)


def read_log(path):
    with open(path, encoding='utf-8') as stream:
        log = EventLog(stream, path)
        list(log)
    return log


@pytest.mark.parametrize('ending', ['.jsonl', '.csv'])
def test_digests_of_closed_bags_are_in_the_end_record_and_open_ones_label_the_run(tmp_path, ending):
    closed = write_bag(tmp_path / 'a.bag', ['x'])
    notes = tmp_path / 'notes'
    (tmp_path / 'b.bag.active').write_text('cut off')
    notes.write_bytes(b''.join(f'{node}\0{path}\0'.encode() for node, path in (
        ('/one', closed + '.active'), ('/two', tmp_path / 'b.bag.active'), ('/one', tmp_path / 'gone.bag.active'),
        ('/one', closed + '.active'))))
    found = bags.written(str(notes))
    assert [(bag.node, bag.path, bag.problem) for bag in found if bag.problem != bags.LITTLE_SPACE] == [
        ('/one', closed, None), ('/two', str(tmp_path / 'b.bag.active'), 'it was not closed')]
    log = write_log(tmp_path / ('log' + ending))
    bags.add_to_log(log, found)
    read = read_log(log)
    assert read.end['not_repeatable_because'] == ["the bag of '/two' is not covered: it was not closed"]
    assert read.end['repeatable'] is False and read.end['reason'] == 'é'
    assert read.bags == {'/one': [{'node': '/one', 'name': 'a.bag', 'bytes': os.path.getsize(closed),
                                   'sha256': sha256_of(closed)}]}


def test_a_log_without_an_end_stays_as_it_is(tmp_path):
    found = [bags.Bag('/one', '/x.bag', 1, 'aa', None)]
    (tmp_path / 'log.jsonl').write_text('{"event_log":1,"start_ns":0}\n')
    before = (tmp_path / 'log.jsonl').read_bytes()
    bags.add_to_log(str(tmp_path / 'log.jsonl'), found)
    bags.add_to_log(str(tmp_path / 'none.jsonl'), found)
    assert (tmp_path / 'log.jsonl').read_bytes() == before


def test_a_disk_with_little_space_is_told(tmp_path, monkeypatch):
    notes = tmp_path / 'notes'
    notes.write_bytes(f'/one\0{write_bag(tmp_path / "a.bag", ["x"])}.active\0'.encode())
    monkeypatch.setattr(bags.os, 'statvfs', lambda _path: type('Space', (), {'f_bavail': 100, 'f_frsize': 4096}))
    assert bags.written(str(notes))[0].problem == bags.LITTLE_SPACE


def run_compare(*words):
    with pytest.raises(SystemExit) as ended:
        compare.main([str(word) for word in words])
    return ended.value.code


def test_compare_names_the_first_message_that_differs(tmp_path, capsys):
    logs = []
    for name, values in (('one', ['x', 'y', 'z']), ('two', ['x', 'q', 'z'])):
        (tmp_path / name).mkdir()
        bag = write_bag(tmp_path / name / 'run.bag', values)
        logs.append(write_log(tmp_path / name / 'log.jsonl'))
        bags.add_to_log(logs[-1], [bags.Bag('/recorder', bag, os.path.getsize(bag), sha256_of(bag), None)])
    assert run_compare(logs[0], logs[0]) == 0
    assert '0 events each, 1 bags each' in capsys.readouterr().out
    for files in (logs, [tmp_path / name / 'run.bag' for name in ('one', 'two')]):
        assert run_compare(*files) == 1
        said = capsys.readouterr().out
        assert said.startswith('different\n')
        assert 'first difference: message 2' in said
        assert '2.000000000 s: /said (std_msgs/String), 5 bytes' in said
        assert "data: 'y' / 'q'" in said
    assert run_compare(tmp_path / 'one' / 'run.bag', tmp_path / 'no.bag') == 2


@pytest.mark.parametrize('rows, is_told', [('', True), (
    '{"time_ns":1,"robot":"a","kind":"arrived","values":[]}\n', False)])
def test_logs_without_events_are_not_compared_and_compare_says_so(tmp_path, capsys, rows, is_told):
    for name in ('a.jsonl', 'b.jsonl'):
        (tmp_path / name).write_text('{"event_log":1}\n' + rows)
    assert run_compare(tmp_path / 'a.jsonl', tmp_path / 'b.jsonl') == 0
    assert ('note: nothing was compared: no log has an event\n' in capsys.readouterr().out) == is_told


def test_a_shorter_bag_and_one_that_is_none_are_told(tmp_path):
    one, other = write_bag(tmp_path / 'a.bag', ['x', 'y']), write_bag(tmp_path / 'b.bag', ['x'])
    assert [line for line in bag_difference.find(one, other) if 'no more' in line] == [f'  {other}: no more messages']
    (tmp_path / 'c.bag').write_text('#ROSBAG V2.0\nnot really')
    with pytest.raises(bag_difference.BagError):
        bag_difference.find(one, str(tmp_path / 'c.bag'))


def raw(message):
    from io import BytesIO
    stream = BytesIO()
    message.serialize(stream)
    return stream.getvalue()


def test_fields_of_two_messages_are_compared():
    one, other = PoseStamped(), PoseStamped()
    other.header.stamp = rospy.Time(3, 4)
    other.pose.position.x = 1.5
    assert message_fields.difference(PoseStamped, raw(one), raw(other)) == [
        'header.stamp [ns]: 0 / 3000000004', 'pose.position.x: 0.0 / 1.5']
    one, other = PoseArray(), PoseArray(poses=[PoseStamped().pose])
    assert message_fields.difference(PoseArray, raw(one), raw(other))[:2] == [
        'poses.length: 0 / 1', 'poses[0].position.x: not there / 0.0']
    nan, zero, minus = (raw(Float64(value)) for value in (float('nan'), 0.0, -0.0))
    assert message_fields.difference(Float64, zero, minus) == ['data: 0.0 / -0.0']
    assert message_fields.difference(Float64, nan, nan[:6] + b'\xf9' + nan[7:])[0].startswith('all fields are equal')
    assert message_fields.difference(Float64, nan, b'')[0].startswith('the messages cannot be read')
    assert message_fields.class_of('no_such/Type') is None
    assert message_fields.difference(None, b'', b'a') == ['the type of the message is not known here']


def test_bytes_that_were_kept_are_found_by_number(tmp_path):
    (tmp_path / 'kept').write_bytes(b''.join(
        len(part).to_bytes(4, 'little') + part for part in (b'a/B', b'one', b'', b'call', b'c/D', b'')) + b'\1\0')
    found = [message_fields.kept(str(tmp_path / 'kept'), number) for number in (1, 2, 3, 4)]
    assert found == [('a/B', b'one'), ('', b'call'), ('c/D', b''), None]
    assert message_fields.kept(str(tmp_path / 'none'), 1) is None


def test_compare_says_that_a_log_of_an_earlier_release_has_no_rows_of_goals(tmp_path, capsys):
    fleet = Fleet(make_scenario({'robots': [{'name': 'bot'}]}))
    fleet.robot('bot').send(4.0, 0.0)
    fleet.run()
    fleet.write_log(tmp_path / 'new.jsonl')
    old = Fleet(trace=[entry for entry in fleet.trace if entry.kind != 'goal'])
    old.write_log(tmp_path / 'old.jsonl')
    assert run_compare(tmp_path / 'old.jsonl', tmp_path / 'new.jsonl') == 1
    text = capsys.readouterr().out
    assert f'note: {tmp_path / "old.jsonl"} has goals that ended, but no rows `goal`: it is of release 1.0' in text
    assert text.count('note: ') == 1
