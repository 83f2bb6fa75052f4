"""What a run has broken: each property broken once, and kept once."""
import json
import os
import re
import subprocess
import sys

import pytest

from move_base_abstract.common import kinds
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.fleet import Fleet
from move_base_abstract.properties import Broken, Gathering, Run, judge, judgement_on
from move_base_abstract.properties.statements import MOST_STATEMENTS, StatementError, Statements
from move_base_abstract.runs import built_in, ends
from move_base_abstract.runs.built_in import BUILT_IN
from move_base_abstract.scenario import make_scenario


def log_of(tmp_path, *rows, **end):
    """Write an event log with these (robot, kind, values), a second apart; return its path."""
    lines = [{'event_log': 1, 'start_ns': 0}]
    lines += [{'time_ns': number * 10 ** 9, 'robot': robot, 'kind': kind, 'values': list(values)}
              for number, (robot, kind, *values) in enumerate(rows, 1)]
    lines.append({'end': {'events': len(rows), 'not_repeatable_because': [], 'degraded_because': [],
                          'ended_by': 'idle', 'at_ns': 9 * 10 ** 9, 'reason': 'that is why', **end}})
    path = tmp_path / 'events.jsonl'
    path.write_text(''.join(json.dumps(line) + '\n' for line in lines))
    return str(path)


ROOM = ('r0', 'places', 'door', 1), ('r0', 'entered', 'door')
CIRCLE = ('r1', 'deadlock', 'r1', 'door', 'r0', 'lane')
DEPARTED = ('r0', 'departed', 1.0, 2.0, 0.0)
GONE = [{'node': '/a', 'time_ns': 5, 'died': True}]
BREAKS = {
    'no_crash': ([], {'departures': GONE}, 'at 0.000000005 s, /a: its connection was lost'),
    'no_exception': ([('/a', 'uncaught', 'KeyError', 'a.py, line 4')], {},
                     'at 1.000000000 s, /a: KeyError in a.py, line 4'),
    'no_standstill': ([], {'ended_by': 'deadlock'}, 'at 9.000000000 s, the run: that is why'),
    'no_zero_delay_loop': ([], {'ended_by': 'zero_delay_loop'}, 'at 9.000000000 s, the run: that is why'),
    'every_goal_ends': ([DEPARTED], {},
                        'at 1.000000000 s, r0: the goal that it took in then never ends'),
    'capacities_kept': ([*ROOM, ('r1', 'entered', 'door')], {},
                        'at 3.000000000 s, r1: it came into door, which has room for 1 (r0, r1)'),
    'charged': ([('r0', 'battery', 0.0, 'empty')], {}, 'at 1.000000000 s, r0: its battery is empty (idle)')}
KEPT = [
    ([], {'departures': [dict(GONE[0], died=False)]}),
    ([('/a', 'unasked', 1, 'KeyError', 'a.py'), ('/a', 'asked', 1)], {}),
    ([CIRCLE, ('r0', 'left', 'door')], {}), ([CIRCLE, ('r1', 'ended', 'g', 'ABORTED', '')], {}),
    ([DEPARTED, ('r0', 'ended', 'g', 'SUCCEEDED', '')], {}),
    ([DEPARTED], {'ended_by': 'end_at'}), ([DEPARTED], {'ended_by': 'departure'}),  # it would have ended later
    ([('r0', 'task_began', 'g', 5), ('r0', 'task_ended', 'g', 'SUCCEEDED', '')], {}),
    ([*ROOM, ('r0', 'left', 'door'), ('r1', 'entered', 'door')], {}),
    ([('r0', 'works_at', 'g', 'dock', 1), ('r0', 'task_ended', 'g', 'ABORTED', ''),
      ('r1', 'works_at', 'h', 'dock', 1)], {}),
    ([('r1', 'entered', 'door'), ('r2', 'entered', 'door')], {}),  # there is room for all
    ([('r0', 'charging_began', 'dock'), ('r0', 'battery', 0.0, 'empty')], {}),
    ([('r0', 'battery', 0.2, 'below')], {}),
    ([('/a', 'places', 'x'), ('/a', 'battery'), ('/a', 'property', 7)], {})]  # a user's own rows


@pytest.mark.parametrize('name', BUILT_IN)
def test_each_built_in_property_can_be_broken(tmp_path, name):
    rows, end, words, *asked = BREAKS[name]  # asked: NAME=NUMBER, if not by ALL
    found = judge(Run(log_of(tmp_path, *rows, **end), properties=asked or [built_in.ALL]))
    assert [one.words() for one in found] == [f'{name}: {words}']


@pytest.mark.parametrize('rows, end', KEPT)
def test_what_is_in_order_breaks_nothing(tmp_path, rows, end):
    assert judge(Run(log_of(tmp_path, *rows, **end))) == []


def test_robots_that_wait_for_each_other_to_the_end_of_the_run_stand(tmp_path):
    broken, = judge(Run(log_of(tmp_path, CIRCLE, ended_by='end_at')))
    assert broken == Broken('no_standstill', 10 ** 9, 'r1', 'robots wait for each other, to the end of the run',
                            ('r1 for door, r0 for lane',))


def test_a_task_that_waits_for_ever_does_not_end(tmp_path):
    broken, = judge(Run(log_of(tmp_path, ('r0', 'waiting_began', 'g', 'dock'))))
    assert (broken.property, broken.details) == ('every_goal_ends', ('g',))


def test_a_place_has_room_for_some(tmp_path):
    broken, = judge(Run(log_of(tmp_path, ('r0', 'works_at', 'g', 'dock', 1), ('r1', 'works_at', 'h', 'dock', 1))))
    assert broken.words() == (
        'capacities_kept: at 2.000000000 s, r1: it works at dock, which has room for 1 (r0, r1)')


def fleet_log(tmp_path, goals, until=None, **scenario):
    """Run robots at (0, 0), (0, 1) in plain Python, each to its goal (x, y); return the path of the event log."""
    fleet = Fleet(make_scenario({'defaults': {'max_speed': 2.0, **scenario.pop('defaults', {})}, 'robots': [
        {'name': name, 'start_x': 0.0, 'start_y': y} for name, y in (('a', 0.0), ('b', 1.0))], **scenario}), 0)
    for name, place in goals.items():
        fleet.robot(name).send(*place)
    fleet.run(until=until)
    path = str(tmp_path / 'fleet.jsonl')
    fleet.write_log(path)
    return path


def test_open_goals_of_a_fleet_in_plain_python(tmp_path):
    dead = {'defaults': {'failure_kind': 'stall', 'failure_times': [2.0], 'repair_distribution': 'never'}}
    goals = {'a': (10.0, 0.0), 'b': (1.0, 1.0)}
    path = fleet_log(tmp_path, goals, **dead)
    assert [(one.property, one.node) for one in judge(Run(path))] == [('every_goal_ends', 'fleet')]
    assert judge(Run(path))[0].text == '1 of its goals never ends on a/move_base'
    assert judge(Run(fleet_log(tmp_path, goals, until=1.5, **dead))) == []  # there is more to come
    assert judge(Run(fleet_log(tmp_path, goals))) == []


def test_what_robots_write_down_is_what_is_judged(tmp_path):
    gate = {'name': 'gate', 'rectangle': [4.0, -50.0, 6.0, 50.0], 'capacity': 1}
    goals = {'a': (10.0, 0.0), 'b': (10.0, 1.0)}
    path = fleet_log(tmp_path, goals, zones=[gate])
    assert judge(Run(path)) == []
    text = (tmp_path / 'fleet.jsonl').read_text()
    left = '"kind":"left"'
    assert '"places","values":["zone gate",1]' in text and left in text
    (tmp_path / 'fleet.jsonl').write_text(text.replace(left, '"kind":"leaves"', 1))  # as if it had not left
    assert [one.property for one in judge(Run(path))] == ['capacities_kept']
    low = {'battery_capacity': 0.001, 'ambient_power': 100.0}
    assert {one.property for one in judge(Run(fleet_log(tmp_path, goals, defaults=low)))} == {'charged'}


def test_an_exception_is_told_once_though_its_process_was_seen_too(tmp_path):
    path = log_of(tmp_path, ('/a', 'uncaught', 'KeyError', 'a.py, line 4'))
    for code in (0, 1):  # it went on, or its main thread has raised
        processes = [ends.Process('/a', True, code), ends.Process('/b', False, 3, was_early=True)]
        found = judge(Run(path, ends.judge(processes, ends.read_log(path))))
        assert [(one.property, one.node) for one in found] == [('no_exception', '/a'), ('no_crash', '/b')]
        for name, nodes in (('no_crash', ['/a', '/b']), ('no_exception', ['/a'])):
            alone = judge(Run(path, ends.judge(processes, ends.read_log(path)), [name]))
            assert [(one.property, one.node) for one in alone] == [(name, node) for node in nodes]
        allowed = judge(Run(path, ends.judge(processes, ends.read_log(path)), allowed=['no_exception']))
        assert [(one.property, one.node) for one in allowed] == [('no_crash', '/a'), ('no_crash', '/b')]


def test_nothing_was_kept_in_a_run_that_never_ran_or_has_no_end(tmp_path):
    path = tmp_path / 'log'
    head = '{"event_log":1,"start_ns":1000000000}\n'
    end = '{"end":{"events":0,"not_repeatable_because":[],"degraded_because":[],"ended_by":"%s","at_ns":%d}}\n'
    for text, judged in ((head + end % ('other', 10 ** 9), 0), (head, 0), (head + end % ('idle', 10 ** 9), 1),
                         (head + end % ('other', 2 * 10 ** 9), 1)):
        path.write_text(text)
        assert len(judgement_on(Run(str(path), properties=['charged'])).judged) == judged


def test_goals_that_a_client_waits_for_are_open_whether_a_robot_departed_or_not(tmp_path):
    waits = [{'client': '/a', 'action': '/r0/move_base', 'count': 1}]
    never = 'every_goal_ends: at 9.000000000 s, /a: 1 of its goals never ends on /r0/move_base'
    for rows in ((), (DEPARTED,)):  # a robot that is held never departs
        assert [one.words() for one in judge(Run(log_of(tmp_path, *rows, open_goals=waits)))] == [never]
    assert judge(Run(log_of(tmp_path, open_goals=waits, ended_by='end_at'))) == []


def rows_of(kind, *conditions):
    """Return what came of a statement that was made with these conditions in turn."""
    made = Statements()
    return [[row[2] for row in made.take(kind, condition, 'text', {'n': number})]
            for number, condition in enumerate(conditions)]


@pytest.mark.parametrize('kind, conditions, rows', [
    ('always', (1, 1, 0, 0, 1), [['stated'], [], ['broken'], [], []]), ('always', (0,), [['stated', 'broken']]),
    ('sometimes', (0, 0, 1, 1), [['stated'], [], ['held'], []]), ('sometimes', (1, 0), [['stated', 'held'], []]),
    ('never_again', (0, 1, 1, 0, 0), [['stated'], [], [], [], []]),
    ('never_again', (1, 0, 1, 0, 1), [['stated'], [], ['broken'], [], []])])
def test_only_what_is_news_is_written(kind, conditions, rows):
    assert rows_of(kind, *conditions) == rows


def test_statements_of_a_node_are_judged_and_what_never_held_is_told(tmp_path):
    path = log_of(tmp_path, ('/a', 'property', 'sometimes', 'low', 'stated'),
                  ('/a', 'property', 'always', 'one owner', 'stated'),
                  ('/a', 'property', 'always', 'one owner', 'broken', 'task=7'),
                  ('/b', 'property', 'sometimes', 'low', 'held'))
    judged = judgement_on(Run(path))
    assert [one.words() for one in judged.broken] == ['always: at 3.000000000 s, /a: one owner (task=7)']
    assert judged.never_held() == [('/a', 'low')]
    for names, broken in ((['charged'], ()), (['always'], judged.broken)):
        assert judgement_on(Run(path, properties=names)) == (broken, judged.statements, tuple(names))


def test_a_property_that_takes_a_number_is_asked_for_with_it(tmp_path, monkeypatch):
    def judge_it(facts, number):
        yield 5, 'r0', 'it took more than {:g} s'.format(number), ()
    for name, default in (('slow', None), ('late', 9.0)):
        monkeypatch.setitem(built_in.BUILT_IN, name, built_in.Property(
            name, 'all is quick', 'all is quick', judge_it, kinds.number(0.0, 100.0, unit='s'), default))
    for right in ('late', 'late=3', 'slow=3', 'slow=1e1', 'charged', 'all', 'never_again'):
        assert built_in.KIND.check('properties', right) == right
    for wrong, says in (('slow', 'slow=NUMBER'), ('slow=x', 'slow=NUMBER'), ('slow=101', 'number in 0..100 [s]'),
                        ('charged=3', 'slow=NUMBER, late=NUMBER'), ('swift', 'slow=NUMBER'),
                        (3, 'all, no_cr')):
        with pytest.raises(ConfigurationError, match=re.escape(says)):
            built_in.KIND.check('properties', wrong)
    path = log_of(tmp_path)
    for names, texts in ((['all'], [9]), (['late=3', 'all'], [3]), (['slow=2', 'all'], [9, 2]), (['charged'], [])):
        found = judge(Run(path, properties=names))
        assert [one.text for one in found] == ['it took more than {} s'.format(number) for number in texts]


def test_rows_are_bounded():
    made = Statements()
    rows = made.take('always', False, 'x' * 1000, {'key_%02d' % k: 'y\n' * 1000 for k in range(100)})
    assert max(map(len, rows[1])) <= 220 and len(rows[1]) == 3 + 16
    for k in range(MOST_STATEMENTS + 5):
        news = made.take('always', True, f'{k}', {})
        assert [row[2] for row in news] == (['stated'] if k < MOST_STATEMENTS - 1 else
                                            ['broken'] if k == MOST_STATEMENTS - 1 else [])


@pytest.mark.parametrize('kind, text', [('ever', 'text'), ('always', ''), ('always', 7)])
def test_what_is_no_statement_is_refused(kind, text):
    with pytest.raises(StatementError):
        Statements().take(kind, True, text, {})


def test_without_lockstep_a_break_is_one_warning_and_nothing_else_happens():
    program = ("from move_base_abstract.properties import always, sometimes\n"
               "for k in range(5): always(k < 2, 'small', k=k); sometimes(False, 'never')")
    done = subprocess.run([sys.executable, '-c', program], capture_output=True, text=True, check=True,
                          env=dict(os.environ, PYTHONPATH=os.pathsep.join(sys.path)))
    assert (done.stdout, done.stderr) == ('', 'broken: always: small, k=2\n')


def test_runs_are_gathered_by_property(tmp_path):
    statement = ('/a', 'property', 'always', 'one owner', 'broken', 'task=7')
    told = [judgement_on(Run(log_of(tmp_path, *rows))).told() for rows in (
        [], [DEPARTED, statement], [statement, ('/a', 'property', 'sometimes', 'low', 'stated'), DEPARTED])]
    gathered = Gathering()
    for seed, one in enumerate(told):
        gathered.take(f'trial_{seed}', seed, one)
    assert [(row['property'], row['runs'], row['first_seed'], row['first_instant_ns']) for row in gathered.rows] == [
        ('every_goal_ends', 2, 1, 10 ** 9), ('always', 2, 1, 2 * 10 ** 9)]
    assert list(gathered.lines()) == [
        'broken in 2 of 3 runs, first in trial_1 (seed 1) at 1.000000000 s: every_goal_ends: r0: the goal that it '
        'took in then never ends',
        'broken in 2 of 3 runs, first in trial_1 (seed 1) at 2.000000000 s: always: /a: one owner',
        'held in none of 3 runs: sometimes: /a: low']
    gathered.take('again', 3, judgement_on(Run(log_of(tmp_path, (
        '/a', 'property', 'sometimes', 'low', 'held')))).told())
    assert gathered.sometimes == {('/a', 'low'): (2, 1)} and not gathered.never_held()
