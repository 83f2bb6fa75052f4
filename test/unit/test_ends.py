"""The rule that says which end of a process is a crash."""
import json

import pytest

from move_base_abstract.runs import ends
from move_base_abstract.runs.ends import Process

SHUT_DOWN = ('Traceback (most recent call last):', 'rospy.exceptions.ROSInterruptException: rospy shutdown')


def log_of(tmp_path, departures=(), uncaught=(), of_jobs=()):
    """Return the Log of a run in which nodes departed, [(name, died)], and nobody caught errors, [(name, text)].

    of_jobs: further events, [(time_ns, kind, values)] of the node /a.
    """
    path = tmp_path / 'events.jsonl'
    lines = [{'event_log': 1, 'start_ns': 1}]
    lines += [{'time_ns': 7, 'robot': name, 'kind': 'uncaught', 'values': [text, 'a place']} for name, text in uncaught]
    lines += [{'time_ns': at, 'robot': '/a', 'kind': kind, 'values': values} for at, kind, values in of_jobs]
    gone = [{'node': name, 'time_ns': 5 * 10 ** 9, 'died': died} for name, died in departures]
    lines.append({'end': {'events': len(uncaught) + len(of_jobs), 'not_repeatable_because': [], 'degraded_because': [],
                          'departures': gone}})
    path.write_text(''.join(json.dumps(line) + '\n' for line in lines))
    return ends.read_log(str(path))


def crash_of(log, *processes):
    """Return the crashes of a run in words."""
    return ends.crashes(ends.judge(processes, log))


@pytest.mark.parametrize('code, died, told, how', [
    (0, False, False, None), (0, True, False, None), (1, False, False, 'exit code 1'), (3, True, False, 'exit code 3'),
    (-11, True, False, 'ended by SIGSEGV'), (-9, True, False, 'ended by SIGKILL'),
    (-15, False, False, 'ended by SIGTERM'),
    (-9, True, True, 'ended by SIGKILL'),  # the connection was lost before a signal of ours came
    (-9, False, True, None), (130, False, True, None), (1, False, True, 'exit code 1'),
    (139, True, False, 'exit code 139 (in a shell, this means SIGSEGV)'), (127, False, False, 'exit code 127')])
def test_of_a_participant_that_went_before_the_end_its_exit_code_counts(tmp_path, code, died, told, how):
    log = log_of(tmp_path, [('/a', died)])
    assert crash_of(log, Process('/a', True, code, was_told=told)) == (
        [] if how is None else ['/a crashed at 5.000000000 s: ' + how])


@pytest.mark.parametrize('code', (1, -11, -9, 134))
def test_how_a_participant_ends_once_the_run_is_over_is_no_crash(tmp_path, code):
    end, = ends.judge([Process('/a', True, code, was_early=True, printed=('last',))], log_of(tmp_path))
    assert end.crash is None
    told = end.told
    is_ours = code == -9
    assert (told['exit_code'], told['signal'], told['last_lines']) == (
        (None, None, []) if is_ours else (None, 'SIGSEGV', ['last']) if code == -11 else (code, None, ['last']))


def test_of_who_looks_on_it_counts_when_it_was_seen_to_end(tmp_path):
    log = log_of(tmp_path)
    assert crash_of(log, Process('/a', False, 2, was_early=True)) == ['/a crashed: exit code 2']
    assert crash_of(log, Process('/a', False, 2, was_told=True)) == []
    assert crash_of(log, Process('/a', False, 0, was_early=True)) == []
    assert crash_of(log, Process('/a', False, -6, was_early=True, only_displays=True)) == []


def test_what_nobody_caught_is_a_crash_though_the_node_went_on(tmp_path):
    log = log_of(tmp_path, uncaught=[('/a', 'KeyError'), ('/a', 'TypeError')])
    assert crash_of(log, Process('/a', True, 0), Process('/b', True, 0)) == [
        '/a crashed at 0.000000007 s: KeyError in a place (and 1 more)']
    log = log_of(tmp_path, [('/a', False)], [('/a', 'KeyError')])  # it went on for 5 s
    assert crash_of(log, Process('/a', True, 0)) == ['/a crashed at 0.000000007 s: KeyError in a place']
    assert crash_of(log, Process('/a', True, 3)) == [
        '/a crashed at 0.000000007 s: KeyError in a place; exit code 3 at 5.000000000 s']
    line = '\x1b[31m[ERROR] [1700000000.5, 3.2]: bad callback: <function f at 0x7fb0>\x1b[0m'
    shown = Process('/c', False, 0, shown=(line,))
    assert crash_of(log_of(tmp_path), shown) == ['/c crashed: [ERROR] bad callback: <function f>']
    assert crash_of(log_of(tmp_path), shown._replace(takes_part=True)) == []  # of those the log says it


def test_a_job_for_which_somebody_asks_in_time_is_no_crash(tmp_path):
    jobs = [(8, 'unasked', [1, 'KeyError', 'a job']), (9, 'unasked', [2, 'TypeError', 'a task']), (9, 'asked', [1])]
    assert crash_of(log_of(tmp_path, of_jobs=jobs), Process('/a', True, 0)) == [
        '/a crashed at 0.000000009 s: TypeError in a task']
    assert crash_of(log_of(tmp_path, of_jobs=[*jobs, (10, 'asked', [2])]), Process('/a', True, 0)) == []
    assert crash_of(log_of(tmp_path, uncaught=[('/a', 'KeyError')], of_jobs=jobs), Process('/a', True, 0)) == [
        '/a crashed at 0.000000007 s: KeyError in a place (and 1 more)']


def test_an_error_of_shutting_down_is_none_of_the_program(tmp_path):
    log = log_of(tmp_path, [('/a', False)])
    assert crash_of(log, Process('/a', True, 1, printed=SHUT_DOWN)) == []
    assert crash_of(log, Process('/a', True, 130, printed=SHUT_DOWN)) == []
    assert crash_of(log, Process('/a', True, 3, printed=SHUT_DOWN)) != []


@pytest.mark.parametrize('code', (1, 130))
def test_an_error_in_handling_that_the_node_is_shut_down_is_one_of_the_program(tmp_path, code):
    printed = (*SHUT_DOWN, 'During handling of the above exception, another exception occurred:',
               'Traceback (most recent call last):', '  File "node.py", line 7, in save', "KeyError: 'robot_7'")
    assert crash_of(log_of(tmp_path, [('/a', False)]), Process('/a', True, code, printed=printed)) != []
    assert crash_of(log_of(tmp_path, [('/a', False)]), Process('/a', True, code, printed=(*printed, *SHUT_DOWN))) == []


def test_of_a_shell_that_ends_well_the_death_of_what_it_has_started_counts(tmp_path):
    died, left = log_of(tmp_path, [('/a', True)]), log_of(tmp_path, [('/a', False)])
    assert crash_of(died, Process('/a', True, 0, is_shell=True)) == [
        '/a crashed at 5.000000000 s: its connection was lost']
    assert crash_of(died, Process('/a', True, 137, is_shell=True)) == [
        '/a crashed at 5.000000000 s: exit code 137 (in a shell, this means SIGKILL)']
    assert crash_of(left, Process('/a', True, 0, is_shell=True)) == []


def test_a_command_stands_for_the_one_node_that_it_is(tmp_path):
    log = log_of(tmp_path, [('/a', True)], [('/a', 'KeyError')])
    assert crash_of(log, Process('the command x', True, 3, names=('/a',))) == [
        'the command x crashed at 0.000000007 s: KeyError in a place; exit code 3 at 5.000000000 s']
    assert crash_of(log, Process('the command x', True, 0, names=('/a', '/b'))) == [
        '/a crashed at 0.000000007 s: KeyError in a place; its connection was lost at 5.000000000 s']


def test_the_time_masters_word_on_the_run_is_no_crash(tmp_path):
    log = log_of(tmp_path, [('/a', True)])
    master = Process(ends.TIME_MASTER, False, 1, was_early=True)
    assert crash_of(log, master, Process('/a', True, -11)) == ['/a crashed at 5.000000000 s: ended by SIGSEGV']
    assert crash_of(log_of(tmp_path), master._replace(code=-6)) == ['/time_master crashed: ended by SIGABRT']
    assert crash_of(ends.read_log(''), master) == ['/time_master crashed: exit code 1']


def test_without_a_whole_log_it_counts_what_was_seen(tmp_path):
    log = ends.read_log(str(tmp_path / 'none.jsonl'))
    assert crash_of(log, Process('/a', True, 1, was_early=True), Process('/b', True, 1)) == ['/a crashed: exit code 1']


def test_lines_that_show_what_nobody_caught_are_known():
    for line in ('[ERROR] [1700000000.1, 2.0]: bad callback: <function f>', 'Exception in thread Thread-5:',
                 '\x1b[31m[ERROR] [1700000000.1]: Exception in your execute callback: x\x1b[0m',
                 '[ERROR] [1.5]: Exception thrown while processing service call: std::bad_alloc',
                 '[ERROR] [1.5]: Error processing request: 3'):
        assert ends.shows_uncaught(line)
    for line in ('Traceback (most recent call last):', '[ERROR] [1.0]: no path', 'an Exception in thread 3 was caught'):
        assert not ends.shows_uncaught(line)
