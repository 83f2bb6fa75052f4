"""Replays as MCAP files and bags: their content, that they can be read, and that equal logs give equal bytes."""
import json
import struct
import subprocess
import sys
import zlib
from pathlib import Path

import pytest
import rosbag

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / 'src'))

from move_base_msgs.msg import MoveBaseActionGoal, MoveBaseActionResult  # noqa: E402

from move_base_abstract.common.errors import ConfigurationError  # noqa: E402
from move_base_abstract.fleet import Fleet  # noqa: E402
from move_base_abstract.scenario import make_scenario  # noqa: E402
from move_base_abstract_replay import command  # noqa: E402
from move_base_abstract_replay.export import write_bag, write_mcap  # noqa: E402
from move_base_abstract_replay.mcap_file import McapWriter  # noqa: E402

S = 1_000_000_000


@pytest.fixture(scope='module')
def fleet():
    """Return a fleet that has driven: a robot whose first goal was replaced, and a robot without a way to its goal."""
    defaults = {'max_speed': 1.0, 'acceleration': 0.5, 'turn_rate': 1.0, 'log_motion': True,
                'world_bounds': [-9.0, -9.0, 9.0, 9.0]}
    fleet = Fleet(make_scenario({'defaults': defaults,
                                 'robots': [{'name': 'a'}, {'name': 'b', 'start_y': 2.0}]}))
    fleet.robot('a').send(4.0, 3.0, 1.0)
    fleet.robot('b').send(90.0, 0.0)
    fleet.at(4 * S, lambda fleet: fleet.robot('a').send(0.0, 5.0))
    poses = {}
    for k in range(10, 140):
        fleet.at(k * S // 10, lambda fleet: poses.update({fleet.now_ns: fleet.robot('a').pose}))
    fleet.run()
    fleet.poses = poses
    return fleet


@pytest.fixture
def log(fleet, tmp_path):
    """Return the path of the fleet's log."""
    lines = ['{"event_log":1,"start_ns":1000000000}']
    lines += [json.dumps(dict(entry._asdict(), values=list(entry.values))) for entry in fleet.trace]
    path = tmp_path / 'run.jsonl'
    path.write_text('\n'.join(lines) + '\n')
    return path


def records(data, begin, end):
    """Yield (opcode, content, offset) for the records of an MCAP file between two offsets."""
    while begin < end:
        code, length = struct.unpack_from('<BQ', data, begin)
        yield code, data[begin + 9:begin + 9 + length], begin
        begin += 9 + length


def text_at(data, at):
    length, = struct.unpack_from('<I', data, at)
    return data[at + 4:at + 4 + length].decode(), at + 4 + length


def read_mcap(data):
    """Return [(topic, time [ns], bytes)] of an MCAP file; check all its checksums and indexes."""
    assert data[:8] == data[-8:] == b'\x89MCAP0\r\n'
    start, offsets, crc = struct.unpack('<QQI', data[-28:-8])
    assert zlib.crc32(data[start:-12]) == crc
    topics, found, indexed, data_end = {}, [], [], None
    for code, content, at in records(data, 8, len(data) - 8):
        if code == 6:  # chunk
            size, sum_of_records = struct.unpack_from('<QI', content, 16)
            assert content[28:32] == bytes(4) and len(content) == 40 + size
            chunk = content[40:]
            assert zlib.crc32(chunk) == sum_of_records
            for inner, body, offset in records(chunk, 0, size):
                if inner == 4:
                    topics[struct.unpack_from('<H', body)[0]] = text_at(body, 4)[0]
                elif inner == 5:
                    channel, _, time_ns = struct.unpack_from('<HIQ', body)
                    found.append((topics[channel], time_ns, body[22:]))
                    indexed.append((channel, time_ns, offset))
        elif code == 7:  # message index
            channel, length = struct.unpack_from('<HI', content)
            for pair in struct.iter_unpack('<QQ', content[6:6 + length]):
                indexed.remove((channel, *pair))
        elif code == 15:
            data_end = at
            assert struct.unpack('<I', content)[0] == zlib.crc32(data[:at])
        elif code == 14:
            group, begin, length = struct.unpack('<BQQ', content)
            assert {code for code, _, _ in records(data, begin, begin + length)} == {group}
    assert indexed == [] and data_end < start < offsets
    return found


def read_bag(path):
    with rosbag.Bag(str(path)) as bag:
        return [(topic, stamp.to_nsec(), message) for topic, message, stamp in bag.read_messages()]


def test_poses_are_those_of_the_fleet_at_every_instant(fleet, log, tmp_path):
    write_bag(log, tmp_path / 'run.bag')
    told = {time_ns: message for topic, time_ns, message in read_bag(tmp_path / 'run.bag') if topic == '/a/robot_pose'}
    grid = [time_ns for time_ns in fleet.poses if time_ns in told]
    assert len(grid) > 90
    for time_ns in grid:
        position, turn = told[time_ns].pose.position, told[time_ns].pose.orientation
        pose = fleet.poses[time_ns]
        assert (position.x, position.y) == pytest.approx((pose.x, pose.y), abs=1e-9)
        assert told[time_ns].header.stamp.to_nsec() == time_ns and turn.x == turn.y == 0.0


def test_goals_results_and_events_are_told_with_the_ids_of_the_log(fleet, log, tmp_path):
    write_bag(log, tmp_path / 'run.bag')
    found = read_bag(tmp_path / 'run.bag')
    goals = [message.goal_id.id for topic, _, message in found if topic == '/a/move_base/goal']
    results = [(message.status.goal_id.id, message.status.status) for topic, _, message in found
               if topic.endswith('/result')]
    assert goals == ['a-1', 'a-2']
    assert sorted(results) == [('a-1', 2), ('a-2', 3), ('b-1', 4)]
    assert [json.loads(message.data)['kind'] for topic, _, message in found if topic == '/event_log'] == [
        entry.kind for entry in fleet.trace]
    assert {'/tf', '/a/odom'} <= {topic for topic, _, _ in found}


def test_a_goal_that_is_open_at_the_end_of_the_log_has_its_id(tmp_path):
    fleet = Fleet(make_scenario({'robots': [{'name': 'a', 'log_motion': True}]}))
    fleet.robot('a').send(50.0, 0.0, goal_id='open')
    fleet.run(until=5.0)
    fleet.write_log(tmp_path / 'run.jsonl')
    write_bag(tmp_path / 'run.jsonl', tmp_path / 'run.bag')
    assert [message.goal_id.id for topic, _, message in read_bag(tmp_path / 'run.bag') if '/goal' in topic] == ['open']


def test_an_mcap_file_holds_what_the_bag_holds(log, tmp_path):
    write_bag(log, tmp_path / 'run.bag', rate=50.0)
    write_mcap(log, tmp_path / 'run.mcap', rate=50.0)
    with rosbag.Bag(str(tmp_path / 'run.bag')) as bag:
        expected = [(topic, stamp.to_nsec(), raw[1]) for topic, raw, stamp in bag.read_messages(raw=True)]
    assert sorted(read_mcap((tmp_path / 'run.mcap').read_bytes())) == sorted(expected)
    goal = [data for topic, _, data in expected if topic == '/a/move_base/goal'][0]
    assert MoveBaseActionGoal().deserialize(goal).goal.target_pose.header.frame_id == 'map'


def test_equal_logs_give_equal_bytes(log, tmp_path):
    for write, ending in ((write_mcap, 'mcap'), (write_bag, 'bag')):
        paths = [tmp_path / '{}.{}'.format(name, ending) for name in ('one', 'two')]
        for path in paths:
            write(log, path)
        assert paths[0].read_bytes() == paths[1].read_bytes()


def test_many_chunks_are_indexed_too(tmp_path):
    with open(tmp_path / 'm.mcap', 'wb') as stream:
        writer = McapWriter(stream, 'test')
        for k in range(50):
            writer.write('/t{}'.format(k % 3), MoveBaseActionResult, bytes(100_000), 7 * k)
        writer.finish()
    data = (tmp_path / 'm.mcap').read_bytes()
    assert [time_ns for _, time_ns, _ in read_mcap(data)] == [7 * k for k in range(50)]
    assert sum(code == 6 for code, _, _ in records(data, 8, len(data) - 8)) > 3


def test_bytes_that_are_no_text_do_not_end_an_export(log, tmp_path):
    log.write_bytes(log.read_bytes().replace(b'"b"', b'"\xff"').replace(b'a-1', b'\xfe'))
    write_bag(log, tmp_path / 'run.bag')
    write_mcap(log, tmp_path / 'run.mcap')
    assert {'/?/robot_pose', '/event_log'} <= {topic for topic, _, _ in read_mcap((tmp_path / 'run.mcap').read_bytes())}
    assert '?' in [message.goal_id.id for topic, _, message in read_bag(tmp_path / 'run.bag') if '/goal' in topic]


def test_nothing_that_is_there_is_replaced(log, tmp_path):
    for write in (write_mcap, write_bag):
        (tmp_path / 'mine').write_text('mine')
        with pytest.raises(ConfigurationError, match='mine: is there already'):
            write(log, tmp_path / 'mine')
        (tmp_path / 'other.part').write_text('mine')
        with pytest.raises(ConfigurationError, match='other.part: is there already'):
            write(log, tmp_path / 'other')
        assert (tmp_path / 'mine').read_text() == (tmp_path / 'other.part').read_text() == 'mine'
    assert sorted(path.name for path in tmp_path.iterdir()) == ['mine', 'other.part', 'run.jsonl']


def test_the_command_writes_what_is_asked_for(log, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    command.main([str(log), '--mcap', 'r.mcap', '--bag', 'r.bag', '--rate', '1', '--frame', 'world'])
    assert capsys.readouterr().out.split() == ['r.mcap', 'r.bag']
    assert not (tmp_path / 'replay.html').exists()
    command.main([str(log)])
    assert (tmp_path / 'replay.html').exists()
    code = 'import sys; sys.path.insert(0, sys.argv.pop(1)); from move_base_abstract_replay.command import main; main()'
    done = subprocess.run([sys.executable, '-c', code, str(ROOT / 'src'), 'none.jsonl'],
                          stderr=subprocess.PIPE, universal_newlines=True, check=False)
    assert (done.returncode, done.stderr) == (2, 'replay: none.jsonl: cannot be read: No such file or directory\n')


@pytest.mark.parametrize('words', [['--rate', '0'], ['--rate', 'nan'], ['--rate', '1e9'], ['b', '--bag', 'x']])
def test_wrong_arguments_are_refused(words, capsys):
    with pytest.raises(SystemExit) as ended:
        command.main(['a', *words])
    assert ended.value.code == 2 and 'replay: error: ' in capsys.readouterr().err


@pytest.mark.parametrize('far', ['2e9', '-1e9001', '1e308', '999999999.99'])
@pytest.mark.parametrize('kind, values', [('stands', '[{},0.0,0.0]'), ('departed', '[{},1.0,0.0]'),
                                          ('pieces', '[[0,1.0,{},0.0,1.0,0.0,0.0,0.0,0.0,0.0]]'),
                                          ('motion', '[0.0,{},0.0,1.0,0.0,0.0,0.0,0.0]')])
def test_a_row_with_a_place_that_is_too_far_away_is_no_row_about_a_place(tmp_path, far, kind, values):
    rows = [('stands', '[0.0,0.0,0.0]'), (kind, values.format(far)), ('departed', '[5.0,1.0,0.0]'),
            (kind, values.format(far)), ('stands', '[5.0,1.0,0.0]')]
    (tmp_path / 'run.jsonl').write_text('{"event_log":1}\n' + ''.join(
        '{{"time_ns":{},"robot":"a","kind":"{}","values":{}}}\n'.format(number * S, *row)
        for number, row in enumerate(rows)))
    log, bag, mcap = (str(tmp_path / name) for name in ('run.jsonl', 'run.bag', 'run.mcap'))
    command.main([log, '--bag', bag, '--mcap', mcap])
    with rosbag.Bag(bag) as stream:
        *_, (_, last, _) = stream.read_messages('/a/robot_pose')
    assert (last.pose.position.x, last.pose.position.y) == (5.0, 1.0)
