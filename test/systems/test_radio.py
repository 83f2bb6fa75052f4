"""Nodes as users write them, in Python and C++, on hosts of a radio: a robot drives out of the range of its caller."""
import json
import math
import os
import re
import shutil
import subprocess
import tempfile
import unittest

from move_base_abstract.msg import RadioLink, RadioLinks
from move_base_abstract_ros.loopback import find_executable
from move_base_abstract_ros.nodes.radio_markers_node import RadioMarkers

# On the robot's host: it answers calls, sends the robot away, and writes what it hears, with times, into a file.
SERVER = """#!/usr/bin/env python3
import sys

import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from std_msgs.msg import String
from std_srvs.srv import Trigger, TriggerResponse

def now():
    return rospy.Time.now().to_nsec()


def write(message):
    with open(sys.argv[1], 'a') as stream:
        stream.write('{} {}\\n'.format(now(), message.data))


rospy.init_node('server')
rospy.Service('/trigger', Trigger, lambda _request: TriggerResponse(True, 'at {}'.format(now())))
rospy.Subscriber('/answers', String, write)
client = actionlib.SimpleActionClient('move_base', MoveBaseAction)
client.wait_for_server()
rospy.sleep(3.25)
goal = MoveBaseGoal()
goal.target_pose.header.frame_id = 'map'
goal.target_pose.pose.position.x, goal.target_pose.pose.orientation.w = 30.0, 1.0
client.send_goal_and_wait(goal)
rospy.spin()
"""
# The same for a robot that is driven by velocities.
DRIVING_SERVER = """#!/usr/bin/env python3
import rospy
from geometry_msgs.msg import Twist
from std_srvs.srv import Trigger, TriggerResponse

rospy.init_node('server')
rospy.Service('/trigger', Trigger, lambda _request: TriggerResponse(True, ''))
commands = rospy.Publisher('cmd_vel', Twist, queue_size=1)
rospy.sleep(3.25)
twist = Twist()
twist.linear.x, twist.angular.z = 1.0, 0.5
commands.publish(twist)
rospy.spin()
"""
LAUNCH = """<launch>
  <arg name="heard" />
  <node pkg="move_base_abstract" type="fleet" name="fleet">
    <rosparam>
      defaults: {max_speed: 1.0}
      robots: [{name: robot_1, start_x: 5.0}]
    </rosparam>
  </node>
  <node ns="robot_1" pkg="own" type="server.py" name="server" args="$(arg heard)" />
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


class InFolder:
    """Two runs, ``logs``, in a folder of their own with the files ``texts``, {name: text}."""

    texts = {}

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        for name, text in {'package.xml': PACKAGE, **cls.texts}.items():
            with open(os.path.join(cls.folder, name), 'w', encoding='utf-8') as stream:
                stream.write(text)
        os.chmod(os.path.join(cls.folder, 'server.py'), 0o755)
        cls.logs = [cls.run_once(number) for number in range(2)]

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def run_once(cls, number, words=(), prefix=()):
        """Run once; return (bytes of the event log, lines that the server has written)."""
        path, heard_path = (os.path.join(cls.folder, '{}.{}'.format(number, kind)) for kind in ('jsonl', 'heard'))
        with open(heard_path, 'w', encoding='utf-8'):
            pass  # not all servers write into it
        environment = dict(os.environ, ROS_PACKAGE_PATH=cls.folder + ':' + os.environ['ROS_PACKAGE_PATH'])
        done = subprocess.run(
            [*prefix, find_executable('lockstep_launch'), *words, '--network', os.path.join(cls.folder, 'n.yaml'),
             '--event-log', path, '--log-messages', '--until', '20', os.path.join(cls.folder, 'run.launch'),
             'heard:=' + heard_path], env=environment,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120, check=False)
        if done.returncode != 0:
            raise AssertionError(done.stdout.decode('utf-8', 'replace'))
        with open(path, 'rb') as stream, open(heard_path, encoding='utf-8') as heard:
            return stream.read(), heard.read().splitlines()

    def rows(self, kind, log=None):
        return [row for row in map(json.loads, (log or self.logs[0][0]).splitlines()) if row.get('kind') == kind]

    def test_two_runs_are_equal_to_the_byte(self):
        self.assertEqual(*self.logs)

    def test_nothing_labels_the_run(self):
        end = json.loads(self.logs[0][0].splitlines()[-1])['end']
        self.assertEqual((end['not_repeatable_because'], end['degraded_because']), ([], []))


class Radio(InFolder, unittest.TestCase):
    texts = {'server.py': SERVER, 'n.yaml': NETWORK, 'run.launch': LAUNCH}

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        ahead = ('--lookahead', 'network')
        cls.ahead = [cls.run_once(2, ahead), cls.run_once(3, ahead, ('taskset', '-c', '0'))]

    def test_with_the_network_s_delay_as_lookahead_two_runs_are_equal_to_the_byte_on_any_cores(self):
        self.assertEqual(*self.ahead)
        log, _ = self.ahead[0]
        end = json.loads(log.splitlines()[-1])['end']
        self.assertEqual((end['not_repeatable_because'], end['degraded_because']), ([], []))
        departed = self.rows('departed', log)[0]['time_ns']
        down = [row['time_ns'] for row in self.rows('link', log) if row['values'][2] == 'down']
        self.assertEqual(down, [10**9, departed + 5 * 10**9 + 1])  # at first the position of the robot is unknown

    def test_what_goes_over_the_radio_takes_its_delay_to_the_nanosecond_with_windows_and_without(self):
        for log, heard in (self.logs[0], self.ahead[0]):
            found = [re.match(r'(\d+) (\d+) at (\d+)$', line) for line in heard]
            instants = [tuple(map(int, one.groups())) for one in found if one is not None]
            self.assertGreater(len(instants), 6)
            for arrived, told, served in instants:
                self.assertEqual((arrived - told, told - served), (20_000_000, 20_000_000))
            rows = [row['values'] for row in self.rows('radio', log) if row['robot'] == '/answers']
            self.assertTrue({arrived for arrived, _, _ in instants} <= {values[6] for values in rows})
            self.assertTrue(all(values[6] - values[5] == 20_000_000 for values in rows))

    def test_the_link_goes_down_where_the_robot_comes_to_its_range(self):
        departed = self.rows('departed')[0]['time_ns']
        states = [(row['time_ns'] - departed, row['values']) for row in self.rows('link')]
        # It drives from 5 m to 10 m at 1 m/s; at the range itself it still hears.
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
        # Request and answer take 20 ms each from their sending.
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


class DrivenHost(InFolder, unittest.TestCase):
    """A host that is driven by velocities on a circle, out of the range of its caller and into it again."""

    texts = {'server.py': DRIVING_SERVER, 'n.yaml': NETWORK.replace('range: 10', 'range: 6'),
             'run.launch': LAUNCH.replace('{max_speed: 1.0}', '{driven_by: velocities, cmd_vel_timeout: 0.0}')}

    def setUp(self):
        (self.begin_ns, _, place), = [(row['time_ns'], row['kind'], row['values']) for row in self.rows('driven')]
        self.assertEqual(place, [5.0, 0.0, 0.0, 1.0, 0.0, 0.5])
        # on a circle around (5, 2), at 0.5 rad/s: |(5 + 2 sin a, 2 - 2 cos a)| = 6 where 20 sin a - 8 cos a = 3
        aside, half = math.atan2(8.0, 20.0), math.asin(3.0 / math.hypot(20.0, 8.0))
        angles = aside + half, aside + math.pi - half, aside + half + 2.0 * math.pi
        self.crossings = [self.begin_ns + angle / 0.5 * 1e9 for angle in angles]

    def test_the_link_goes_down_and_up_where_the_arc_crosses_the_range(self):
        states = [(row['time_ns'], row['values'][2]) for row in self.rows('link') if row['time_ns'] > self.begin_ns]
        self.assertEqual([state for _, state in states], ['down', 'up', 'down'])
        for (time_ns, _), crossing in zip(states, self.crossings):
            self.assertLessEqual(abs(time_ns - crossing), 5.0)

    def test_calls_get_through_at_the_times_within_the_range_alone(self):
        down, up, again = self.crossings
        calls = {kind: [row['values'][5] for row in self.rows(kind) if row['robot'] == '/trigger']
                 for kind in ('radio', 'radio_lost')}
        self.assertGreater(min(len(calls['radio']), len(calls['radio_lost'])), 5)
        self.assertTrue(all(sent < down or up < sent < again for sent in calls['radio']), calls)
        self.assertTrue(all(down < sent < up or again < sent for sent in calls['radio_lost']), calls)
        self.assertTrue(any(sent > up for sent in calls['radio']))
