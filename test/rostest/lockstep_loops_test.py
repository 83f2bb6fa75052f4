#!/usr/bin/env python3
"""Scripts that wait by looking, without sleeping, and scripts that talk much while they compute."""

import sys
import unittest

import rostest
from lockstep_launcher_run import assert_same, run_programs, run_thrice
from roslib.packages import find_node


class LookingTest(unittest.TestCase):
    """Loops without sleep: what they look at happens, at its instant, and the run is as repeatable as any."""

    @classmethod
    def setUpClass(cls):
        cls.runs = run_thrice({'looking': ['looking.py', 'move_base:=/robot_0/move_base'], 'rival': ['rival.py']},
                              until=30.0, fleet=[{'name': 'robot_0'}])

    def test_all_runs_are_the_same(self):
        assert_same(self, self.runs)

    def test_they_go_on_at_the_instant_at_which_something_happens(self):
        self.assertEqual([line.split(None, 1)[1] for line in self.runs[0].printed('looking')],
                         ['heard', 'by a flag', 'by the state', 'by the time'])
        heard, flag, state, time = (float(line.split()[0]) for line in self.runs[0].printed('looking'))
        self.assertLess(heard, 1.1)
        # Both look only, so each wait of one second or two ends with the callback, not with the step of time.
        self.assertAlmostEqual(flag, heard + 2.0, places=9)
        self.assertAlmostEqual(state, flag + 2.0, places=9)
        self.assertTrue(state + 0.25 <= time <= state + 0.2511, (state, time))
        self.assertEqual(self.runs[0].printed('rival'), ["%.9f ['there', 'back']" % state])


class TalkingTest(unittest.TestCase):
    """What rospy does while it sends, also a line of the log, gives nobody else the turn."""

    def test_a_callback_that_logs_and_publishes_is_not_interrupted(self):
        run = run_programs({'ledger': ['ledger.py'], 'clerk': ['clerk.py']}, until=5000.0, onlookers=['/notes'],
                           clock={'speed_limit': 200.0})
        self.assertEqual(run.outputs['ledger'].count('KeyError'), 0)
        self.assertEqual(run.printed('ledger'), ['job %d took 0.000000000 s' % number for number in range(3)])
        self.assertEqual(run.state.degraded_because, [])
        self.assertNotEqual(run.state.phase, 'zero_delay_loop')

    def test_it_does_not_matter_when_rosout_is_there(self):
        rosout = find_node('rosout', 'rosout')[0]
        runs = [run_programs({'accountant': ['accountant.py'], 'clerk': ['clerk.py']}, until=6.0, others=others,
                             clock={'speed_limit': 2.0})
                for others in ({'/rosout': ([rosout], 0.0)}, {'/rosout': ([rosout], 1.0)}, {})]
        assert_same(self, runs)
        self.assertEqual(runs[0].printed('accountant'), ['job %d took 0.000000000 s' % number for number in range(3)])
        self.assertEqual(runs[0].outputs['accountant'].count('KeyError'), 0)


if __name__ == '__main__':
    rostest.rosrun('move_base_abstract', 'lockstep_loops', __name__, sysargs=sys.argv)
