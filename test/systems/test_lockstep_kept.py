"""Messages for queues that a node calls itself, or on topics declared as stored, are kept for the node's next turn.

Programs that call their queues in all ways that we know have the same event log as with messages that are delivered at
once, in fewer rounds.
"""

import re
import shutil
import unittest
from types import SimpleNamespace

from lockstep_roscpp_run import Program, Runs, own
from master_proxy import MasterProxy

from move_base_abstract_ros.lockstep.ros_master.parameters import Parameters
from move_base_abstract_ros.loopback import find_executable

RUNS = Runs()
#: ways in which shim_reader calls its queues, with other calls
WAYS = (('plain',), ('timer',), ('act',), ('empty',), ('usleep',), ('wait', 'idle'), ('second', 'empty'),
        ('idle', 'empty', 'act', 'timer'), ('second', 'wait', 'act', 'timer', 'idle'))


def reader(*ways, ticks=40):
    return Program('reader', own('shim_reader'), ways=list(ways), ticks=ticks)


def writer():
    return Program('writer', own('shim_reader'), 'write')


def caller():
    return Program('caller', own('shim_reader'), 'call')


def rounds(run):
    return int(re.search(r'(\d+) rounds', run.why).group(1))


class KeptTest(unittest.TestCase):
    def runs(self, *programs, **parameters):
        """Return a run with delivery at once and one that keeps unread messages; check that both are the same."""
        runs = [RUNS.run(list(programs), keep_unread=kept, **parameters) for kept in (False, True)]
        for run in runs:
            self.assertEqual(run.code, 0, run.outputs)
        self.assertEqual(runs[0].labels, runs[1].labels)
        self.assertGreater(len(runs[0].events), 100)
        self.assertEqual(runs[0].events, runs[1].events)
        return runs

    def test_no_program_notices_that_what_it_looks_at_by_itself_is_kept(self):
        for ways in WAYS:
            with self.subTest(ways):
                self.runs(reader(*ways), writer(), caller(), end_with=['/reader'])

    def test_it_saves_the_rounds(self):
        at_once, kept = self.runs(reader('plain', ticks=70), writer(), ask_why=True)
        # In 9 s the writer has a turn at about 540 instants. Its messages cost the reader as many rounds, or none.
        self.assertGreater(rounds(at_once) - rounds(kept), 500)

    def test_declared_topics_come_with_the_next_thing_or_a_second_later_and_the_log_says_so(self):
        programs = [Program('rate', own('shim_rate'), frequency=10.0, ticks=41),
                    Program('recorder', own('shim_recorder'), topics=['/ticks'])]
        self.assertEqual([line.split()[0] for line in RUNS.run(programs).printed(1)[:2]], ['1100000000', '1200000000'])
        run = RUNS.run(programs, stored_topics=['/recorder=/ticks'])
        times = [int(line.split()[0]) for line in run.printed(1)]
        self.assertEqual(len(times), 41)
        self.assertLess(len(set(times)), 8)
        self.assertEqual(run.head['stored_topics'], ['/recorder=/ticks'])
        self.assertNotIn('stored_topics', RUNS.run(programs, stored_topics=[]).head)


class CountingMaster(MasterProxy):
    """One that refuses a parameter."""

    def count(self, method, name):
        """Return the number of calls of a method about a name."""
        return sum(call[0] == method and call[1][1:2] == (name,) for call in self.calls)

    def _dispatch(self, method, params):
        answer = super()._dispatch(method, params)
        if method == 'getParam' and params[1] == '/board/refused':
            if self.count('getParam', '/board/refused') == 1:
                raise RuntimeError('a fault instead of an answer')
            return 1, '', 5
        return answer


class CountedRuns(Runs):
    """Runs whose first program talks to the ROS master through a CountingMaster."""

    master = None

    def start(self, program):
        if program.name == 'asker':
            self.master = CountingMaster(self.ros.uri)
            program.launcher = [shutil.which('env'), 'ROS_MASTER_URI=' + self.master.uri, find_executable('lockstep')]
        return super().start(program)


class AskingAgainInCppTest(unittest.TestCase):
    """The ROS master is asked once for a parameter until it changes, by roscpp programs, too."""

    def test_it_is_asked_once_for_each_value_and_once_for_all_lines_that_are_logged(self):
        self.check_asking(first='1.251', looks=['2.553 1', '2.653 1', '2.753 2', '2.853 2', '2.953 2', '3.053 3'])

    def test_with_a_lookahead_too(self):
        # each set is seen in the first window that begins after it
        self.check_asking(first='1.300', looks=['2.602 1', '2.702 1', '2.802 2', '2.902 2', '3.002 2', '3.102 3'],
                          lookahead=0.05)

    def check_asking(self, first, looks, **parameters):
        """Check what ``shim_board ask`` prints: when it sees the first value, and each later one [s, simulated]."""
        runs = CountedRuns()
        run = runs.run([Program('asker', own('shim_board'), 'ask'), Program('giver', own('shim_board'), 'give')],
                       **parameters)
        self.assertEqual(run.labels, [])
        self.assertEqual(run.printed(0), [
            first + ' 1', '999 lines take 0.000 s', '2500 lines take 0.002 s',
            '0 of 1200 lines of 1200 instants take time', '011', *looks, '0', '9 9'])
        runs.master.close()
        count = runs.master.count
        self.assertEqual(count('getParam', '/rosout_disable_topics_generation'), 1)
        # none, 1, 2, 3, and 9 when it is told
        self.assertEqual((count('getParam', '/board/given'), count('hasParam', '/board/given')), (5, 1))
        self.assertEqual(count('getParam', '/board/refused'), 2)  # a fault is not kept


class FakeMaster:
    """Answers like the ROS master, and counts the questions."""

    def __init__(self):
        self.values = {'/a': {'b': 1}}
        self.asked = 0

    def getParam(self, _caller, name):  # noqa: N802 - the name in the API
        self.asked += 1
        return (1, '', self.values[name]) if name in self.values else (-1, '', 0)

    def hasParam(self, _caller, name):  # noqa: N802
        self.asked += 1
        return 1, '', name in self.values


class FakeParticipant:
    class scheduler:  # noqa: N801
        is_mine = staticmethod(lambda: True)
        wait_round = staticmethod(lambda: None)

    def __init__(self):
        self.members = SimpleNamespace(own_name='/me')
        self.items = []

    def add_aside(self, item):
        self.items.append(item)


class AskingAgainTest(unittest.TestCase):
    """The ROS master is asked once for a parameter until it changes."""

    def setUp(self):
        self.participant, self.master = FakeParticipant(), FakeMaster()
        self.parameters = Parameters(self.participant, self.master)
        self.answers = self.parameters.answers()

    def get(self, name='/a'):
        return self.answers['getParam'](None, '/me', name)[2]

    def test_the_ros_master_is_asked_once(self):
        values = [self.get() for _ in range(10)]
        self.assertEqual((values, self.master.asked), (10 * [{'b': 1}], 1))
        values[0]['b'] = 2  # the program's own copy
        self.assertEqual(self.get(), {'b': 1})
        self.assertEqual([self.answers['hasParam'](None, '/me', '/c')[2] for _ in range(3)], 3 * [False])
        self.assertEqual(self.master.asked, 2)

    def test_it_is_asked_again_when_the_time_master_says_so(self):
        self.get()
        self.master.values['/a'] = 3
        self.parameters.forget()
        self.assertEqual((self.get(), self.get(), self.master.asked), (3, 3, 2))

    def test_what_is_set_in_this_turn_is_seen_at_once_and_asked_for_when_it_is_told(self):
        self.get()
        self.answers['setParam'](None, '/me', '/a/b', 5)
        self.assertEqual((self.get(), self.master.asked), ({'b': 5}, 1))
        self.participant.items[-1]()  # the report
        self.master.values['/a'] = {'b': 5}
        self.assertEqual((self.get(), self.master.asked), ({'b': 5}, 2))

    def test_it_is_asked_each_time_where_others_may_set_it_unheard(self):
        self.get()
        self.parameters.settle()
        self.assertEqual([self.get(), self.get(), self.master.asked][2], 3)
