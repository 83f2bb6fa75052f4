"""Other people's launch file runs as it is, and the command line that adopt prints for it gives the same event log."""
import os
import shlex
import unittest

import warm
from own_folder import OwnFolder

from move_base_abstract.runs.event_log import EventLog
from move_base_abstract_ros.loopback import find_executable

GUARD = 80.0  # s, wall; only ends a run that would never end
TOLD = 'lockstep_launch: the same by options: rosrun move_base_abstract lockstep_launch '
FILES = {
    'package.xml': '<package><name>of_a_stranger</name></package>',
    'launch/robot.launch': """<launch>
  <arg name="name"/> <arg name="x" default="0.0"/>
  <group ns="$(arg name)">
    <node pkg="gazebo_ros" type="spawn_model" name="spawn" args="-urdf -model $(arg name) -x $(arg x) -y 1 -Y 0
      -param robot_description"/>
    <include file="$(find robot_of_nobody)/launch/bringup.launch"/>
    <node pkg="move_base" type="move_base" name="move_base" machine="of_nobody" respawn="true">
      <rosparam file="$(find robot_of_nobody)/param/costmap.yaml" command="load" ns="global_costmap"/>
      <param name="max_speed" value="2.0"/>
    </node>
    <node pkg="amcl" type="amcl" name="amcl"/>
  </group>
</launch>
""",
    'launch/two.launch': """<launch>
  <arg name="far" default="1"/>
  <include file="$(find gazebo_ros)/launch/empty_world.launch"/>
  <include file="$(find of_a_stranger)/launch/robot.launch">
    <arg name="name" value="a"/><arg name="x" value="-4"/></include>
  <include file="$(dirname)/robot.launch"><arg name="name" value="b"/><arg name="x" value="6.5"/></include>
  <node pkg="of_a_stranger" type="sender.py" name="sender" required="true" args="$(arg far)"/>
</launch>
""",
    'scripts/sender.py': """#!/usr/bin/env python3
import sys
import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
rospy.init_node('sender')
for robot in 'ab':
    client = actionlib.SimpleActionClient('/{}/move_base'.format(robot), MoveBaseAction)
    client.wait_for_server()
    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = 'map'
    goal.target_pose.pose.position.x = float(sys.argv[1])
    goal.target_pose.pose.position.y = 1.0
    goal.target_pose.pose.orientation.w = 1.0
    client.send_goal_and_wait(goal)
"""}


class AdoptTest(OwnFolder, unittest.TestCase):

    def launch(self, *words):
        """Return the output of lockstep_launch, in an environment in which ROS does not find the package."""
        done = warm.run([find_executable('lockstep_launch'), *words], timeout=GUARD)
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout

    def bytes_of(self, name):
        with open(self.path(name), 'rb') as stream:
            return stream.read()

    def test_an_adopted_launch_file_runs_and_its_command_line_gives_the_same_bytes(self):
        for name, text in FILES.items():
            os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
            self.write(name, text, 0o755)
        path, first, second = map(self.path, ('launch/two.launch', 'first.jsonl', 'second.jsonl'))
        told = self.launch('--adopt', '--event-log', first, '--log-messages', path, 'far:=3')
        with open(first) as stream:
            log = EventLog(stream.readlines(), first)
        ended = [(event.robot, event.time_ns) for event in log if event.kind == 'ended']
        self.assertEqual(ended, [('a', 1000000000 + 3500000000), ('b', 4500000000 + 1750000000)], told)
        self.assertTrue(log.end['repeatable'], log.end)
        words = shlex.split(next(line[len(TOLD):] for line in told.splitlines() if line.startswith(TOLD)))
        words[words.index(first)] = second
        self.launch(*words)
        self.assertEqual(self.bytes_of('first.jsonl'), self.bytes_of('second.jsonl'))
