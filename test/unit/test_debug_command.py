"""The command that leads into the debugger before a fault, and the file beside a log without which there is none."""
import pytest

from move_base_abstract.runs import debug_command, run_file
from move_base_abstract.runs.event_log_file import write_event_log
from move_base_abstract.runs.trace import TraceEntry

DEBUG = 'rosrun move_base_abstract debug '


@pytest.fixture
def log(tmp_path):
    """Return the path of a log with rows at 2, 3 and 3 s, and what started its run beside it."""
    path = str(tmp_path / 'a b.jsonl')
    write_event_log(path, [TraceEntry(time_ns * 10 ** 9, 'robot', 'step', [number])
                           for number, time_ns in enumerate((2, 3, 3))], 10 ** 9)
    run_file.write(path, run_file.of_run(['system.launch'], '/here', {}, ()))
    return path


@pytest.mark.parametrize('faults, where', [
    ([41300000000], ' --at 41.2'), ([41300000001], ' --at 41.200000001'), ([9, None, 8 * 10 ** 9], ''),
    ([None, 8 * 10 ** 9, 9 * 10 ** 9], ' --at 7.9'), ([], ''), ([None], ''), ([11 * 10 ** 8], ''),
    ([11 * 10 ** 8 + 1], ' --at 1.000000001')])
def test_it_leads_to_a_tenth_of_a_second_before_the_first_fault_or_to_the_start(faults, where):
    words = ['--seed', '3', 'system.launch', 'name:=a b']
    assert debug_command.of_run(words, faults) == DEBUG + "--seed 3 system.launch 'name:=a b'" + where


def test_a_log_names_itself(log):
    assert debug_command.of_log(log, [3 * 10 ** 9]) == f"{DEBUG}--log '{log}' --at 2.9"


@pytest.mark.parametrize('instant_s, where', [(2, ''), (2.5, ' --row 1'), (3, ' --row 1'), (4, ' --row 3')])
def test_it_leads_to_the_row_before_an_instant(log, instant_s, where):
    assert debug_command.of_instant(log, int(instant_s * 10 ** 9)) == f"{DEBUG}--log '{log}'{where}"


def test_nothing_is_said_if_nobody_knows_what_started_the_run(log, tmp_path):
    (tmp_path / 'a b.jsonl.run').unlink()
    assert debug_command.of_log(log, [3 * 10 ** 9]) == debug_command.of_instant(log, 3 * 10 ** 9) == ''
