"""Launch files of others without a move_base: their robots are driven by velocities, as their simulators had them."""
import argparse
import math
import os
import shlex

import pytest

from move_base_abstract_ros.adopting import kinds, worlds
from move_base_abstract_ros.launching import adoption, command_line
from move_base_abstract_ros.nodes.launch_run import launched
from strangers_package import ROBOTS_INC, WORLD, adopt, package_fixture, write_map, write_stage  # noqa: F401 - a fixture

FLEET = '/velocity_robots'
SPAWNED = """<group ns="{0}"><param name="robot_description" command="$(find xacro)/xacro {4}"/>
    <node name="spawn_urdf" pkg="gazebo_ros" type="spawn_model" args="-urdf -model {0} -x {1} -y {2} -Y {3}
      -param robot_description"/></group>"""
TURTLEBOT = '$(find turtlebot3_description)/urdf/turtlebot3_$(env TURTLEBOT3_MODEL).urdf.xacro'
STAGE = """<launch><node pkg="stage_ros" type="stageros" name="stage" args="{} $(dirname)/../worlds/two.world">{}</node>
  {}</launch>"""
#: a model in three files: a plugin that drives it, a laser, its true pose; macros that nothing uses, and comments
MODEL = """<robot xmlns:xacro="x"> <!-- <plugin name="a" filename="libgazebo_ros_planar_move.so"> </plugin> -->
  <xacro:include filename="$(find of_a_stranger)/urdf/laser.xacro"/> <xacro:include filename="unused.xacro"/>
  <gazebo><plugin name="d" filename="libgazebo_ros_diff_drive.so"><commandTopic>drive</commandTopic>
    <odometryTopic>odom</odometryTopic><robotBaseFrame>chassis</robotBaseFrame><updateRate>{rate}</updateRate>
    <odometrySource>encoder</odometrySource></plugin>
    <plugin name="p" filename="libgazebo_ros_p3d.so"><topicName>ground_truth/state</topicName></plugin></gazebo>
  <xacro:property name="half" value="0.25"/><link name='base_link'><visual><geometry><box size="9 9 9"/>
  </geometry></visual>
  <collision><geometry><cylinder length="1" radius="${half}"/></geometry></collision></link>
  <xacro:property name="r" value="0.35"/><xacro:eye/></robot>"""
LASER = """<robot><xacro:macro name="eye" params="r"><joint name="j" type="fixed"><parent link="chassis"/>
    <child link="eye_link"/><axis xyz="0 1 0"/><origin xyz="0.2 0 ${r}" rpy="0 0 1.57"/></joint>
  <gazebo reference="eye_link"><sensor type="gpu_ray" name="s"><update_rate>40</update_rate><ray><scan><horizontal>
    <samples>720</samples><min_angle>-1.5</min_angle><max_angle>1.5</max_angle></horizontal></scan>
    <range><min>0.1</min><max>8.0</max></range></ray><plugin name="l" filename="libgazebo_ros_gpu_laser.so">
    <topicName>laser/scan</topicName><frameName>eye_link</frameName></plugin></sensor></gazebo></xacro:macro></robot>"""
UNUSED = """<robot><xacro:macro name="other"><gazebo><plugin name="d" filename="libgazebo_ros_planar_move.so">
  <commandTopic>wrong</commandTopic></plugin></gazebo></xacro:macro></robot>"""


def rows(made):
    """Return {name: all parameters of a robot, those of all robots too} of a fleet."""
    scenario = made.options.param[FLEET]
    return {row['name']: {**scenario['defaults'], **row} for row in scenario['robots']}


def retries_of(made):
    """Return {namespace: max_planning_retries} of the parameters that are set."""
    return {name.split('/')[1]: value for name, value in made.options.param.items()
            if name.endswith('/move_base/max_planning_retries')}


def pose(row):
    return tuple(row[key] for key in ('start_x', 'start_y', 'start_yaw'))


def test_robots_that_are_only_spawned_are_driven_by_velocities_in_one_process_and_things_are_no_robots(package):
    path = package('spawn.launch', """<launch>{} {}
      <node pkg="gazebo_ros" type="spawn_model" name="box" args="-sdf -file $(dirname)/box.sdf -model box -x 9 -y 9"/>
      <node pkg="gazebo_ros" type="spawn_model" name="t" args="-urdf -param robot_target -model target_1 -x 8"/>
    </launch>""".format(SPAWNED.format('a', '1', '0', '0', TURTLEBOT), SPAWNED.format('b', '2', '0', '1', TURTLEBOT)))
    made = adopt(path)
    assert made.problems == () and dict(made.options.start) == {}
    assert dict(made.options.add) == {FLEET: 'move_base_abstract/fleet'}
    assert {name: pose(row) for name, row in rows(made).items()} == {'a': (1.0, 0.0, 0.0), 'b': (2.0, 0.0, 1.0)}
    shared = made.options.param[FLEET]['defaults']
    assert (shared['driven_by'], shared['robot_radius']) == ('velocities', 0.105)
    assert 'robot_base_frame' not in shared  # nobody publishes base_link below base_footprint: our robot does
    assert (shared['scan_beams'], shared['scan_range_max'], shared['scan_topic'], shared['scan_frame']) == (
        360, 3.5, 'scan', 'base_scan')
    assert (shared['scan_x'], shared['scan_z']) == (-0.032, 0.182)
    assert shared['odom_origin'] == [0.0, 0.0, 0.0]  # Gazebo's plugin tells the place in the world
    assert shared['cmd_vel_timeout'] == 0.0 and shared['publish_map_frame'] is False and 'use_map' not in shared


@pytest.mark.parametrize(('name', 'expected'), [
    ('target', True), ('Obstacle_12', True), ('red_box', True), ('person1/x', True), ('cylinder-2', True),
    ('turtlebox', False), ('robot_0', False), ('boxer', False), ('goalkeeper', False)])
def test_things_are_known_by_whole_words_of_their_names(name, expected):
    assert kinds.is_thing(name) is expected


def test_the_printed_command_has_the_same_robots(package):
    path = package('spawn.launch', '<launch>{} {}</launch>'.format(
        SPAWNED.format('a', '1', '0', '0', TURTLEBOT), SPAWNED.format('b', '2', '0', '1', TURTLEBOT)))
    made = adopt(path)
    words = shlex.split(command_line.typed('lockstep_launch', made.options, [path]))
    _parser, read = launched.read_words(words[words.index('lockstep_launch') + 1:])
    assert read.run.param == made.options.param and read.run.add == made.options.add


def test_what_the_user_says_of_one_robot_of_many_counts(package):
    path = package('spawn.launch', '<launch>{} {} {}</launch>'.format(*(
        SPAWNED.format(name, '1', '0', '0', TURTLEBOT) for name in 'abc')))
    made = adopt(path, start={'/b/velocity_robot': (7.0, 8.0, 0.5)}, leave_out=('/c/velocity_robot',), param={
        '/a/velocity_robot/scan_rate': 2.0, '/a/velocity_robot': {'linear': {'x': {'min_velocity': 1}}}})
    found = rows(made)
    assert sorted(found) == ['a', 'b'] and pose(found['b']) == (7.0, 8.0, 0.5)
    assert (found['a']['scan_rate'], found['b']['scan_rate']) == (2.0, 5.0)
    assert found['a']['linear'] == {'x': {'min_velocity': 1}}
    assert made.options.leave_out and '/c/velocity_robot' not in made.options.leave_out


def test_one_robot_and_robots_that_are_not_side_by_side_are_nodes_of_their_own(package):
    one = adopt(package('one.launch', '<launch>{}</launch>'.format(SPAWNED.format('a', 1, 2, 3, TURTLEBOT))))
    assert dict(one.options.add) == {'/a/velocity_robot': 'move_base_abstract/velocity_robot'}
    assert dict(one.options.start) == {'/a/velocity_robot': (1.0, 2.0, 3.0)}
    assert one.options.param['/a/velocity_robot/tf_prefix'] == 'a'
    two = adopt(package('two.launch', '<launch>{}{}</launch>'.format(
        SPAWNED.format('a', 1, 2, 3, TURTLEBOT), SPAWNED.format('b/c', 1, 2, 3, TURTLEBOT))))
    assert sorted(two.options.add) == ['/a/velocity_robot', '/b/c/velocity_robot']
    assert any('neither see nor stop one another' in remark for remark in two.remarks)


def test_a_model_says_its_drive_its_laser_and_its_topics_even_if_xacro_is_not_here(package):
    package('urdf/robot.xacro', MODEL.replace('{rate}', '20'))
    package('urdf/laser.xacro', LASER)
    package('urdf/unused.xacro', UNUSED)
    made = adopt(package('two.launch', '<launch>{}{}</launch>'.format(*(
        SPAWNED.format(name, 1, 2, 3, '$(find of_a_stranger)/urdf/robot.xacro') for name in 'ab'))))
    shared = made.options.param[FLEET]['defaults']
    assert (shared['robot_base_frame'], shared['publish_rate'], shared['holonomic']) == ('chassis', 20.0, False)
    assert 'odom_origin' not in shared and shared['robot_radius'] == 0.25
    assert {key: shared['scan_' + key] for key in ('rate', 'beams', 'angle_min', 'range_max', 'x', 'z', 'yaw', 'topic')
            } == {'rate': 40.0, 'beams': 720, 'angle_min': -1.5, 'range_max': 8.0, 'x': 0.2, 'z': 0.35, 'yaw': 1.57,
                  'topic': 'laser/scan'}
    assert made.options.add[FLEET].split()[1:] == [
        '/a/base_pose_ground_truth:=/a/ground_truth/state', '/a/cmd_vel:=/a/drive',
        '/b/base_pose_ground_truth:=/b/ground_truth/state', '/b/cmd_vel:=/b/drive']


@pytest.mark.parametrize('text', [
    '<robot>{}</robot>'.format('<a>' + 50000 * ' ' + '<b/></a>'), '<robot>{}</robot>'.format(10000 * '<joint '),
    '<robot>{}</robot>'.format(10000 * '<plugin filename="libx.so">'), '<robot>{}</robot>'.format(
        10000 * '<sensor type="ray">' + 10000 * '</sensor>'), 30000 * '<xacro:macro name="a" ',
    100000 * '<!--', '<!DOCTYPE r [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><robot>&b;</robot>'])
def test_a_model_that_is_odd_is_read_to_its_end_in_little_time(package, text):
    package('urdf/robot.xacro', text)
    made = adopt(package('one.launch', '<launch>{}</launch>'.format(
        SPAWNED.format('a', 1, 2, 3, '$(find of_a_stranger)/urdf/robot.xacro'))))
    assert made.options.start['/a/velocity_robot'] == (1.0, 2.0, 3.0)
    assert any('laser' in one for one in made.remarks)


def test_a_model_is_read_as_gazebo_reads_it(package):
    package('urdf/robot.urdf', '\n<?xml version="1.0"?><!-- ---- <sensor/> ---- -->\n' + LASER.replace('xacro:', ''))
    made = adopt(package('one.launch', '<launch>{}</launch>'.format(
        SPAWNED.format('a', 1, 2, 3, '$(find of_a_stranger)/urdf/robot.urdf'))))
    assert made.options.param['/a/velocity_robot/scan_beams'] == 720


def test_a_model_is_found_for_a_launch_file_with_a_comma_in_its_name(package):
    package('urdf/robot.xacro', MODEL.replace('{rate}', '20'))
    made = adopt(package('one,two.launch', '<launch>{}</launch>'.format(
        SPAWNED.format('a', 1, 2, 3, '$(find of_a_stranger)/urdf/robot.xacro'))))
    assert made.options.param['/a/velocity_robot/publish_rate'] == 20.0


def test_a_controller_says_its_topics_limits_and_time_out(package):
    package('config/a.yaml', """drive_controller: {type: diff_drive_controller/DiffDriveController, publish_rate: 25,
      cmd_vel_timeout: 0.25, base_frame_id: /hull, linear: {x: {has_velocity_limits: true, max_velocity: 2.5,
      has_jerk_limits: true, max_jerk: 5.0}}, angular: {z: {has_velocity_limits: true, max_velocity: 2.0}}}\n""")
    made = adopt(package('one.launch', """<launch><group ns="r"><rosparam file="$(dirname)/../config/a.yaml"/></group>
      <node pkg="controller_manager" type="spawner" name="s" args="drive_controller" ns="r"/>{}</launch>""".format(
          SPAWNED.format('r', 1, 2, 3, 'x'))))
    name = '/r/velocity_robot/'
    assert made.options.add['/r/velocity_robot'].split()[1:] == [
        '/r/cmd_vel:=/r/drive_controller/cmd_vel', '/r/odom:=/r/drive_controller/odom']
    assert made.options.param[name + 'linear'] == {'x': {'has_velocity_limits': True, 'max_velocity': 2.5}}
    assert made.options.param[name + 'angular'] == {'z': {'has_velocity_limits': True, 'max_velocity': 2.0}}
    assert (made.options.param[name + 'cmd_vel_timeout'], made.options.param[name + 'robot_base_frame'],
            made.options.param[name + 'publish_rate']) == (0.25, 'hull', 25.0)
    assert any('its size, its laser and the topics of its plugins are not known' in one for one in made.remarks)


def test_robots_of_stage_have_its_frame_its_walls_its_lasers_and_its_watchdog(package):
    write_map(package)
    write_stage(package, '2.0 1.5 0 0')
    package('worlds/robots.inc', ROBOTS_INC.replace('range [ 0 8 ]', 'range [ 0.1 8 ] fov 180 samples 181').replace(
        'ranger_robot position (', 'ranger_robot position ( drive "omni" origin [ 0.1 0 0 0 ] localization "odom" '
        'localization_origin [ 0 0 0 0 ] odom_error [ 0.1 0 0 0.2 ] velocity_bounds [ -0.5 2 -1 1 -1 1 -45 90 ]'))
    made = adopt(package('two.launch', STAGE.format('-g', '<param name="base_watchdog_timeout" value="0.5"/>', '')))
    found = rows(made)
    assert {name: pose(row) for name, row in found.items()} == {
        'robot_0': (1.0, 2.0, math.pi / 2), 'robot_1': (-1.0, 1.0, math.pi)}
    robot = found['robot_0']
    assert (robot['base_watchdog_timeout'], robot['holonomic'], robot['publish_rate']) == (0.5, True, 10.0)
    assert robot['footprint'] == [[-0.1, -0.2], [-0.1, 0.2], [pytest.approx(0.3), 0.2], [pytest.approx(0.3), -0.2]]
    assert robot['odom_origin'] == [0.0, 0.0, 0.0] and robot['odom_error'] == [0.1, 0.0, 0.0, 0.2]
    assert robot['linear']['x'] == {'has_velocity_limits': True, 'min_velocity': -0.5, 'max_velocity': 2.0}
    assert robot['angular']['z']['min_velocity'] == pytest.approx(-math.pi / 4)
    other = found['robot_1']
    assert (other['scan_beams'], other['scan_angle_max'], other['scan_range_min'], other['scan_topic'],
            other['scan_frame'], other['scan_rate']) == (181, math.pi / 2, 0.1, 'base_scan', 'base_laser_link', 10.0)
    assert (robot['scan_z'], other['scan_z']) == (0.2, 0.2)  # as stage_ros says: on the body, which is 0.2 m high
    assert (robot['scan_topic'], robot['scan_frame']) == ('base_scan_0', 'base_laser_link_0')
    assert any('/robot_0/velocity_robot: it has 2 lasers in the world, and one here' in one for one in made.remarks)
    assert (robot['use_map'], robot['map_topic'], robot['publish_map_frame']) == (True, '/stage_walls/map', False)
    assert made.options.add['/stage_walls/map_server'].startswith('move_base_abstract/map_server ')
    assert not any('stage_offset' in key for key in made.options.param)


def test_defaults_of_stage(tmp_path):
    (tmp_path / 'a.world').write_text('position ( ranger ( ) ) interval_sim 50 position ( localization "odom" )')
    found = worlds.read(str(tmp_path / 'a.world'))
    assert found.interval == 0.05
    assert found.bodies[0] == worlds.Body(lasers=(worlds.Laser((0.0, 0.0, 0.0), 0.0, 0.0, 1, 0.0, 5.0, 1.0),))
    assert found.bodies[1].odom_error == (0.03, 0.03, 0.0, 0.05)


def test_a_sonar_of_stage_is_a_laser_with_one_beam(package):
    write_map(package)
    write_stage(package, '2.0 1.5 0 0')
    made = adopt(package('two.launch', STAGE.format('-g', '', '')))
    assert made.problems == ()
    assert rows(made)['robot_1']['scan_beams'] == 1


def test_names_of_models_count_and_a_robot_alone_has_no_prefix(package):
    write_map(package)
    write_stage(package, '2.0 1.5 0 0')
    assert sorted(rows(adopt(package('two.launch', STAGE.format('-u', '', ''))))) == ['alice', 'bob']
    lonely = WORLD.format(pose='2.0 1.5 0 0', first='0 0 0 0').replace('ranger_robot ( pose [ -', '(')
    package('worlds/two.world', lonely)
    alone = adopt(package('one.launch', STAGE.format('', '', '')))
    assert dict(alone.options.add)['/velocity_robot'] == 'move_base_abstract/velocity_robot'
    assert '/velocity_robot/tf_prefix' not in alone.options.param


def test_a_world_without_a_floor_plan_has_no_walls_which_is_said(package):
    package('worlds/two.world', 'position ( pose [ 1 2 0 0 ] )')
    made = adopt(package('one.launch', STAGE.format('', '', '')))
    assert any('there are no walls: ' in remark for remark in made.remarks)
    assert '/velocity_robot/use_map' not in made.options.param
    assert made.options.param['/velocity_robot/footprint'][0] == [-0.2, -0.2]


def test_with_a_localizer_that_is_left_out_robots_say_where_they_are_in_the_map(package):
    write_map(package, '[-2.0, -1.0, 0.0]')
    write_stage(package, '10.0 20.0 0 0')
    fake = '<node pkg="fake_localization" type="fake_localization" name="fake" ns="robot_0"/>' \
           '<node pkg="map_server" type="map_server" name="map_server" args="$(dirname)/../maps/walls.yaml"/>'
    made = adopt(package('two.launch', STAGE.format('', '', fake)))
    robot = rows(made)['robot_0']
    assert robot['publish_map_frame'] is True and robot['map_topic'] == '/map'
    assert pose(robot) == (1.0 - 10.0, 2.0 - 19.5, math.pi / 2)
    assert robot['stage_offset_x'] == 10.0


def test_real_navigation_stays_and_the_simulator_alone_is_replaced(package, tmp_path, monkeypatch):
    write_map(package)
    path = write_stage(package, '2.0 1.5 0 0')
    hidden = '../../.hidden'  # from tests that look for packages around their files
    monkeypatch.setenv('ROS_PACKAGE_PATH', '{}:{}'.format(os.environ['ROS_PACKAGE_PATH'], tmp_path / '.hidden'))
    for kind in ('move_base', 'amcl'):
        package('{1}/{0}/package.xml'.format(kind, hidden), '<package><name>{}</name></package>'.format(kind))
        package('{1}/{0}/scripts/{0}'.format(kind, hidden), '#!/usr/bin/env python3\nimport rospy\n', 0o755)
    with open(path) as stream:
        text = stream.read().replace('</launch>', '<node pkg="amcl" type="amcl" name="amcl" ns="robot_0"/></launch>')
    made = adopt(package('stage.launch', text), real_navigation=True)
    assert not made.options.real_navigation
    assert list(made.options.replace) == ['map_server/map_server']
    assert made.options.leave_out == ('/stage',)
    assert rows(made)['robot_1']['publish_map_frame'] is False
    assert retries_of(made) == {'robot_0': 0, 'robot_1': 0}  # they would plan at one instant for ever
    for key, value in (('planner_frequency', 1.0), ('max_planning_retries', 3)):
        asked = adopt(package('stage.launch', text), real_navigation=True, param={'/robot_0/move_base/' + key: value})
        assert {name: value for name, value in retries_of(asked).items() if name != 'robot_0' or value == 0} == {
            'robot_1': 0}
    without = adopt(package('stage.launch', text))
    assert list(without.options.replace) == ['map_server/map_server', 'move_base/move_base']
    assert '/robot_0/amcl' in without.options.leave_out and FLEET not in without.options.add
    assert retries_of(without) == {}


def test_navigation_that_is_not_here_is_told_as_a_loss(package):
    write_map(package)
    made = adopt(write_stage(package, '2.0 1.5 0 0'), real_navigation=True)
    assert sum('(move_base/move_base) is left out: this program is not installed here' in one
               for one in made.remarks) == 2


def test_a_driver_is_replaced_with_its_topics(package):
    made = adopt(package('fake.launch', """<launch>
      <group ns="tb3_0"><node pkg="turtlebot3_fake" type="turtlebot3_fake_node" name="fake"/></group>
      <group ns="p3dx"><node pkg="rosaria" type="RosAria" name="aria"><remap from="~cmd_vel" to="/go"/></node></group>
      <node pkg="tf" type="static_transform_publisher" name="m" args="1 2 0 0.5 0 0 map tb3_0/odom 100"/></launch>"""))
    assert made.options.add[FLEET].split()[1:] == ['/p3dx/cmd_vel:=/go', '/p3dx/odom:=/p3dx/aria/pose']
    assert set(made.options.leave_out) >= {'/tb3_0/fake', '/p3dx/aria'}
    assert pose(rows(made)['tb3_0']) == (1.0, 2.0, 0.5)


def test_static_frames_above_the_odometry_stay_and_those_of_the_base_do_not(package):
    made = adopt(package('one.launch', """<launch>{}
      <node pkg="of_a_stranger" type="frames" name="unrelated"/>
      <node pkg="tf" type="static_transform_publisher" name="of_odom" args="0 0 0 0 0 0 world a/odom 50"/>
      <node pkg="tf" type="static_transform_publisher" name="of_base" args="0 0 0 0 0 0 a/odom a/base_link 50"/>
    </launch>""".format(SPAWNED.format('a', 1, 2, 3, TURTLEBOT))))
    said = {line.split()[0]: line for line in (*made.done, *made.remarks) if ' is left out: ' in line}
    assert 'our robots publish this frame themselves' in said['/of_base']
    assert 'our robots' not in said.get('/of_odom', '')


def test_programs_that_ask_for_gazebo_or_for_a_move_base_are_named(package):
    package('scripts/asks.py', '#!/usr/bin/env python3\nimport rospy\nTOPIC = "/gazebo/model_states"\n', 0o755)
    package('scripts/sends.py', '#!/usr/bin/env python3\nfrom move_base_msgs.msg import MoveBaseAction\n')
    made = adopt(package('one.launch', """<launch>{}<node pkg="of_a_stranger" type="asks.py" name="asks"/>
      <node pkg="of_a_stranger" type="sends.py" name="sends"/></launch>""".format(
          SPAWNED.format('a', 1, 2, 3, TURTLEBOT))))
    assert any(line.startswith('/asks names topics or services of Gazebo') for line in made.remarks)
    assert any(line.startswith('/sends has goals for a move_base') and '--add' in line for line in made.remarks)
    assert any('sends.py is no executable file, and is run all the same' in line for line in made.remarks)


def test_the_user_can_have_a_robot_with_goals_or_one_that_nothing_places(package):
    path = package('one.launch', '<launch>{}</launch>'.format(SPAWNED.format('a', 1, 2, 3, TURTLEBOT)))
    made = adopt(path, add={'/a/move_base': 'move_base_abstract/move_base'})
    assert list(made.options.add) == ['/a/move_base']
    empty = package('none.launch', '<launch><node pkg="of_a_stranger" type="x" name="x"/></launch>')
    assert '--add /NAMESPACE/velocity_robot=move_base_abstract/velocity_robot' in adopt(empty).problems[0]
    own = adopt(empty, add={'/r/velocity_robot': 'move_base_abstract/velocity_robot'})
    assert own.problems == () and isinstance(own, adoption.Adopted)


def test_a_world_that_its_author_names_by_a_path_of_his_own_is_taken_from_its_package(package, tmp_path, monkeypatch):
    monkeypatch.setenv('ROS_PACKAGE_PATH', '{}:{}'.format(os.environ['ROS_PACKAGE_PATH'], tmp_path / 'src'))
    package('worlds/two.world', 'include "/home/x/ws/src/of_a_stranger/worlds/robots.inc" rob ( pose [ 1 2 0 0 ] )')
    package('worlds/robots.inc', 'define rob position ( size [ 1 1 1 ] )')
    made = adopt(package('one.launch', """<launch><node pkg="stage_ros" type="stageros" name="s"
      args="/root/catkin_ws/src/of_a_stranger/worlds/two.world"/></launch>"""))
    assert dict(made.options.start) == {'/velocity_robot': (1.0, 2.0, 0.0)}
    assert made.options.param['/velocity_robot/footprint'][0] == [-0.5, -0.5]
    assert any("two.world is taken for Stage's world" in remark for remark in made.remarks)


def test_with_real_navigation_a_localizer_that_is_respawned_takes_part_and_its_guess_is_no_other_place(
        package, tmp_path, monkeypatch):
    monkeypatch.setenv('ROS_PACKAGE_PATH', '{}:{}'.format(os.environ['ROS_PACKAGE_PATH'], tmp_path / '.hidden'))
    package('../../.hidden/amcl/package.xml', '<package><name>amcl</name></package>')
    package('../../.hidden/amcl/scripts/amcl', '#!/usr/bin/env python3\nimport rospy\n', 0o755)
    package('worlds/two.world', 'position ( pose [ 1 2 0 0 ] )')
    made = adopt(package('one.launch', STAGE.format('', '', """<node pkg="amcl" type="amcl" name="amcl" respawn="true">
      <param name="initial_pose_x" value="9.0"/></node>""")), real_navigation=True)
    assert made.options.no_respawn and dict(made.options.start) == {'/velocity_robot': (1.0, 2.0, 0.0)}
    assert not any('could start elsewhere' in remark for remark in made.remarks)
    assert made.options.param['/velocity_robot/publish_map_frame'] is False
    missing = adopt(package('one.launch', STAGE.format('', '', """<node pkg="amcl" type="als_ros" name="amcl"/>""")),
                    real_navigation=True)
    assert missing.options.param['/velocity_robot/publish_map_frame'] is True  # nobody else does


def test_with_real_navigation_a_robot_that_nothing_places_is_there_for_each_move_base(package):
    group = '<group ns="{}"><node pkg="move_base" type="move_base" name="move_base"/></group>'
    path = package('one.launch', '<launch>{}{}</launch>'.format(group.format('a'), group.format('b')))
    made = adopt(path, real_navigation=True)
    assert made.problems == () and sorted(rows(made)) == ['a', 'b']
    assert sum('nothing in the file says what it is' in remark for remark in made.remarks) == 2


def test_several_launch_files_are_one_run_and_all_get_the_arguments(package):
    parser, one = argparse.ArgumentParser(), package('one.launch', '<launch/>')
    two = package('two.launch', '<launch/>')
    assert command_line.files_of(parser, [one, two, 'x:=1']) == [(one, ['x:=1']), (two, ['x:=1'])]
    with pytest.raises(SystemExit):
        command_line.files_of(parser, [one, two, 'not_here.launch'])
