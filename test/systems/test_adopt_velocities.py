"""Other people's launch file without a move_base: its own programs drive its robots, in the walls of Stage's world."""
import filecmp
import json
import shlex
import unittest

from own_folder import OwnFolder

from test_adopt import TOLD

FILES = {
    'package.xml': '<package><name>of_a_stranger</name></package>',
    'worlds/walls.pgm': 'P2\n60 40\n255\n' + '\n'.join(
        ' '.join('0' if row in (0, 39) or column in (0, 59) else '255' for column in range(60)) for row in range(40)),
    'worlds/two.world': """define floorplan model ( boundary 1 )
define robot position ( size [ 0.4 0.4 0.2 ] ranger ( sensor ( range [ 0 8 ] fov 180 samples 5 ) ) )
floorplan ( bitmap "walls.pgm" size [ 6 4 1 ] )
robot ( pose [ -2 1 0 0 ] ) robot ( pose [ 2 -1 0 180 ] )
""",
    'launch/two.launch': """<launch>
  <node pkg="stage_ros" type="stageros" name="stage" args="$(dirname)/../worlds/two.world"/>
  <param name="count" value="2"/>
  <node pkg="of_a_stranger" type="start.sh" name="start"/>
</launch>
""",
    'scripts/start.sh': """#!/bin/bash
for ((i=0; i<$(rosparam get /count); i++)); do
  ROS_NAMESPACE=robot_$i rosrun of_a_stranger agent.py _speed:=0.5 &
done
cat
""",
    'scripts/agent.py': """#!/usr/bin/env python
import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan
seen = {}
rospy.init_node('agent')
print 'speed', rospy.get_param('~speed')
rospy.Subscriber('odom', Odometry, lambda message: seen.update(odom=message))
rospy.Subscriber('base_scan', LaserScan, lambda message: seen.update(scan=message))
commands = rospy.Publisher('cmd_vel', Twist, queue_size=1)
message = Twist()
message.linear.x = rospy.get_param('~speed')
rate = rospy.Rate(10)
for turn in range(130):
    commands.publish(message)
    rate.sleep()
place = seen['odom'].pose.pose.position
# the walls are 0.1 m thick; the robot's front is 0.2 m before its centre, where the laser is
assert abs(place.x - 4.7) < 1e-5 and abs(place.y) < 1e-5, place
assert abs(seen['scan'].ranges[5 / 2] - 0.2) < 1e-5, seen['scan']
assert seen['odom'].header.frame_id == rospy.get_namespace() + 'odom', seen['odom']
rospy.spin()
"""}


class AdoptVelocitiesTest(OwnFolder, unittest.TestCase):

    def test_programs_drive_robots_to_stages_walls_and_the_printed_command_gives_the_same_bytes(self):
        for name, text in FILES.items():
            self.write(name, text, 0o755)
        first, second = map(self.path, ('first.jsonl', 'second.jsonl'))
        told, log, events = self.launch('first.jsonl', '--adopt', '--until', '16', '--log-messages',
                                        self.path('launch/two.launch'))
        self.assertTrue(log.end['repeatable'], log.end)
        stalled = {robot: json.loads(values) for _ns, robot, kind, values in events if kind == 'stalled'}
        self.assertEqual(stalled, {'robot_0': ['wall'], 'robot_1': ['wall']}, told)
        words = shlex.split(next(line[len(TOLD):] for line in told.splitlines() if line.startswith(TOLD)))
        words[words.index(first)] = second
        self.assertEqual(self.run_it('lockstep_launch', *words)[0], 0)
        self.assertTrue(filecmp.cmp(first, second, shallow=False))
