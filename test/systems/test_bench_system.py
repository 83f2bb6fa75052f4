"""bench/system: its figures for a launch file, and its errors if there is nothing to measure.

The tests compare no figure with a wanted one, since machines differ. They check what must hold on any machine.
"""
import json
import subprocess
import sys
import time
import unittest
from pathlib import Path

from own_folder import GUARD, OwnPackage

ROOT = Path(__file__).resolve().parents[2]
SYSTEM = ROOT / 'bench' / 'system'
BROKEN = '<node pkg="study_of_others" type="breaks.py" name="breaks" output="screen"/>'
ROBOT = '<node pkg="move_base_abstract" type="move_base" name="move_base" ns="robot_0"/>'
SENDS = """<node pkg="study_of_others" type="steps.py" name="steps" output="screen">
<rosparam>
steps:
- {at: 1.0, topic: /robot_0/move_base_simple/goal, type: geometry_msgs/PoseStamped,
   fields: {header: {frame_id: map}, pose: {position: {x: 1.0}, orientation: {w: 1.0}}}}
</rosparam></node>"""
BREAKS = """#!/usr/bin/env python3
import rospy
rospy.init_node('breaks')
raise ValueError('on purpose')
"""


class BenchSystemTest(OwnPackage, unittest.TestCase):
    FILES = {'steps.py': (ROOT / 'tools' / 'foreign' / '.systems' / 'steps.py').read_text(), 'breaks.py': BREAKS}

    def measure(self, *words, nodes):
        """Run bench/system on a launch file with these nodes; return (the finished process, its wall time [s])."""
        file = self.write('system.launch', '<launch>{}</launch>'.format(nodes))
        begin = time.monotonic()
        done = subprocess.run([sys.executable, str(SYSTEM), *words, file], check=False, text=True, timeout=GUARD,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=self.environment)
        return done, time.monotonic() - begin

    def test_start_run_and_end_are_told_apart_and_runs_compared(self):
        done, took = self.measure('--runs', '2', '--name', 'one robot', '--', '--until', '9',
                                  nodes=ROBOT + SENDS)
        self.assertEqual(done.returncode, 0, done.stderr)
        machine, record = (json.loads(line) for line in done.stdout.splitlines())
        self.assertEqual(machine['kind'], 'machine')
        self.assertEqual((record['name'], record['runs'], record['simulated_s']), ('one robot', 2, 8.0))
        self.assertEqual((record['repeatable'], record['same'], record['not_repeatable_because']), (True, True, []))
        self.assertGreaterEqual(record['events'], 2)  # it departs and arrives
        each = record['each_run']
        whole = sum(each['start_s']) + sum(each['run_s']) + sum(each['end_s'])
        self.assertTrue(0.0 < whole <= took, (whole, took))
        for k in range(2):
            self.assertGreater(min(each[key][k] for key in ('start_s', 'run_s', 'end_s')), 0.0, each)
            self.assertAlmostEqual(each['speed_up'][k] * each['run_s'][k], 8.0)
            self.assertTrue(0.0 < 8.0 * each['cpu_s_per_simulated_s'][k] < each['whole_cpu_s'][k], each)
        self.assertGreaterEqual(record['rounds_per_s'] * 8.0, record['events'])
        self.assertGreaterEqual(record['messages_per_s'] * 8.0, 1)  # the goal
        self.assertIn('one robot', done.stderr)  # the table

    def test_the_cpu_of_a_simulated_second_is_divided_by_that_under_roslaunch(self):
        words = ('--runs', '1', '--over-roslaunch', '--', '--until', '5')
        done, took = self.measure(*words, nodes=ROBOT + SENDS)
        self.assertEqual(done.returncode, 0, done.stderr)
        record = json.loads(done.stdout.splitlines()[1])
        self.assertGreater(took, record['simulated_s'])  # at 1x
        self.assertGreater(record['roslaunch_cpu_s_per_simulated_s'], 0.0)
        self.assertAlmostEqual(record['over_roslaunch'] * record['roslaunch_cpu_s_per_simulated_s'],
                               record['cpu_s_per_simulated_s'])

    def test_a_public_system_is_one_of_the_table(self):
        done, _ = self.measure('--public', 'nowhere', nodes=ROBOT)
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, "there is no system 'nowhere'; allowed: connected_motion, .*patrolling_sim")

    def test_a_run_that_fails_or_does_not_end_is_no_measurement(self):
        done, _ = self.measure('--runs', '1', '--', '--until', '9', nodes=ROBOT + BROKEN)
        self.assertEqual((done.returncode, done.stdout.count('"kind"')), (1, 1))  # that of the machine
        self.assertIn('lockstep_launch has ended with', done.stderr)
        self.assertIn('on purpose', done.stderr)
        done, _ = self.measure('--runs', '1', '--timeout', '8', '--', '--speed-limit', '1',
                               nodes=ROBOT + SENDS)
        self.assertEqual((done.returncode, done.stdout.count('"kind"')), (1, 1))
        self.assertIn('not over after 8 s', done.stderr)

    def test_what_it_says_itself_to_lockstep_launch_is_refused(self):
        done, _ = self.measure('--', '--event-log=mine.jsonl', nodes=ROBOT)
        self.assertEqual(done.returncode, 2)
        self.assertIn('--event-log is its own', done.stderr)
