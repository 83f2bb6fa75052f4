"""The demo as a user starts it: output, exit codes, and no process left behind.

Everything waits for events; GUARD [s, wall] only ends a test that would never end.
"""

import re
import signal
import subprocess
import unittest

import psutil
import rosgraph
from own_folder import OwnFolder
from waiting import GUARD

from move_base_abstract.mission import read_mission
from move_base_abstract_ros.loopback import find_executable
from move_base_abstract_ros.nodes.demo_run.nodes import shipped

LAUNCH_FILE = '<launch/>'  # a ROS master that the demo must not disturb

CLOCKS = ('lockstep', 'scaled')
MISSION = """
robots:
  - {name: near, start: [0, 0], goals: [[30, 40], [30, 0]]}
  - {name: far, start: [0, 5], goals: [[LENGTH, 5]]}
"""


class Demo(OwnFolder, unittest.TestCase):
    """There is one demo process per test; a far goal keeps it busy for as long as the test needs."""

    def start(self, length_m, *arguments):
        """Start the demo with a mission of two robots and return its Popen."""
        mission = self.write('mission.yaml', MISSION.replace('LENGTH', str(length_m)))
        return self.demo('--mission', mission, *arguments)

    def demo(self, *arguments):
        """Start the demo, which ends with the test; return its Popen."""
        process = subprocess.Popen([find_executable('demo'), *arguments], stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.kill)
        return process

    def start_busy(self, clock):
        """Start a long demo; return its Popen and its child processes once the mission is under way."""
        process = self.start(80000, '--clock', clock, '--factor', '1')
        for line in process.stdout:
            if line.startswith('0/3 goals'):
                return process, psutil.Process(process.pid).children()[0].children()  # below its guard
        raise AssertionError('the demo ended before its first progress line')

    def finish(self, process):
        """Return (the rest of the output, the exit code) of the demo."""
        output, _ = process.communicate(timeout=GUARD)
        return output, process.returncode

    def assert_all_gone(self, children):
        self.assertEqual(len(children), 3)  # rosmaster, time master, fleet
        _, alive = psutil.wait_procs(children, timeout=GUARD)
        alive = [child for child in alive if child.status() != psutil.STATUS_ZOMBIE]
        self.assertEqual(alive, [])

    def test_in_lockstep_the_figures_are_exact_and_the_speed_up_is_told(self):
        output, code = self.finish(self.start(80))
        self.assertEqual(code, 0, output)
        self.assertIn('3 goals, lockstep; started', output)
        self.assertRegex(output, r'\nnear +2/2 +90\.0 +45\.00 +0\.00\n')
        self.assertRegex(output, r'\nfar +1/1 +80\.0 +40\.00 +5\.00\n')
        self.assertRegex(output, r'\n45\.00 s simulated in \d+\.\d\d s of wall time: \d+\.\dx real time, with '
                         r'\d+\.\d messages per simulated second\n$')

    def test_it_prints_plain_progress_a_table_and_the_closing_line(self):
        before = rosgraph.Master('/demo_test').getSystemState()
        output, code = self.finish(self.start(80, '--clock', 'scaled', '--factor', '100'))
        self.assertEqual(code, 0, output)
        self.assertIsNone(re.search(r'[\x00-\x09\x0b-\x1f]', output), 'control characters where there is no terminal')
        self.assertIn('3/3 goals', output)
        self.assertRegex(output, r'\nnear +2/2 +90\.0 +45\.00 ')
        self.assertRegex(output, r'\nfar +1/1 +80\.0 +40\.00 ')
        self.assertRegex(output, r'\n\d+\.\d\d s simulated in \d+\.\d\d s of wall time: \d+\.\dx real time\n$')
        self.assertEqual(rosgraph.Master('/demo_test').getSystemState(), before)

    def test_with_routes_robots_drive_around_the_buildings(self):
        output, code = self.finish(self.demo('--routes', '--robots', '2'))
        self.assertEqual(code, 0, output)
        distances = {name: float(found) for name, found in re.findall(r'\n(robot_\d) +\d/\d +([\d.]+) ', output)}
        plan = read_mission(shipped('config', 'demo_routes_mission.yaml'))
        for robot in plan.robots[:2]:
            straight = sum(one.distance_to(other) for one, other in zip((robot.start, *robot.goals), robot.goals))
            self.assertGreater(distances[robot.name], straight + 5.0, 'straight through the buildings')

    def test_routes_without_a_map_are_refused(self):
        output, code = self.finish(self.start(80, '--routes'))
        self.assertEqual(code, 1, output)
        self.assertIn('demo: --routes needs a map on which all places of the mission are free', output)

    def test_ctrl_c_ends_all_processes_on_each_clock(self):
        for clock in CLOCKS:
            process, children = self.start_busy(clock)
            process.send_signal(signal.SIGINT)
            output, code = self.finish(process)
            self.assertEqual(code, 130, output)
            self.assertIn('demo: interrupted', output)
            self.assert_all_gone(children)

    def test_a_node_that_dies_ends_the_demo_and_is_named_on_each_clock(self):
        for clock in CLOCKS:
            process, children = self.start_busy(clock)
            next(child for child in children if '__name:=fleet' in child.cmdline()).kill()
            output, code = self.finish(process)
            self.assertEqual(code, 1, output)
            self.assertIn('demo: /fleet ended unexpectedly (signal SIGKILL)', output)
            self.assert_all_gone(children)

    def test_a_demo_that_is_killed_leaves_no_process_behind(self):
        process, children = self.start_busy('lockstep')
        process.kill()
        process.wait(GUARD)
        self.assert_all_gone(children)

    def test_wrong_arguments_and_files_are_refused_before_anything_starts(self):
        for arguments, code, words in ((['--factor', 'nan'], 2, "got 'nan'; allowed: a number in 0.01..1e6"),
                                       (['--speed', '0'], 2, 'got 0.0; allowed: a finite number > 0'),
                                       (['--robots', '9'], 1, 'their number must be 1..2, got 9')):
            output, got = self.finish(self.start(80, *arguments))
            self.assertEqual(got, code, output)
            self.assertIn(words, output)
