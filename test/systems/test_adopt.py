"""Other people's launch file runs as it is, and the command line that adopt prints for it gives the same event log."""
import filecmp
import shlex
import unittest

from own_folder import OwnFolder

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

    def test_an_adopted_launch_file_runs_and_its_command_line_gives_the_same_bytes(self):
        for name, text in FILES.items():
            self.write(name, text, 0o755)
        first, second = map(self.path, ('first.jsonl', 'second.jsonl'))
        told, log, events = self.launch('first.jsonl', '--adopt', '--log-messages', self.path('launch/two.launch'),
                                        'far:=3')
        ended = [(robot, time_ns) for time_ns, robot, kind, _ in events if kind == 'ended']
        self.assertEqual(ended, [('a', 1000000000 + 3500000000), ('b', 4500000000 + 1750000000)], told)
        self.assertTrue(log.end['repeatable'], log.end)
        words = shlex.split(next(line[len(TOLD):] for line in told.splitlines() if line.startswith(TOLD)))
        words[words.index(first)] = second
        self.assertEqual(self.run_it('lockstep_launch', *words)[0], 0)
        self.assertTrue(filecmp.cmp(first, second, shallow=False))
