"""What programs print as the next step is a command that works as it stands: each is taken and run."""
import filecmp
import os
import re
import shlex
import unittest

from own_folder import OwnPackage

HEARS = """#!/usr/bin/env python3
import rospy
from std_msgs.msg import Int32
rospy.init_node('hears')
assert rospy.get_param('/of_test') == [1, "it's"] and rospy.get_param('/robot/move_base/start_x') == 1.0
rospy.Subscriber('ticks', Int32, lambda tick: None)
rospy.spin()
"""
SYSTEM = """<launch><arg name="what"/>
  <node pkg="study_of_others" type="ticks.py" name="ticks"/>
  <node pkg="study_of_others" type="$(arg what)" name="hears"/>
  <node pkg="move_base_abstract" type="move_base" name="move_base" ns="robot"/>
  <node pkg="of_nobody" type="gone" name="gone"/></launch>
"""
SCRIPT = """import roslaunch.parent
parent = roslaunch.parent.ROSLaunchParent('x', [('a system.launch', ['what:=hears.py'])])
parent.start()
parent.spin()
"""
OPTIONS = ('--leave-out', '/gone', '--start', '/robot/move_base=1,2,0.5', '--param', "/of_test=[1, it's]",
           '--until', '4')


class NextStepsTest(OwnPackage, unittest.TestCase):

    FILES = {'hears.py': HEARS}
    COPIES = ('ticks.py',)

    def setUp(self):
        super().setUp()
        self.file = self.write(os.path.join('a folder', 'a system.launch'), SYSTEM)

    def next_of(self, program, *words):
        """Run a program; return what it says to type next, as (program, words)."""
        code, said = self.run_it(program, *words, cwd=self.path('a folder'))
        self.assertEqual(code, 0, said)
        command = re.search(r'next: [^\n]*?: (rosrun move_base_abstract [^\n]*)', said)
        self.assertIsNotNone(command, said)
        return shlex.split(command.group(1))[2:]

    def test_from_a_look_at_the_nodes_to_the_search_for_another_order(self):
        program, *words = self.next_of('lockstep_launch', '--list', *OPTIONS, 'a system.launch', 'what:=hears.py')
        self.assertEqual(program, 'lockstep_launch')
        program, *words = self.next_of(program, *words)
        self.assertEqual(program, 'verify')
        program, *words = self.next_of(program, '--conditions', 'plain,again', *words)
        self.assertEqual(program, 'chaos')
        program, *words = self.next_of(program, '--seeds', '1:1', '--workers', '1', *words)
        self.assertEqual((program, words[:2]), ('chaos', ['--seeds', '2:2']))
        self.next_of(program, *words)

    def test_from_a_script_to_its_runs_again(self):
        script = self.write(os.path.join('a folder', 'a script.py'), SCRIPT)
        program, *words = self.next_of('lockstep_launch', '--script', '--logs', 'logs/', *OPTIONS, script)
        self.assertEqual((program, words[:3]), ('lockstep_launch', ['--script', '--logs', 'logs_2']))
        self.next_of(program, *words)
        logs = [self.path(os.path.join('a folder', one, 'run_001.jsonl')) for one in ('logs', 'logs_2')]
        self.assertTrue(filecmp.cmp(*logs, shallow=False))
