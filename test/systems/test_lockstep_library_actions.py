"""Python nodes in lockstep: stock actionlib, tf2 and message_filters, and the same log in every run."""

import unittest

from actionlib_msgs.msg import GoalStatus
from lockstep_library_run import Runs
from scenarios import Condition, repeated

RUNS = Runs()


class ActionsTest(unittest.TestCase):
    """Stock action clients and servers."""

    def test_simple_client_and_server(self):
        run = RUNS.run('actions', 'simple_client', 'simple_server')
        self.assertEqual(run.of('simple_client'), [
            (1.25, 'server', False), (1.5, 'server', True), (1.5, 'feedback', 0), (2.5, 'feedback', 1),
            (3.5, 'feedback', 2), (4.5, 'result', False, True, 30, GoalStatus.SUCCEEDED),
            (6.5, 'again', GoalStatus.SUCCEEDED, 20), (8.5, 'too long', GoalStatus.PREEMPTED, -2),
            (10.5, 'done', GoalStatus.PREEMPTED, -2), (10.5, 'end', GoalStatus.PREEMPTED)])
        self.assertEqual(run.of('simple_server'), [
            (1.5, 'begins', 3), (4.5, 'begins', 2), (6.5, 'begins', 5), (8.5, 'is preempted', 2), (8.5, 'begins', 5),
            (10.5, 'is preempted', 2)])
        self.assertTrue(run.end['repeatable'], run.end)

    def test_action_client_and_server(self):
        run = RUNS.run('actions', 'many_server', 'two_at_once')
        self.assertEqual(run.of('two_at_once'), [
            (1.0, 'server', True), (2.0, 'done', 1, GoalStatus.SUCCEEDED), (3.0, 'done', 2, GoalStatus.SUCCEEDED),
            (3.0, 'done', 2, GoalStatus.SUCCEEDED), (4.0, 'done', 3, GoalStatus.SUCCEEDED), (4.0, 'over', True)])
        self.assertTrue(run.end['repeatable'], run.end)


class MessagesTest(unittest.TestCase):
    """Libraries that use topics: tf2 and message_filters."""

    def test_tf2(self):
        run = RUNS.run('actions', 'broadcaster', 'transformer')
        self.assertEqual(run.of('transformer'), [(1.5, 'error', 'LookupException'), (2.45, 'found', 10.35),
                                                 (3.45, 'can', 0)])
        self.assertTrue(run.end['repeatable'], run.end)

    def test_message_filters(self):
        run = RUNS.run('actions', 'filtered', 'left', 'right')
        self.assertEqual(run.of('filtered'), [(float(2 + step), 'both', 2.0 * step + 1, float(step))
                                              for step in range(4)])


class SamenessTest(unittest.TestCase):
    """Some of everything, with random delays, gives the same log."""

    def test_each_run_gives_the_log_of_the_first_whatever_else_happens(self):
        def run(condition, adverse=0.005):
            return RUNS.run('actions', 'mixed_1', 'mixed_2', 'mixed_3', adverse=adverse, log_messages=True,
                            condition=condition)
        runs = [run(Condition(), 0.0), *repeated('some of everything', run, lambda one: one.text.encode())]
        self.assertGreater(len(runs[0].all), 300)
        self.assertTrue(runs[0].end['repeatable'], runs[0].end)
        for number, run in enumerate(runs):
            first, other = runs[0].text.splitlines(), run.text.splitlines()
            for line, (a, b) in enumerate(zip(first, other), 1):
                self.assertEqual(a, b, f'run {number}, line {line}')
            self.assertEqual(run.text, runs[0].text)
