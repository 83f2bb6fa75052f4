"""Frames in launch files of others: which of them robots have for themselves, and in which they start."""
import math

import pytest

from strangers_package import adopt, package_fixture  # noqa: F401 - a fixture

SPAWNED = """<group ns="{0}">
    <node pkg="gazebo_ros" type="spawn_model" name="spawn"
          args="-urdf -model {0} -x {1} -y {2} -param robot_description"/>
    <node pkg="move_base" type="move_base" name="move_base">
      <param name="global_costmap/global_frame" value="{0}/map"/></node>
  </group>"""


@pytest.mark.parametrize('words', [
    '0 0 0 0 0 0 map r1/odom', '0 0 0 0 0 0 map r1/odom 100', '0 0 0 0 0 0 1 map r1/odom',
    '0 0 0 0 0 0 1 /map /r1/odom 9'])
def test_static_frames_of_odometry_are_left_out_however_they_are_written(package, words):
    made = adopt(package('one.launch', """<launch><group ns="r1">
      <node pkg="move_base" type="move_base" name="move_base"/>
      <node pkg="tf" type="static_transform_publisher" name="odometry" args="{}"/></group></launch>""".format(words)))
    assert made.options.leave_out == ('/r1/odometry',)


def test_robots_whose_maps_have_frames_of_their_own_start_in_these(package):
    frame = '<node pkg="tf" type="static_transform_publisher" name="{}" args="{} /{} /{} 20"/>'
    made = adopt(package('three.launch', '<launch>{}{}{}{}{}</launch>'.format(
        SPAWNED.format('r1', 0, 0), SPAWNED.format('r2', 0, -0.8), SPAWNED.format('r3', 1, 2),
        frame.format('a', '0 -0.8 0 0 0 0', 'r1/map', 'r2/map'),
        frame.format('b', '1 1 0 1.5707963267948966 0 0', 'r1/map', 'r3/map'))))
    assert made.options.start['/r1/move_base'] == made.options.start['/r2/move_base'] == (0.0, 0.0, 0.0)
    assert made.options.start['/r3/move_base'] == pytest.approx((1.0, 0.0, -math.pi / 2))
    assert any(line.startswith('/r2/move_base starts at (0, 0, 0) in r2/map: (0, -0.8, 0) of the spawner')
               for line in made.done)
    assert not any('start at one place' in line for line in made.remarks)


@pytest.mark.parametrize(('owner', 'expected'), [('of_a_stranger', (0.0, 0.0, 0.0)), ('amcl', (0.0, -2.0, 0.0))])
def test_a_place_that_a_program_sets_in_the_simulator_is_one_of_its_world(package, owner, expected):
    robot = """<group ns="{0}"><node pkg="move_base" type="move_base" name="move_base">
        <param name="global_costmap/global_frame" value="{0}/map"/></node>
      <node pkg="{1}" type="setter" name="setter"><param name="initial_pose_y" value="{2}"/></node></group>
      <node pkg="tf" type="static_transform_publisher" name="f{0}" args="0 {2} 0 0 0 0 world {0}/map 9"/>"""
    made = adopt(package('two.launch', '<launch>{}{}</launch>'.format(
        robot.format('a', owner, 1), robot.format('b', owner, -2))))
    assert made.options.start['/b/move_base'] == expected


def test_robots_whose_bases_have_prefixes_do_not_share_the_frame_of_their_odometry(package):
    robot = """<node pkg="move_base" type="move_base" name="move_base" ns="{0}">
      <param name="global_costmap/robot_base_frame" value="{0}/base_link"/>
      <param name="local_costmap/global_frame" value="{1}"/></node>"""
    made = adopt(package('two.launch', '<launch>{}{}</launch>'.format(
        robot.format('a', '/map'), robot.format('b', 'b/wheels'))))
    assert made.options.param == {'/a/move_base/odom_frame': 'a/odom'}


def test_the_prefix_that_the_user_gives_to_a_namespace_stays(package):
    group = '<group ns="{}"><node pkg="move_base" type="move_base" name="move_base"/></group>'
    path = package('two.launch', '<launch>{}{}</launch>'.format(group.format('a'), group.format('b')))
    made = adopt(path, param={'/a/tf_prefix': 'x'})
    assert made.options.param == {'/a/tf_prefix': 'x', '/b/move_base/tf_prefix': 'b'}


@pytest.mark.parametrize(('bases', 'expected'), [
    (('left_base', 'right_base'), {'/a/move_base/odom_frame': 'a/odom', '/b/move_base/odom_frame': 'b/odom'}),
    (('b_base', 'b_base'), {'/a/move_base/tf_prefix': 'a', '/b/move_base/tf_prefix': 'b'})])
def test_robots_that_would_share_a_frame_do_not(package, bases, expected):
    robot = """<node pkg="move_base" type="move_base" name="move_base" ns="{}">
      <param name="global_costmap/robot_base_frame" value="{}"/></node>"""
    path = package('two.launch', '<launch>{}{}</launch>'.format(*map(robot.format, 'ab', bases)))
    assert adopt(path).options.param == expected
