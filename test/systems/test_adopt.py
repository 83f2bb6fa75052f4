"""Other people's launch file runs as it is, and the command line that adopt prints for it gives the same event log."""
import filecmp
import json
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
    <node pkg="amcl" type="amcl" name="amcl"><param name="initial_cov_xx" value="0.5"/></node>
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

MAPPED = {
    'package.xml': FILES['package.xml'],
    'maps/yard.pgm': 'P2\n40 20\n255\n' + '\n'.join(
        ' '.join('0' if 18 <= column < 22 and row > 3 else '205' if column > 37 else '255' for column in range(40))
        for row in range(20)),
    'maps/yard.yaml': 'image: yard.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\n'
                      'free_thresh: 0.196\n',
    'launch/robot.launch': """<launch>
  <arg name="name"/> <arg name="x"/>
  <group ns="$(arg name)">
    <node pkg="amcl" type="amcl" name="amcl">
      <param name="initial_pose_x" value="$(arg x)"/><param name="initial_pose_y" value="0.55"/></node>
    <node pkg="move_base" type="move_base" name="move_base">
      <rosparam>{base_local_planner: dwa_local_planner/DWAPlannerROS, global_costmap: {robot_radius: 0.1,
        map_topic: /map}, DWAPlannerROS: {max_vel_x: 1.0}, NavfnROS: {default_tolerance: 0.4}}</rosparam>
    </node>
  </group>
</launch>
""",
    'launch/yard.launch': """<launch>
  <node pkg="map_server" type="map_server" name="map_server" args="$(dirname)/../maps/yard.yaml"/>
  <include file="$(dirname)/robot.launch"><arg name="name" value="a"/><arg name="x" value="1.05"/></include>
  <include file="$(dirname)/robot.launch"><arg name="name" value="b"/><arg name="x" value="2.05"/></include>
  <include file="$(dirname)/robot.launch"><arg name="name" value="c"/><arg name="x" value="-1.0"/></include>
  <node pkg="of_a_stranger" type="sender.py" name="sender" required="true"/>
</launch>
""",
    'scripts/sender.py': FILES['scripts/sender.py'].replace('ab', 'abc').replace(
        '    goal = ', '    for x in (3.05, 1.85, 9.0):\n        goal = ').replace(
        '    goal.', '        goal.').replace('    client.send', '        client.send').replace(
            'float(sys.argv[1])', 'x').replace('y = 1.0', 'y = 0.55')}


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
        self.assertIn('note: of this file these parameters have no effect:\n    /a/amcl and /b/amcl: initial_cov_xx\n',
                      told)
        words = shlex.split(next(line[len(TOLD):] for line in told.splitlines() if line.startswith(TOLD)))
        words[words.index(first)] = second
        self.assertEqual(self.run_it('lockstep_launch', *words)[0], 0)
        self.assertTrue(filecmp.cmp(first, second, shallow=False))

    def test_experiment_chaos_and_verify_say_how_to_see_what_is_made_of_the_file(self):
        for name, text in FILES.items():
            self.write(name, text, 0o755)
        self.write('a.yaml', 'experiment: a\nlaunch: launch/two.launch\nadopt: true\nuntil: {idle: true}\n')
        for words in (('experiment', 'run', 'a.yaml', '-o', 'out', '--workers', '1'),
                      ('chaos', '--seeds', '1', '--adopt', self.path('launch/two.launch')),
                      ('verify', '--runs', '2', '--adopt', self.path('launch/two.launch'))):
            said = self.run_it(*words)[1]
            line = next((one for one in said.splitlines() if 'what is made of the launch file' in one), said)
            code, told = self.run_it(*shlex.split(line.partition('rosrun move_base_abstract ')[2]))
            self.assertEqual((code, '/a/spawn (gazebo_ros/spawn_model) is left out: ' in told), (0, True), told)

    def test_a_map_in_the_file_keeps_robots_out_of_its_walls_unless_the_user_says_otherwise(self):
        for name, text in MAPPED.items():
            self.write(name, text, 0o755)
        motion = '--param', '/log_motion=true'
        told, log, events = self.launch('map.jsonl', '--adopt', *motion, self.path('launch/yard.launch'))
        self.assertTrue(log.end['repeatable'], log.end)
        for start in ('/b/move_base starts at (2.05, 0.55), in an occupied cell of the map of /map_server, and may',
                      '/c/move_base starts at (-1, 0.55), off the map of /map_server, and may leave that place'):
            self.assertIn(start, told)
        events = [(robot, kind, json.loads(values)) for _ns, robot, kind, values in events]
        goals = [[round(one, 6) for one in values[:2]] for robot, kind, values in events if (robot, kind) == (
            'a', 'departed')]
        self.assertEqual(goals, [[3.05, 0.55], [1.65, 0.55]], told)  # navfn's tolerance: as near as the wall allows
        ended = [(robot, values[2]) for robot, kind, values in events if kind == 'ended']
        no_plan = 'Failed to find a valid plan. Even after executing recovery behaviors.'
        self.assertEqual(ended, [(robot, text) for robot in 'abc'
                                 for text in ('Goal reached.', 'Goal reached.', no_plan)])
        places = {robot: [[round(one, 6) for one in piece[1:3]] for piece in pieces]
                  for robot, kind, pieces in events[::-1] if kind == 'pieces'}
        self.assertGreater(max(y for _, y in places['a']), 1.6)  # around the end of the wall
        self.assertEqual(places['b'][1], [2.35, 0.55])
        self.assertEqual(places['c'][1], [0.05, 0.55])
        _told, _log, straight = self.launch('straight.jsonl', '--adopt', *motion, '--param', 'use_map=false',
                                            self.path('launch/yard.launch'))
        self.assertEqual({len(json.loads(values)) for _ns, _robot, kind, values in straight if kind == 'pieces'}, {2})
        self.assertEqual({json.loads(values)[2] for _ns, _robot, kind, values in straight if kind == 'ended'},
                         {'Goal reached.'})
