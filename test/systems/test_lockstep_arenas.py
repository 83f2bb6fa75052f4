"""Arenas: what addresses of Python objects decide is the same in each run, with them; without, it is labelled."""
import os
import re
import subprocess
import sys
import unittest
from unittest import mock

from lockstep_launcher_run import FOLDER, assert_same, run_programs
from scenarios import ALL_CORES, Condition

from move_base_abstract_ros.lockstep.machine import arenas
from move_base_abstract_ros.loopback import find_executable

ARENAS, LAYOUT = 'MOVE_BASE_ABSTRACT_ARENAS', 'MOVE_BASE_ABSTRACT_ADDRESS_LAYOUT'
#: with another allocator all other objects lie elsewhere
ELSEWHERE = {'PYTHONMALLOC': 'malloc', 'MORE': 'x' * 3000}


has_arenas = unittest.skipUnless(sys.version_info[:2] in arenas.PYTHON, 'this Python has no arenas')


def run_of(script, condition=Condition(), **environment):
    with mock.patch.dict(os.environ, environment):
        return run_programs({'addressed': [script]}, until=10.0, condition=condition)


@has_arenas
class ArenasTest(unittest.TestCase):
    def test_what_an_address_decides_is_the_same_in_each_run_and_no_reason_for_a_label(self):
        runs = [run_of('addressed.py', **{ARENAS: 'on'}),
                run_of('addressed.py', Condition(load=ALL_CORES), **{ARENAS: 'on'}, **ELSEWHERE),
                run_of('addressed.py', Condition(stops=1, is_warm=False), **{ARENAS: 'on'})]
        said = [run.printed('addressed') for run in runs]
        self.assertEqual(len(said[0]), 17, runs[0].outputs)
        self.assertEqual(said[1:], said[:1] * 2)
        assert_same(self, runs)
        self.assertEqual([list(run.state.not_repeatable_because) for run in runs], [[]] * 3)

    def test_without_them_each_of_these_is_labelled_but_for_sets_in_libraries(self):
        run, other = run_of('addressed.py'), run_of('addressed.py', **ELSEWHERE)
        lines = {int(line) for label in run.state.not_repeatable_because for line in re.findall('line ([0-9]+)', label)}
        with open(os.path.join(FOLDER, 'addressed.py')) as script:
            yields = {number: line for number, line in enumerate(script, 1) if line.startswith('    yield ')}
        said = zip(yields.items(), run.printed('addressed'), other.printed('addressed'))
        differing = {number: line for (number, line), one, two in said if one != two}
        self.assertGreater(len(differing), 10)
        silent = [line for number, line in differing.items() if number not in lines]
        self.assertEqual([line for line in silent if 'keeper.' not in line], [])

    def test_a_random_layout_puts_arenas_elsewhere_and_what_follows_the_order_of_making_stays(self):
        runs = [run_of('addressed.py', **{ARENAS: 'on', LAYOUT: layout}) for layout in ('fixed', 'random')]
        said = [run.printed('addressed') for run in runs]
        self.assertEqual([one == two for one, two in zip(*said)][:4], [True, True, False, False])

    def test_they_hold_for_what_a_program_makes_and_not_for_lists_and_threads(self):
        run = run_of('unplaced.py', **{ARENAS: 'on'})
        path = os.path.join(FOLDER, 'unplaced.py')
        with open(path) as script:
            expected = [number for number, line in enumerate(script, 1) if '# labelled' in line]
        # Whether the program still waits for its lock when the thread gives it back is chance.
        *places, last = [label for label in run.state.not_repeatable_because if 'had input from outside' not in label]
        told = [re.search('{}, line ([0-9]+)'.format(re.escape(path)), label) for label in places]
        self.assertEqual([int(match.group(1)) for match in told], expected)
        self.assertIn('addresses of objects are used again, after threads that lockstep does not order', last)


@has_arenas
class KindsTest(unittest.TestCase):
    def test_objects_of_all_kinds_come_and_go_and_memory_is_bounded(self):
        for environment in ({}, {'PYTHONMALLOC': 'debug'}):
            run = run_of('kinds.py', **{ARENAS: 'on'}, **environment)
            self.assertEqual((run.printed('addressed'), run.codes), (['ended True 0 True'], {'addressed': 0}),
                             run.outputs)


class OtherwiseTest(unittest.TestCase):
    def test_where_they_cannot_be_used_the_run_is_labelled_and_goes_on(self):
        run = run_of('addressed.py', **{ARENAS: 'on', 'PYTHONTRACEMALLOC': '1'})
        self.assertEqual(run.codes, {'addressed': 0}, run.outputs)
        labels = ' '.join(run.state.not_repeatable_because)
        self.assertIn('the arenas of {} cannot be used: '.format(ARENAS), labels)
        self.assertEqual('tracemalloc follows allocations' in labels, sys.version_info[:2] in arenas.PYTHON)
        self.assertIn('addressed.py, line', labels)

    def test_a_python_of_another_version_is_left_alone(self):
        with mock.patch.object(arenas, 'PYTHON', ((3, 8),)):
            self.assertIn('they know Python 3.8, and this is ', arenas._begin(False))
        self.assertFalse(arenas.are_on())

    def test_a_value_that_is_no_choice_is_an_error_with_those_that_are(self):
        command = [sys.executable, find_executable('lockstep'), os.path.join(FOLDER, 'addressed.py')]
        done = subprocess.run(command, env=dict(os.environ, **{ARENAS: '1'}), stderr=subprocess.PIPE, text=True,
                              check=False)
        self.assertEqual((done.returncode, done.stderr), (
            1, "lockstep: the environment's {} must be 'off' or 'on', got '1'\n".format(ARENAS)))
