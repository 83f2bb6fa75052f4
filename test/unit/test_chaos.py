"""The search for what chaos breaks, without runs: fewest decisions, what counts as a failure, the file that replays."""
import argparse
import json

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.options import words_of
from move_base_abstract.lockstep import replay_file
from move_base_abstract_experiments.chaos import command, counting, failures, runs
from move_base_abstract_experiments.chaos.counting import Count
from move_base_abstract_experiments.chaos.variation import Bounds, Variation
from move_base_abstract_experiments.records import COMPLETE, Result

NAMES = [f'{number:012x}' for number in range(40)]


@pytest.mark.parametrize('needed', [[], [7], [0, 39], [3, 4, 31], NAMES[:0]])
def test_shrinking_leaves_what_is_needed_and_nothing_else(needed):
    tried = []

    def first_failing(candidates):
        tried.extend(candidates)
        wanted = {NAMES[number] for number in needed}
        return next(((k, one) for k, one in enumerate(candidates) if wanted <= set(one)), None)
    assert runs.ddmin(NAMES, first_failing) == [NAMES[number] for number in needed]
    assert len(tried) < 200


def test_what_was_not_there_in_a_run_that_failed_is_left_out_at_once():
    def first_failing(candidates):
        return next(((k, [NAMES[5]]) for k, one in enumerate(candidates) if NAMES[5] in one), None)
    assert runs.ddmin(NAMES, first_failing) == [NAMES[5]]


OPEN = [{'client': '/a', 'action': '/robot_1/move_base', 'count': 2}]


def log(*events, **end):
    lines = [{'event_log': 1, 'start_ns': 0}, *events,
             {'end': {'events': len(events), 'repeatable': True, 'not_repeatable_because': [], 'degraded_because': [],
                      'reason': '', **end}}]
    return ''.join(json.dumps(line) + '\n' for line in lines).encode()


def found(result, *events, wanted=(), **end):
    failure = failures.of_run(failures.evidence_of(result, log(*events, **end)), wanted)
    return failure and tuple(failure[:2])


def at(result, *events, **end):
    return failures.of_run(failures.evidence_of(result, log(*events, **end))).instant_ns


def complete(**others):
    return Result('0000-a', status=COMPLETE, **others)


def test_what_fails_a_run():
    told = {'time_ns': 1500000000, 'robot': '/monitor', 'kind': 'property',
            'values': ['always', 'one owner', 'broken', 'task=3']}
    stated = dict(told, values=['always', 'one owner', 'stated'])
    assert found(complete()) is None
    assert found(complete(), stated) is None
    assert found(complete(), stated, told) == ('one owner', 'always: one owner, said by /monitor at 1.5 s: task=3')
    crash = '/a crashed at 2.000000000 s: exit code 3'
    assert found(complete(crashes=[crash])) == ('crash /a', crash)
    for name in ('deadlock', 'zero_delay_loop'):
        assert found(Result('0000-a', error='x'), ended_by=name, reason='who') == (name, 'who')
    assert found(Result('0000-a', error='x'), ended_by='other', reason='deadlock at 3 s: who')[0] == 'unfinished'
    empty = {'time_ns': 1500000000, 'robot': 'robot_1', 'kind': 'battery', 'values': [0.0, 'empty']}
    assert found(complete(), empty) == ('charged', 'charged: at 1.500000000 s, robot_1: its battery is empty (idle)')
    assert found(complete(), ended_by='idle', open_goals=OPEN)[0] == 'every_goal_ends'
    assert found(complete(), ended_by='end_at', open_goals=OPEN) is None
    assert found(Result('0000-a', error='it was not over')) == ('unfinished', 'it was not over')
    assert failures.of_run(failures.evidence_of(Result('0000-a', error='no log'), None)).name == 'unfinished'


def test_each_failure_has_its_instant_if_it_is_known():
    told = {'time_ns': 1500000000, 'robot': '/monitor', 'kind': 'property', 'values': ['always', 'one owner', 'broken']}
    empty = {'time_ns': 1700000000, 'robot': 'robot_1', 'kind': 'battery', 'values': [0.0, 'empty']}
    assert (at(complete(), told), at(complete(), empty)) == (1500000000, 1700000000)
    one, other = ({'node': name, 'crashed': True, 'at': at} for name, at in (('/b', 1.0), ('/a', 41.300000001)))
    crash = '/a crashed at 41.300000001 s: exit code 3'
    assert at(complete(crashes=[crash], ends=[one, other])) == 41300000001
    assert at(complete(crashes=[crash], ends=[{**other, 'at': None}])) is None
    assert at(Result('0000-a', error='x'), ended_by='deadlock', at_ns=7) == 7
    assert at(Result('0000-a', error='x'), at_ns=8) == 8


def test_only_what_is_wanted_counts():
    crashed, both = complete(crashes=['/a crashed: exit code 3']), {'ended_by': 'idle', 'open_goals': OPEN}
    assert found(crashed, wanted=['every_goal_ends'], **both)[0] == 'every_goal_ends'
    assert found(crashed, wanted=['crash'], **both)[0] == found(crashed, wanted=['crash /a'], **both)[0] == 'crash /a'
    assert found(crashed, wanted=['cra', 'deadlock'], **both) is None


def test_robots_that_wait_for_each_other_are_a_standstill():
    waits = {'time_ns': 1500000000, 'robot': 'a', 'kind': 'deadlock', 'values': ['a', 'zone x', 'b', 'zone y']}
    for wanted in ([], ['no_standstill']):
        assert found(complete(), waits, wanted=wanted, ended_by='idle')[0] == 'no_standstill'
    assert found(complete(), ended_by='deadlock', reason='who') == ('deadlock', 'who')
    assert found(complete(), wanted=['no_standstill'], ended_by='deadlock', reason='who')[0] == 'no_standstill'


def test_what_is_asked_for_is_known_or_said_to_be_a_text(capsys):
    assert command._wanted(['no_crash', 'crash /a', 'deadlock', 'no_standstill']) == (
        ['no_crash', 'no_standstill'], ['crash', 'crash /a', 'deadlock', 'no_standstill'])
    assert command._wanted(['all', 'charged']) == (['charged'], [])
    assert not capsys.readouterr().out
    assert command._wanted(['every_goal_end', 'one owner']) == ([], ['every_goal_end', 'one owner'])
    assert capsys.readouterr().out == (
        "chaos: 'every_goal_end' is taken for the text of a statement of your own; did you mean 'every_goal_ends'?\n"
        "chaos: 'one owner' is taken for the text of a statement of your own\n")


@pytest.mark.parametrize(('text', 'says'), [
    ('x', "got 'x'; allowed: a whole number in 1..2147483647"), ('3:1', 'the smaller one first'),
    ('0:4', 'got 0; allowed'), ('1:', "got ''")])
def test_seeds_that_are_none_are_refused(text, says):
    with pytest.raises(argparse.ArgumentTypeError, match=says):
        command._seeds(text)
    assert (command._seeds('3'), command._seeds('2:4')) == ((3, 3), (2, 4))


class Told:
    """Runs with the results of a test; ``count``: how many were asked for."""

    def __init__(self, fail):
        self.fail = fail  # {seed: the name of its failure}
        self.count = 0

    def each(self, asked):
        for one in asked:
            self.count += 1
            judged = failures.evidence_of(complete(), log({'time_ns': 1, 'robot': '/a', 'kind': 'property', 'values': [
                'sometimes', 'it waits', 'held' if one.seed == 2 else 'stated']})).judged
            name = self.fail.get(one.seed)
            yield runs.RunResult(one, name and failures.Failure(name, 'why'), [], '', judged=None if one.seed == 1
                                 else judged)


def test_a_search_ends_with_the_first_seed_that_fails_and_a_count_with_the_last(capsys):
    told, count = Told({2: 'crash /a', 4: 'crash /a', 5: 'deadlock'}), Count((1, 5), None, None, [])
    assert command._tried(told, count, False).chosen.seed == 2
    assert (told.count, count.failed) == (3, {2: 'crash /a'})
    said = capsys.readouterr().out
    assert 'sometimes: /a: it waits: came true in 1 of the 2 runs that say it' in said
    told, count = Told(told.fail), Count((1, 5), None, None, [])
    assert command._tried(told, count, True).chosen.seed == 2
    assert (told.count, count.failed) == (6, {2: 'crash /a', 4: 'crash /a', 5: 'deadlock'})
    assert count.said() == '3 of 5 seeds fail: crash /a (2, 4), deadlock (5)'
    assert command._tried(Told({}), Count((1, 5), None, None, []), True) is None
    assert command._tried(Told({0: 'deadlock'}), Count((1, 5), None, None, []), False).chosen.seed == 0


def test_a_text_that_no_run_has_stated_was_not_looked_for():
    def tried(*wanted):
        return command._tried(Told({}), Count((1, 5), None, None, [*wanted]), False)
    assert tried('crash /a', 'deadlock', 'it waits', 'it') is None
    with pytest.raises(ConfigurationError, match="'it wait': no failure has this name, and no node stated this text in "
                       "the 6 runs; stated were: 'it waits'"):
        tried('deadlock', 'it wait')


def test_a_count_is_compared_with_that_before_a_repair():
    before = Count((1, 100), 0.05, None, [], dict.fromkeys(range(1, 13), 'crash /a'))
    now = Count((1, 100), 0.05, None, [], {7: 'crash /a', 99: 'deadlock'})
    assert now.compared(before) == [
        'before: 12 of 100 seeds fail: crash /a (1, 2, 3, 4, 5, 6, 7, 8, 9, 10 and 2 more)',
        'now:    2 of 100 seeds fail: crash /a (7), deadlock (99)', 'these fail now, and did not before: 99']
    assert Count((3, 3), None, None, []).compared(now)[1:] == ['now:    0 of 1 seed fail']
    assert Count((3, 4), None, None, [], {4: 'deadlock'}).said() == '1 of 2 seeds fails: deadlock (4)'


def test_a_count_is_read_as_it_was_written(tmp_path):
    path = str(tmp_path / 'chaos.json')
    for count in (Count((1, 9), None, 0.3, ['deadlock'], {4: 'deadlock'}), Count((2, 2), 0.0, None, [])):
        replay_file.write(path, made(count=vars(count)))
        assert counting.of_file(path, replay_file.read(path).count) == count
    for told, says in (({}, 'has no count of seeds'), ({'seeds': [1]}, 'count must be as'),
                       ({**vars(count), 'failed': [3]}, 'count must be as'),
                       ({**vars(count), 'delay': 'x'}, 'count must be as')):
        with pytest.raises(ConfigurationError, match=says):
            counting.of_file(path, told)


def test_what_a_seed_varies_does_not_depend_on_the_range():
    assert [Variation().of(seed) for seed in range(4)] == [(0, 0), (0, 0), (0.05, 0.5), (0, 0)]
    assert [Variation(has_network=True).of(seed) for seed in (1, 2)] == [(0, 0), (0, 0.5)]
    assert [Variation(0.0).of(seed) for seed in range(4)] == [Bounds()] * 4
    assert [Variation(0.2).of(seed) for seed in range(3)] == [Bounds(), Bounds(0.2), Bounds(0.2)]
    assert [Variation(starts=0.2).of(seed) for seed in range(3)] == [Bounds(), Bounds(0, 0.2), Bounds(0, 0.2)]
    assert Variation(0.2, 0.3).of(1) == Variation(0.2, 0.3).of(2) == (0.2, 0.3)


@pytest.mark.parametrize(('given', 'seeds', 'says'), [
    ({}, (1, 100), '; those with an even number also delays up to 0.05 s and starts up to 0.5 s late'),
    ({}, (4, 5), '; those with an even number also delays up to 0.05 s and starts up to 0.5 s late'),
    ({}, (3, 3), ''), ({}, (4, 4), ', delays up to 0.05 s and starts up to 0.5 s late'), ({'delay': 0.0}, (1, 9), ''),
    ({'delay': 0.2}, (1, 9), ', delays up to 0.2 s'), ({'starts': 1.0}, (2, 2), ', starts up to 1 s late'),
    ({'has_network': True}, (1, 9), '; those with an even number also starts up to 0.5 s late')])
def test_what_was_varied_is_said(given, seeds, says):
    assert Variation(**given).said(seeds) == 'the order of equal events' + says


def made(**others):
    return replay_file.Replay(**{**dict(launch=['/x.launch', 'robots:=3'], seed=7, delay=0.05, only=[NAMES[1]],
                                        failure='crash /a', text='it crashed', happened=['a before b'], sha256='0'),
                                 **others})


def test_a_replay_is_read_as_it_was_written(tmp_path):
    path = str(tmp_path / 'chaos.json')
    for one in (made(), made(launch=[], only=[], test=['/a', '/a/b.py::c[chaos_7]']),
                made(starts=0.5, delay=0.0),
                made(only=[], document={'until': 30.0, 'leave_out': ['/b'], 'sleep': 'simulated', 'seed': 4})):
        replay_file.write(path, one)  # in the place of the one before
        assert replay_file.read(path) == one
    assert words_of(made().run) == ['--chaos-seed', '7', '--chaos-delay', '0.05', '--chaos-only', NAMES[1],
                                    '--crashes', 'allow']
    nodes = {'participant': ['/a'], 'onlooker': ['/b'], 'leave_out': ['/c'], 'replace': {'p/a': 'p/b'}, 'seed': 3}
    assert words_of(made(document=nodes, seed=0).run) == [
        '--participant', '/a', '--onlooker', '/b', '--leave-out', '/c', '--replace', 'p/a=p/b', '--seed', '3',
        '--crashes', 'allow']
    assert made(only=[]).run.chaos_only == ('none',)
    assert words_of(made(starts=0.5).run)[4:6] == ['--chaos-starts', '0.5']


def test_a_failure_is_debugged_with_the_seed_and_the_decisions_that_it_needs():
    begin, end = 'rosrun move_base_abstract debug ', '/x.launch robots:=3'
    assert made(starts=0.5).debug_command(41300000000) == (
        f'{begin}--end-when-idle --chaos-seed 7 --chaos-delay 0.05 --chaos-starts 0.5 --chaos-only {NAMES[1]} {end} '
        '--at 41.2')
    assert made(only=[]).debug_command(None) == (
        f'{begin}--end-when-idle --chaos-seed 7 --chaos-delay 0.05 --chaos-only none {end}')
    assert made(seed=0, document={'until': 30.0}).debug_command(41300000000) == (
        f'{begin}--end-when-idle --until 30 {end} --at 41.2')


@pytest.mark.parametrize(('number', 'until'), [(1, 31.0), (2, 30.0)])
def test_a_replay_of_an_earlier_release_ends_where_it_ended_and_starts_all_together(tmp_path, number, until):
    path = tmp_path / 'chaos.json'
    of_then = {key: value for key, value in vars(made(document={'until': 30.0})).items() if key not in (
        'test', 'starts', 'count', 'debug')}
    path.write_text(json.dumps({'chaos': number, **of_then}))
    read = replay_file.read(str(path))
    assert (read.run.until, read.run.chaos_starts, read.count, read.test) == (until, 0.0, {}, [])


@pytest.mark.parametrize(('change', 'says'), [
    ({'chaos': 4}, 'format 3'), ({'seed': '7'}, 'seed must be'), ({'only': ['x']}, 'names of decisions'),
    ({'launch': []}, 'launch must name'), ({'happened': [1]}, 'list of texts'),
    ({'test': ['/a']}, 'test must be a folder and'),
    ({'test': 'a'}, 'test must be as `chaos` writes it'),
    ({'test': [1, 2]}, 'test must be a list of texts'),
    ({'starts': '1'}, 'starts must be'), ({'debug': 1}, 'debug must be'), ({'count': []}, 'count must be'),
    ({'document': {'param': 3}}, 'param: got 3')])
def test_a_file_that_is_none_is_refused(tmp_path, change, says):
    path = tmp_path / 'chaos.json'
    path.write_text(json.dumps({'chaos': 1, **vars(made()), **change}))
    with pytest.raises(ConfigurationError, match=says):
        replay_file.read(str(path))


def test_a_file_of_others_stays(tmp_path):
    path = tmp_path / 'chaos.json'
    path.write_text('mine\n')
    with pytest.raises(ConfigurationError, match='it stays'):
        replay_file.write(str(path), made())
    assert path.read_text() == 'mine\n'
