"""ERROR and FATAL lines of participants stand in the last lines of a run, in trial.json and in the report."""
import glob
import json
import os
import unittest

from own_folder import OwnPackage

# A coordinator that gives up half way through its rounds, with errors of its client, of rospy and of its own.
GIVES_UP = """#!/usr/bin/env python3
import logging
import actionlib, rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from nav_msgs.srv import LoadMap
from std_msgs.msg import String
rospy.init_node('coordinator')
words = rospy.Publisher('/words', String, queue_size=10)
client = actionlib.SimpleActionClient('robot/move_base', MoveBaseAction)
client.wait_for_server()
goal = MoveBaseGoal()
goal.target_pose.header.frame_id = 'map'
goal.target_pose.pose.position.x = goal.target_pose.pose.orientation.w = 1.0
client.send_goal(goal)
client.stop_tracking_goal()
client.get_goal_status_text()
client.wait_for_result()
rospy.sleep(2.0)
rospy.wait_for_service('/change_map')
rospy.ServiceProxy('/change_map', LoadMap)('none.yaml')
for number in range(3):
    words.publish('error %d' % number)
    rospy.sleep(1.0)
rospy.logerr('at %.1f: \\x1b[31mno way\\nto the %s', rospy.get_time(), object())
rospy.logfatal('it gives up')
logging.getLogger('another').error('not a line of ROS')
rospy.spin()
"""
LAUNCH = """<launch>
  <node pkg="move_base_abstract" type="move_base" name="move_base" ns="robot"/>
  <node pkg="move_base_abstract" type="map_server" name="map_server" args="{maps}/farm_yard.yaml"/>
  <node pkg="move_base_abstract" type="shim_listener" name="relay">
    <remap from="ticks" to="/words"/>
  </node>
  <node pkg="study_of_others" type="gives_up.py" name="coordinator"/>
</launch>
"""
MAPS = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'maps')
EXPERIMENT = 'experiment: errors\nlaunch: run.launch\nuntil: {idle: true}\nreplications: 2\n'
WANTED = [
    ('/coordinator', 3, 1, 'Called get_goal_status_text when no goal is running'),
    ('/map_server', 1, 0, '/map_server: change_map: none.yaml: cannot be read: No such file or directory; the map '
     'stays as it is'),
    ('/relay', 3, 0, 'got the error 0')]
LINES = [
    '/coordinator logged 3 ERROR lines and 1 FATAL line, first: ' + WANTED[0][3],
    '/map_server logged 1 ERROR line, first: ' + WANTED[1][3].replace('; the map stays as it is', '...'),
    '/relay logged 3 ERROR lines, first: got the error 0']


class ErrorLinesTest(OwnPackage, unittest.TestCase):
    """Participants in Python, in C++ and of this package log errors, and the run comes to its end all the same."""

    FILES = {'gives_up.py': GIVES_UP}

    def test_the_last_lines_of_a_run_have_them(self):
        path = self.write('run.launch', LAUNCH.format(maps=MAPS))
        for words in ((), ('--lookahead', '0.01')):
            said, log, _ = self.launch('events.jsonl', '--end-when-idle', *words, path)
            self.assertEqual((log.end['ended_by'], log.end['repeatable']), ('idle', True))
            self.assertEqual([line.partition(': ')[2] for line in said.splitlines() if ' logged ' in line], LINES)

    def test_trials_and_the_report_have_them(self):
        self.write('run.launch', LAUNCH.format(maps=MAPS))
        code, said = self.run_it('experiment', 'run', self.write('errors.yaml', EXPERIMENT), '-o', self.path('out'))
        self.assertEqual(code, 0, said)
        trials = glob.glob(self.path('out/trials/*/trial.json'))
        self.assertEqual(len(trials), 2)
        for path in trials:
            with open(path, encoding='utf-8') as stream:
                self.assertEqual([tuple(one.values()) for one in json.load(stream)['error_lines']], WANTED)
        with open(self.path('out/report.html'), encoding='utf-8') as stream:
            text = stream.read()
        for node, _, _, first in WANTED:
            self.assertIn(node, text)
            self.assertIn(first, text)
