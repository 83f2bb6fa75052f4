"""The event log of a run that goes on: read as it grows, told, judged, and held to another one."""
import json

import pytest

from move_base_abstract_ros.debugging.log_so_far import LogSoFar

HEAD = '{"event_log":1,"start_ns":1000000000}\n'
CSV_HEAD = '# {"event_log":1,"start_ns":1000000000}\ntime_ns,robot,kind,values\n'


def line(second, robot, kind, *values):
    return json.dumps({'time_ns': second * 10 ** 9, 'robot': robot, 'kind': kind, 'values': values}) + '\n'


def log_of(path, *lines):
    log = LogSoFar(str(path))
    (path.parent / (path.name + '.part')).write_text(HEAD + ''.join(lines))
    log.read()
    return log


DRIVE = [line(2, 'bot', 'goal', 'a'), line(2, 'bot', 'departed', 1.0, 2.0, 0.5),
         line(5, 'bot', 'stands', 1.0, 2.0, 0.5), line(5, 'bot', 'ended', 'a', 'SUCCEEDED', '')]


def test_a_log_is_read_as_it_grows_line_by_whole_line(tmp_path):
    log, part = LogSoFar(str(tmp_path / 'a.jsonl')), tmp_path / 'a.jsonl.part'
    log.read()  # nothing is there yet
    assert not log.lines and not log.story().robots
    with open(part, 'w') as stream:
        for text, count in ((HEAD[:9], 0), (HEAD[9:], 0), (DRIVE[0] + DRIVE[1][:5], 1), (DRIVE[1][5:], 2)):
            stream.write(text)
            stream.flush()
            log.read()
            assert len(log.lines) == count
        part.rename(tmp_path / 'a.jsonl')  # as at the end of a run
        stream.write('{"end":{"events":2}}\n')
    log.read()
    assert len(log.lines) == 2 and log.end and [row.kind for row in log.entries(0, 2)] == ['goal', 'departed']


def test_a_story_goes_on_where_it_was(tmp_path):
    log = log_of(tmp_path / 'a.jsonl', *DRIVE[:2])
    robot = log.story().robots['bot']
    assert robot.begun('goal') == 2 * 10 ** 9 and log.targets == {'bot': (1.0, 2.0, 0.5)}
    with open(log.path + '.part', 'a') as stream:
        stream.write(''.join(DRIVE[2:]))
    log.read()
    assert log.story().robots['bot'] is robot and (robot.goals, robot.begun('goal'), robot.at) == (1, None, (1.0, 2.0))


def test_a_csv_log_is_the_same(tmp_path):
    log = LogSoFar(str(tmp_path / 'a.csv'))
    (tmp_path / 'a.csv.part').write_text(CSV_HEAD + '2000000000,bot,goal,"[""a""]"\n# {"end":{"events":1}}\n')
    log.read()
    assert len(log.lines) == 1 and log.end and log.story().robots['bot'].begun('goal') == 2 * 10 ** 9


def test_the_first_row_that_breaks_something_is_found_among_all(tmp_path):
    rows = [line(1, 'r0', 'places', 'door', 1), line(2, 'r0', 'entered', 'door'),
            *(line(3, 'r9', 'stands', number, 0.0, 0.0) for number in range(40)), line(4, 'r1', 'entered', 'door'),
            *(line(5, 'r9', 'stands', number, 0.0, 0.0) for number in range(40)), line(6, '/n', 'uncaught', 'E', 'f')]
    log = log_of(tmp_path / 'a.jsonl', *rows)
    count, broken = log.first_break(0, [])
    assert (count, broken.property, broken.node) == (43, 'capacities_kept', 'r1')
    known = log.broken(43)
    count, broken = log.first_break(43, known)
    assert (count, broken.property, broken.node) == (len(rows), 'no_exception', '/n')
    assert log.first_break(len(rows), log.broken(len(rows))) is None
    assert log.first_break(0, [], ['charged']) is None


def test_the_end_of_a_run_may_break_what_no_row_breaks(tmp_path):
    end = json.dumps({'end': {'events': 1, 'not_repeatable_because': [], 'degraded_because': [], 'ended_by': 'deadlock',
                              'at_ns': 9, 'reason': 'that is why'}}) + '\n'
    log = log_of(tmp_path / 'a.jsonl', DRIVE[0], end)
    assert log.broken(1) == []
    count, broken = log.first_break(0, [])
    assert (count, broken.property) == (2, 'no_standstill')


@pytest.mark.parametrize('other, number', [
    (DRIVE, None), (DRIVE[:2], None), ([*DRIVE, line(9, 'bot', 'goal', 'b')], None),
    ([*DRIVE[:2], DRIVE[3], DRIVE[2]], 3), ([line(2, 'bot', 'goal', 'b')], 1)])
def test_logs_are_held_to_each_other_as_far_as_both_go(tmp_path, other, number):
    log = log_of(tmp_path / 'a.jsonl', *DRIVE)
    assert log.difference_from([one.encode() for one in other]) == number


def test_the_rows_before_an_instant_are_counted(tmp_path):
    log = log_of(tmp_path / 'a.jsonl', *DRIVE)
    assert [log.before(second * 10 ** 9) for second in (1, 2, 3, 5, 6)] == [0, 0, 2, 2, 4]
