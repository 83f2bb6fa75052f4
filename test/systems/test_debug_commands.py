"""What tells of a fault prints the command that leads to before it in the debugger; as it stands, it leads there."""
import json
import shlex
import subprocess
import unittest
import xml.etree.ElementTree as ElementTree

from own_folder import OwnPackage
from waiting import GUARD

from move_base_abstract_ros.loopback import find_executable

NODE = """#!/usr/bin/env python3
import rospy
from std_msgs.msg import Int32
rospy.init_node('node')
said = rospy.Publisher('said', Int32, queue_size=5)
rospy.sleep(1.0)
said.publish(0)
rospy.sleep(1.0)
said.publish(rospy.get_param('~last'))
rospy.Timer(rospy.Duration(1.5), lambda _: {}['k'], oneshot=True)
rospy.sleep(2.0)
"""
HEARER = """#!/usr/bin/env python3
import rospy
from std_msgs.msg import Int32
rospy.init_node('hearer')
rospy.Subscriber('said', Int32, lambda message: None)
rospy.spin()
"""
LAUNCH = """<launch><arg name="last" default="1"/>
  <node pkg="study_of_others" type="hearer.py" name="hearer"/>
  <node pkg="study_of_others" type="node.py" name="node"><param name="last" value="$(arg last)"/></node>
</launch>"""
FAULT_NS, BEFORE_NS = 4500000000, 4400000000


class DebugCommandsTest(OwnPackage, unittest.TestCase):
    FILES = {'node.py': NODE, 'hearer.py': HEARER}

    def setUp(self):
        super().setUp()
        self.file = self.write('fault.launch', LAUNCH)

    def follow(self, said):
        """Type the command in the last line of ``said``; return where the run stands, and where it breaks then."""
        begin, command = said.splitlines()[-1].split(': rosrun move_base_abstract debug ')
        self.assertTrue(begin.endswith('in the debugger'), begin)
        done = subprocess.run([find_executable('debug'), '--json', *shlex.split(command)], input='until broken\nquit\n',
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=self.environment, cwd=self.folder,
                              timeout=GUARD, text=True, check=False)
        start, broken = map(json.loads, done.stdout.splitlines()[:2])
        return start, broken['broken']

    def check_before(self, said):
        start, broken = self.follow(said)
        self.assertEqual((start['time_ns'], broken['instant_ns'], broken['property']),
                         (BEFORE_NS, FAULT_NS, 'no_exception'), said)

    def test_a_broken_property_is_told_with_the_command_to_before_it(self):
        code, said = self.run_it('lockstep_launch', '--check', self.file, 'last:=2')
        self.assertEqual(code, 4, said)
        self.check_before(said)

    def test_a_crash_of_a_run_with_a_log_is_told_with_the_log(self):
        said, _, _ = self.launch('a.jsonl', '--end-when-idle', self.file, code=3)
        self.assertIn(' --log {} --at 4.4\n'.format(self.path('a.jsonl')), said)
        self.check_before(said)

    def test_a_failed_case_of_rostest_has_it(self):
        results = self.path('result.xml')
        code, said = self.run_it('lockstep_launch', '--check', self.file, '--gtest_output=xml:' + results)
        self.assertEqual(code, 1, said)
        failures = [one.text for one in ElementTree.parse(results).getroot().iter('failure')]
        self.assertEqual(len(failures), 1, failures)
        self.check_before(failures[0])

    def test_the_page_of_the_run_so_far_opens_at_the_present_instant(self):
        browser = self.write('browser', '#!/bin/sh\necho "$1" >> {}/opened\n'.format(self.folder), 0o755)
        for screen in ({'DISPLAY': ':9'}, {'DISPLAY': '', 'WAYLAND_DISPLAY': ''}):
            done = subprocess.run(
                [find_executable('debug'), self.file, '--at', '1'], input='replay\nrun 1.25\nreplay\n',
                stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=self.folder, timeout=GUARD, text=True, check=False,
                env={**self.environment, **screen, 'BROWSER': browser + ' %s'})
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)  # --at is where it stands
            addresses = [line for line in done.stdout.splitlines() if line.startswith('file://')]
            self.assertEqual([one.partition('replay.html')[2] for one in addresses], ['#t=1', '#t=2.25'], done.stderr)
        with open(self.path('opened')) as stream:
            self.assertEqual(len(stream.read().splitlines()), 2)  # with the screen

    def test_compare_leads_to_the_row_before_the_first_difference(self):
        for last in (1, 2):
            self.launch(f'{last}.jsonl', '--log-messages', '--end-when-idle', self.file, f'last:={last}', code=3)
        code, said = self.run_it('compare', '1.jsonl', '2.jsonl')
        self.assertEqual((code, said.count('in the debugger')), (1, 2), said)
        start, _ = self.follow(said)
        self.assertEqual((start['time_ns'], start['new_rows'][-1][1:3]), (2 * 10 ** 9, ['/said', 'message']))
