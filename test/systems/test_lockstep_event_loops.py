"""Unmodified programs with event loops of asyncio are exact, or labelled by file and line if they wait for outside."""
import os
import re
import unittest
from unittest import mock

from lockstep_launcher_run import FOLDER, Scenario, run_programs, run_scenario

ROLES = ('main', 'thread', 'cancel')
SCRIPT = os.path.join(FOLDER, 'event_loops_outside.py')
OUTSIDE = ('child', 'pipe', 'server', 'signal', 'early', 'forever')


class ExactTest(Scenario, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        programs = {role: ['event_loops.py', role] for role in ROLES}
        cls.runs = run_scenario(programs, until=10.0)
        with mock.patch.dict(os.environ, MOVE_BASE_ABSTRACT_ADDRESS_LAYOUT='random'):
            cls.runs.append(run_programs(programs, until=10.0))

    def test_programs_end_and_sets_have_what_was_put_in(self):
        self.assertEqual(self.runs[0].codes, dict.fromkeys(ROLES, 0), self.runs[0].outputs)
        self.assertEqual([sorted(line.split()) for line in self.printed('main') if re.search('set|futures', line)], [
            ['0', '1', '2', '3', '4', '4.05', '5', '6', '7', kind] for kind in ('set', 'futures')])

    def test_a_loop_in_the_main_thread_keeps_to_its_instants(self):
        naps = ['nap {}'.format(number) for number in range(8)]
        self.assertEqual([line for line in self.printed('main') if not re.search('tick|set|futures', line)], [
            '1 begins 0.0', '1 a 0', '1 c 3', '1.1 b 1', '1.1 c 4', '1.1 c 6', '1.2 a 2', '1.3 b 5',
            '1.3 CancelledError CancelledError CancelledError', '1.425 at',
            *('1.6 later {}'.format(number) for number in (0, 1, 3, 4, 5)), '1.8 timeout', '2.05 0 1 4 9',
            *('3.05 ' + nap for nap in naps), '3.05 0 1 2 3 4 5 6 7', *('4.05 ' + nap for nap in naps),
            '4.1125 flag', '4.1125 ends 3.1125 4.1125'])

    def test_callbacks_of_rospy_wake_a_loop_in_the_main_thread(self):
        self.assertEqual([line for line in self.printed('main') if 'tick' in line], [
            '{} heard tick'.format(at) for at in ('1.4', '1.8', '2.2', '2.6', '3', '3.4', '3.8')])

    def test_a_loop_in_a_thread_of_its_own_answers_callbacks_of_rospy(self):
        self.assertEqual(sorted(self.printed('thread')), sorted([
            '1.4625 worked tick', '1.4625 result 1', '1.925 worked tick', '1.925 result 2', '2.3875 worked tick',
            '2.3875 result 3', '2.8 timeout True', '3.2 timeout True', '3.6 timeout True', '4 joined',
            '4 timeout True']))

    def test_tasks_are_cancelled_in_the_order_in_which_they_were_made(self):
        self.assertEqual(self.printed('cancel'), ['1.5 cleans up {}'.format(number) for number in range(12)])


class OutsideTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_ = run_programs({role: ['event_loops_outside.py', role] for role in OUTSIDE}, until=10.0)

    def labels(self, role):
        return [label for label in self.run_.state.not_repeatable_because if label.startswith("'/{}'".format(role))]

    def line(self, words):
        with open(SCRIPT) as stream:
            return next(number for number, line in enumerate(stream, 1) if words in line)

    def test_time_stands_while_a_child_works(self):
        self.assertEqual(self.run_.printed('child'), ['1.0 done 0'], self.run_.outputs)

    def test_what_comes_over_pipes_and_connections_is_served_and_labelled_with_file_and_line(self):
        self.assertEqual(self.run_.printed('pipe'), ["2.0 read b'x'"], self.run_.outputs)
        self.assertEqual(self.run_.printed('server')[0].split()[1:], ['HELLO'], self.run_.outputs)
        for role, words in (('child', 'asyncio.run('), ('pipe', 'add_reader('), ('server', 'start_server(')):
            self.assertTrue(any("'/{}': asyncio in {}, line {}: gets data over a connection".format(
                role, SCRIPT, self.line(words)) in label for label in self.labels(role)), self.labels(role))

    def test_a_signal_wakes_a_loop_and_labels_the_run_only_when_it_comes(self):
        self.assertEqual(self.run_.printed('signal'), ['1.5 slept', '2.0 caught'], self.run_.outputs)
        told = [label for label in self.labels('signal') if 'input from outside' not in label]
        self.assertEqual(len(told), 1, told)
        self.assertRegex(told[0], r"'/signal': asyncio in .*, line {}: SIGUSR1 comes when it comes".format(
            self.line('asyncio.run(')))
        self.assertNotIn('input from outside at 1 s', ' '.join(self.labels('signal')))

    def test_a_loop_that_waits_before_the_program_is_a_node_takes_part(self):
        self.assertEqual(self.run_.printed('early'), ['waited 1.500 0.000', '1.5 joined', '2.0 slept'],
                         self.run_.outputs)
        self.assertEqual(self.labels('early'), [])

    def test_a_loop_that_waits_when_the_run_ends_is_ended(self):
        self.assertEqual(self.run_.printed('forever'), ['4.0 slept', '7.0 slept', '10.0 slept', '10.0 slept',
                                                        'cleaned up'], self.run_.outputs)
        self.assertEqual(self.labels('forever'), [])
