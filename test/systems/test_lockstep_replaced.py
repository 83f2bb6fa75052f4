"""The functions that a launched program finds replaced in rospy and Python's library are those of the table."""

import json
import os
import subprocess
import sys
import unittest

from lockstep_launcher_run import HERE, run_programs

from move_base_abstract_ros.replacing import replaced

PROBE = os.path.join(HERE, 'lockstep_nodes', 'replaced_probe.py')
STARTS = os.path.join(HERE, 'lockstep_nodes', 'early_threads.py')


class ReplacedTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.launched = run_programs({'probe': None}, until=5.0, commands={'probe': [sys.executable, PROBE, 'probe']})
        cls.told = json.loads(next(line for line in cls.launched.printed('probe') if line.startswith('{"changed"')))
        where = [replaced.LOCKSTEP, replaced.THREADS, replaced.LAUNCHER, replaced.LOOPS,
                 replaced.NODES, replaced.FUTURES]
        where += [replaced.OLD_LOOPS] if sys.version_info < (3, 11) else []
        where += [replaced.NEW_LOOPS] if sys.version_info >= (3, 12) else []
        where += [replaced.NEW_LAUNCHER] if sys.version_info >= (3, 13) else []
        cls.rows = {name for name, row in replaced.ROWS.items() if row.where in where}

    def test_each_row_is_replaced_and_nothing_else(self):
        always = {'threading.Thread.isAlive'}  # replaced before the probe looks, in versions of Python that lack it
        modules = {'rospy.impl.init.time'}  # the probe looks only at functions and classes
        self.assertEqual(set(self.told['changed']) - always, self.rows - modules)

    def test_all_went_by_the_table(self):
        self.assertLessEqual(self.rows, set(self.told['done']))

    def test_the_sources_of_this_system_are_known(self):
        self.assertEqual(self.told['unknown'], '')
        self.assertEqual([line for line in self.launched.logged('probe', 'WARN') if 'stands in for' in line], [])

    def test_a_thread_that_rospy_starts_while_a_program_begins_to_take_part_is_no_early_one(self):
        done = subprocess.run([sys.executable, STARTS], stdout=subprocess.PIPE, text=True, check=True)
        self.assertEqual(done.stdout.split(), ['asked', 'ran', 'ran', '1'])
