#!/usr/bin/env python3
"""Nodes as users write them, in Python and C++, on hosts of a radio: a robot drives out of reach of who calls it."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

from move_base_abstract.msg import RadioLink, RadioLinks
from move_base_abstract_ros.loopback import find_executable
from move_base_abstract_ros.markers.radio_markers import RadioMarkers

# On the robot's host: it answers calls, and sends the robot away.
SERVER = """#!/usr/bin/env python3
import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from std_srvs.srv import Trigger, TriggerResponse

rospy.init_node('server')
rospy.Service('/trigger', Trigger, lambda _request: TriggerResponse(True, 'here'))
client = actionlib.SimpleActionClient('move_base', MoveBaseAction)
client.wait_for_server()
rospy.sleep(3.25)
goal = MoveBaseGoal()
goal.target_pose.header.frame_id = 'map'
goal.target_pose.pose.position.x, goal.target_pose.pose.orientation.w = 30.0, 1.0
client.send_goal_and_wait(goal)
rospy.spin()
"""
LAUNCH = """<launch>
  <node pkg="move_base_abstract" type="fleet" name="fleet">
    <rosparam>
      defaults: {max_speed: 1.0}
      robots: [{name: robot_1, start_x: 5.0}]
    </rosparam>
  </node>
  <node ns="robot_1" pkg="own" type="server.py" name="server" />
  <node pkg="move_base_abstract" type="shim_calls" name="caller"><param name="client" value="true"/></node>
</launch>
"""
PACKAGE = """<package>
  <name>own</name><version>1.0.0</version><description>its nodes</description><license>BSD</license>
  <maintainer email="nobody@localhost">nobody</maintainer>
</package>
"""
NETWORK = """
hosts:
  robot_*: {nodes: [/robot_*/**], at: robot}
  base: {nodes: [/caller], at: [0, 0]}
links: [{between: [base, robot_*], delay: 0.02, range: 10}]
"""


class Radio(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        texts = {'server.py': SERVER, 'n.yaml': NETWORK, 'run.launch': LAUNCH, 'package.xml': PACKAGE}
        for name, text in texts.items():
            with open(os.path.join(cls.folder, name), 'w', encoding='utf-8') as stream:
                stream.write(text)
        os.chmod(os.path.join(cls.folder, 'server.py'), 0o755)
        cls.logs = [cls.run_once(number) for number in range(2)]

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def run_once(cls, number):
        """Return the bytes of the event log of a run."""
        path = os.path.join(cls.folder, '{}.jsonl'.format(number))
        environment = dict(os.environ, ROS_PACKAGE_PATH=cls.folder + ':' + os.environ['ROS_PACKAGE_PATH'])
        done = subprocess.run(
            [find_executable('lockstep_launch'), '--network', os.path.join(cls.folder, 'n.yaml'), '--event-log', path,
             '--log-messages', '--until', '20', os.path.join(cls.folder, 'run.launch')], env=environment,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120, check=False)
        if done.returncode != 0:
            raise AssertionError(done.stdout.decode('utf-8', 'replace'))
        with open(path, 'rb') as stream:
            return stream.read()

    def rows(self, kind):
        return [row for row in map(json.loads, self.logs[0].splitlines()) if row.get('kind') == kind]

    def test_two_runs_are_equal_to_the_byte(self):
        self.assertEqual(*self.logs)

    def test_the_link_goes_down_where_the_robot_comes_to_its_range(self):
        departed = self.rows('departed')[0]['time_ns']
        states = [(row['time_ns'] - departed, row['values']) for row in self.rows('link')]
        # From 5 m to 10 m with 1 m/s; at the range itself it still hears.
        self.assertIn((5 * 10**9 + 1, ['base', 'robot_1', 'down']), [(t, sorted(v[:2]) + v[2:]) for t, v in states])

    def test_calls_of_a_roscpp_program_fail_from_then_on(self):
        departed = self.rows('departed')[0]['time_ns']
        down = departed + 5 * 10**9
        lost = [row for row in self.rows('radio_lost') if row['robot'] == '/trigger']
        calls = [row for row in self.rows('radio') if row['robot'] == '/trigger']
        self.assertGreater(len(calls), 6)
        self.assertTrue(all(row['values'][5] <= down for row in calls), calls[-1])
        self.assertGreater(len(lost), 6)
        self.assertTrue(all(row['values'][5] > down and row['values'][6] == 'range' for row in lost), lost[0])
        # Request and answer take 20 ms each, from when they are sent.
        self.assertTrue(all(row['values'][6] - row['values'][5] == 20_000_000 for row in calls))

    def test_lines_for_rviz(self):
        links = RadioLinks(links=[RadioLink(one='a', other='b', up=True, arrived=1, placed=True),
                                  RadioLink(one='a', other='c', up=False, placed=True),
                                  RadioLink(one='b', other='c', up=True, arrived=1, lost=1)])
        markers = RadioMarkers('map')
        used, down = markers.of(links).markers
        self.assertEqual((used.color.g, down.color.r, used.header.frame_id), (0.65, 0.85, 'map'))
        quiet, _ = markers.of(links).markers
        self.assertEqual(quiet.color.g, 0.5)

    def test_nothing_labels_the_run(self):
        end = json.loads(self.logs[0].splitlines()[-1])['end']
        self.assertEqual((end['not_repeatable_because'], end['degraded_because']), ([], []))


if __name__ == '__main__':
    import rostest
    rostest.rosrun('move_base_abstract', 'radio', Radio, sys.argv)
