"""Parameters that one node sets and others get: a change takes effect with its round, whichever node was faster."""

import os
import sys
import unittest

from lockstep_launcher_run import HERE, assert_same, run_programs, run_scenario

from move_base_abstract_ros.loopback import find_executable

BY_HAND = os.path.join(HERE, 'set_by_hand.py')


class ParametersTest(unittest.TestCase):
    """Nodes in Python and C++ that communicate by parameters."""

    def test_writers_and_readers_on_a_board_see_the_same_in_each_run(self):
        runs = run_scenario({'b': ['board_writer.py', '20'], 'a': ['board_writer.py', '20'],
                           'quick': ['board_reader.py', '10', '22'], 'slow': ['board_reader.py', '7', '15'],
                           'board': [find_executable('shim_board')]}, until=4.0)
        assert_same(self, runs)
        quick, board = runs[0].printed('quick'), runs[0].printed('board')
        self.assertEqual([line.split(' {')[0] for line in quick[:3]],
                         ['1.000 None', '1.100 board 1', '1.200 board 2'])  # in one round, the last node by name counts
        self.assertIn("'odds': [1, 2.5, 'x<&>', True, '', [], {}], 'small': -1e-12", quick[1])
        self.assertTrue(quick[5].startswith("1.500 board 5 {'latest': 'board 5'} /board/latest False"), quick[5])
        self.assertEqual(board[:2], ['1.000 none none 0:', '1.100 board 1 /board/latest 1: ' + ' '.join(
            '/board/' + name for name in ('a/count', 'a/odds', 'a/small', 'b/count', 'b/odds', 'b/small', 'cpp/list',
                                          'cpp/small', 'latest'))])
        self.assertEqual(len(board), 20, board)

    def test_what_is_set_in_a_turn_is_there_when_it_is_over(self):
        runs = run_scenario({'messenger': ['messenger.py'], 'errand_reader': ['errand_reader.py']}, until=5.0)
        assert_same(self, runs, labelled=())
        seen = [line.split(' ', 1)[1] for line in runs[0].printed('errand_reader')]
        self.assertEqual(seen, 11 * ['sees None'] + ['told done'] + 10 * ['sees done'] + 4 * ['sees the last'])

    def test_a_program_that_is_started_sees_what_was_set(self):
        run = run_programs({'messenger': ['messenger.py', 'start']}, until=5.0)
        self.assertEqual(run.printed('messenger'), ['seen for a program'])
        run = run_programs({'board': [find_executable('shim_board'), 'start']}, until=5.0)
        self.assertEqual(run.printed('board'), ['0 0', '3'])
        self.assertEqual(len(run.state.not_repeatable_because), 1, run.state)  # the one about the program

    def test_what_roslaunch_makes_anew_for_each_run_is_labelled_in_cpp_too(self):
        run = run_programs({'board': [find_executable('shim_board'), 'run_id']}, until=5.0)
        self.assertEqual(list(run.state.not_repeatable_because), [
            "'/board': getParam() of {}: roslaunch sets another one in each run".format(name)
            for name in ('/run_id', '/roslaunch')])

    def test_what_is_set_by_hand_is_seen_and_labelled_where_it_is_asked_for(self):
        # A program sets it until the run is labelled; the waiter asks for it until it is deleted.
        run = run_programs({'waiter': ['parameter_waiter.py', '/by_hand']}, until=1e9, others={
            '/hand': ([sys.executable, BY_HAND, '/by_hand'], 0)})
        self.assertIn('it is there', run.printed('waiter'))
        labels = [label for label in run.state.not_repeatable_because if 'parameter' in label]
        self.assertEqual(labels, ['parameter /by_hand was set or deleted by a program that does not take part, '
                                  'and /waiter asks for it'])
