"""A roscpp program that is linked to the library which others get preloaded (move_base_abstract_take_part).

``linked_chance`` is ``shim_chance``, but for its list of libraries.
"""
import os
import shutil
import subprocess
import unittest
from unittest import mock

from lockstep_roscpp_run import GUARD, Program, Runs, own, read, recorder
from warm import Loopback

from move_base_abstract_ros.lockstep.programs.binary import LOOKS_ON
from move_base_abstract_ros.loopback import find_executable

RUNS = Runs()
ROSRUN = (shutil.which('rosrun'), 'move_base_abstract')
RATE = Program('rate', own('shim_rate'), frequency=10.0, ticks=30)
LAUNCH = """
<launch>
  <node pkg="move_base_abstract" type="linked_chance" name="chance" output="screen" required="true"/>
</launch>
"""


def preloaded(name='site/chance', what='agent'):
    return Program(name, own('shim_chance'), what=what)


def linked(what='agent', launcher=ROSRUN, path='linked_chance'):
    return Program('site/chance', path, launcher=launcher, what=what)


class LockstepLinkedTest(unittest.TestCase):

    def run_it(self, program):
        run = RUNS.run([program, RATE, recorder('/site/told')])
        self.assertEqual((run.code, run.labels), (0, []), run.outputs)
        return run

    def log(self, program):
        return self.run_it(program).text

    def test_started_by_rosrun_and_by_the_launcher_it_has_the_same_log_as_the_preloaded_program(self):
        expected = self.log(preloaded())
        self.assertGreater(expected.count('"message"'), 60)
        self.assertEqual(self.log(linked()), expected)
        with mock.patch.dict(os.environ, [LOOKS_ON]):  # as from an onlooker that starts a run of its own
            self.assertEqual(self.log(linked(launcher=(), path=own('linked_chance'))), expected)
        self.assertNotEqual(self.log(linked(launcher=(find_executable('lockstep'), '--seed', '1'),
                                            path=own('linked_chance'))), expected)

    def test_started_by_roslaunch_it_has_the_same_log_too(self):
        with Loopback() as RUNS.ros:
            path = os.path.join(RUNS.ros.log_dir, 'system.launch')
            with open(path, 'w') as stream:
                stream.write(LAUNCH)
        # roslaunch passes the namespace on, as it takes it for its own.
        self.assertEqual(self.log(linked(launcher=(shutil.which('roslaunch'),), path=path)), self.log(preloaded()))

    def test_its_addresses_are_the_same_in_each_run_and_programs_that_it_starts_are_told_nothing(self):
        run = self.run_it(linked('addresses'))
        self.assertEqual(self.log(linked('addresses')), run.text)
        self.assertTrue(run.printed(-1)[-1].endswith('hands on 0 0'), run.printed(-1)[-1])

    def test_where_the_time_master_is_not_in_lockstep_it_is_an_ordinary_node(self):
        with Loopback() as RUNS.ros:
            RUNS.ros.run('time_master', 'time_master', parameters={'factor': 50.0})
            child = RUNS.start(linked('looks'))
            self.assertEqual(child.process.wait(GUARD), 0, read(child))
            self.assertNotIn('takes part', read(child))

    def test_an_onlooker_takes_no_part_although_it_is_linked(self):
        with Loopback() as ros:
            path = os.path.join(ros.log_dir, 'system.launch')
            log = os.path.join(ros.log_dir, 'events.jsonl')
            with open(path, 'w') as stream:
                stream.write(LAUNCH.replace(' required="true"', '').replace('</launch>', (
                    '<node pkg="move_base_abstract" type="shim_rate" name="rate" required="true">'
                    '<param name="ticks" value="3"/></node></launch>')))
            subprocess.run([find_executable('lockstep_launch'), '--onlooker', '/chance', '--event-log', log, path],
                           check=True, timeout=GUARD)
            with open(log) as stream:
                text = stream.read()
        self.assertIn('"/rate"', text)
        self.assertNotIn('"/chance"', text)

    def test_a_program_that_has_roscpp_before_the_library_is_told_how_to_link(self):
        with Loopback() as RUNS.ros:
            RUNS.ros.set_param('/time_master/mode', 'lockstep')
            roscpp = next(line.split()[2] for line in subprocess.run(
                ['ldd', own('linked_chance')], check=True, text=True, stdout=subprocess.PIPE).stdout.splitlines()
                if 'libroscpp.so' in line)
            child = RUNS.start(linked(launcher=('/usr/bin/env', 'LD_PRELOAD=' + roscpp), path=own('linked_chance')))
            self.assertEqual(child.process.wait(GUARD), 1)
            self.assertRegex(read(child), r'lockstep: the program finds ros::start\(\) in .*/libroscpp.so.*, before '
                                          r'libmove_base_abstract_roscpp_shim.so; .*move_base_abstract_take_part\(')
