"""Start poses that nobody reads are told; experiments adopt; what to type after an error."""
import os

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract_experiments.description import ingredients, launch_files
from move_base_abstract_ros.launching import plan, start_poses
from move_base_abstract_ros.nodes.launch_run import launched
from strangers_package import adopt, package_fixture, write_map, write_stage  # noqa: F401 - a fixture

LOST = """<launch>
  <group ns="a"><node pkg="move_base_abstract" type="move_base" name="move_base"/>
    <node pkg="amcl" type="amcl" name="amcl"><param name="initial_pose_x" value="3"/></node></group>
  <group ns="b"><node pkg="move_base_abstract" type="move_base" name="move_base"/></group>
  <group ns="c"><node pkg="move_base_abstract" type="move_base" name="move_base"/></group>
  <group ns="d"><node pkg="move_base_abstract" type="move_base" name="move_base">{}</node></group>
  {}
</launch>"""


def notes_of(path):
    """Return what is told of start poses without --adopt."""
    config = plan.read([(path, [])])
    return start_poses.notes_of(config, start_poses.said_by(config))


def test_places_that_nobody_reads_are_told_without_adopting(package):
    first, second = notes_of(package('four.launch', LOST.format('<param name="start_x" value="1"/>', '')))
    assert '/a/move_base starts at (0, 0, 0), and no node reads (3, 0, 0) of /a/amcl/initial_pose_*' in first
    assert '--start /a/move_base=3,0,0' in first
    assert second == '/b/move_base and /c/move_base start at one place, (0, 0): --start NODE=X,Y,YAW sets another'


def test_robots_that_are_placed_are_not_told(package):
    text = LOST.format('', '').replace(
        'name="move_base"/>', 'name="move_base"><param name="start_y" value="0"/></node>')
    assert notes_of(package('four.launch', text)) == []


OTHERWISE = """<launch>
  <group ns="a"><node pkg="{0}" type="move_base" name="move_base"><param name="start_x" value="3"/></node></group>
  <group ns="b"><node pkg="{0}" type="move_base" name="move_base" args="_start_x:=6.0 _start_y:=1"/></group>
  <group ns="c"><node pkg="{0}" type="move_base" name="move_base"/></group>
  <group ns="d"><node pkg="move_base_abstract" type="move_base_abstract_actionserver" name="robot"
    args="d builtin 1.0 3.0 4"/></group>
  <node pkg="amcl" type="amcl" name="amcl" ns="d"><param name="initial_pose_x" value="9"/></node>
</launch>"""


def test_places_by_parameters_arguments_and_options_count_and_none_is_told_to_be_zero(package):
    path = package('four.launch', OTHERWISE.format('move_base_abstract'))
    for given in ({'param': {'/c/move_base/start_y': 8.0}}, {'start': {'/c/move_base': (5.0, 8.0, 0.0)}},
                  {'param': {'/c/move_base': {'start_x': 1.0}}}):
        made = adopt(path, **given)
        assert [line for line in made.remarks if 'start' in line and 'd/amcl' not in line] == []
        assert made.options.start == given.get('start', {})  # the arguments of the original package's program count
    adopted = adopt(package('of_upstream.launch', OTHERWISE.format('move_base')))
    assert [line for line in adopted.remarks if 'start' in line] == [
        '/c/move_base starts at (0, 0, 0): the file gives no place; --start /c/move_base=X,Y,YAW gives one']
    same = adopt(path, param={'/c/move_base/start_x': 6, '/c/move_base/start_y': 1})
    assert [line for line in same.remarks if 'one place' in line] == [
        '/b/move_base and /c/move_base start at one place, (6, 1): --start NODE=X,Y,YAW sets another']
    assert not [line for line in notes_of(path) if 'one place' in line]


def test_a_program_that_may_place_robots_later_is_named_with_the_place_zero(package, monkeypatch):
    program = package('scripts/place.py', '#!/usr/bin/env python3\nimport rospy\nrospy.Publisher("/a/initialpose")\n',
                      0o755)
    folder = os.path.dirname(os.path.dirname(program))
    monkeypatch.setenv('ROS_PACKAGE_PATH', '{}:{}'.format(folder, os.environ['ROS_PACKAGE_PATH']))
    path = package('two.launch', """<launch>
      <group ns="a"><node pkg="move_base_abstract" type="move_base" name="move_base"/></group>
      <group ns="b"><node pkg="move_base_abstract" type="move_base" name="move_base"/></group>
      <node pkg="of_a_stranger" type="place.py" name="placer"/></launch>""")
    unless = ', unless /placer sets another place (it names initialpose): '
    assert ['(0, 0)' + unless in note for note in notes_of(path)] == [True]
    assert [(line.count(unless), '(0, 0' in line) for line in adopt(path).remarks] == [(1, True)] * 3


def test_of_several_programs_that_may_place_a_robot_the_one_in_its_namespace_is_named(package):
    package('scripts/place.py', '#!/usr/bin/env python3\nimport rospy\nrospy.Publisher("initialpose")\n', 0o755)
    robot = '<node pkg="move_base" type="move_base" name="move_base"/>'
    made = adopt(package('two.launch', """<launch>
      <group ns="a">{0}<node pkg="of_a_stranger" type="place.py" name="place"/></group> <group ns="b">{0}
        <node pkg="rostopic" type="rostopic" name="pub" args="pub -l initialpose geometry_msgs/Pose2D {{}}"/></group>
    </launch>""".format(robot)))
    assert [line.partition(' sets')[0] for line in made.remarks if 'the file gives no place' in line] == [
        '/a/move_base starts at (0, 0, 0), unless /a/place', '/b/move_base starts at (0, 0, 0), unless /b/pub']


@pytest.mark.parametrize(('parameters', 'is_told'), [('', True), ('<param name="stage_offset_x" value="0.0"/>', False)])
def test_who_places_robots_in_the_world_of_stage_is_told_where_no_offset_is_said(package, monkeypatch, parameters,
                                                                               is_told):
    program = package('scripts/place.py', '#!/usr/bin/env python3\nimport rospy\nrospy.Publisher("cmd_pose")\n', 0o755)
    folder = os.path.dirname(os.path.dirname(program))
    monkeypatch.setenv('ROS_PACKAGE_PATH', '{}:{}'.format(folder, os.environ['ROS_PACKAGE_PATH']))
    notes = notes_of(package('one.launch', """<launch>
      <node pkg="move_base_abstract" type="move_base" name="move_base">{}</node>
      <node pkg="of_a_stranger" type="place.py" name="placer"/></launch>""".format(parameters)))
    assert len(notes) == is_told
    assert all('/placer may place robots by cmd_pose' in note and '/move_base/stage_offset_x=X' in note
               for note in notes)


@pytest.mark.parametrize(('text', 'expected'), [
    ('<launch><arg name="a"/><arg name="b"/><arg name="c" default="1"/><param name="p" value="$(arg a)"/></launch>',
     'Behind the file: a:=VALUE b:=VALUE'),
    ('<launch><include file="$(find of_nobody)/x.launch"/></launch>', 'the package of_nobody is not found here'),
    ('<launch><include file="/of/nobody/x.launch"/></launch>', '--adopt leaves out what is not here')])
def test_what_cannot_be_read_says_what_to_type_next(package, text, expected):
    path = package('one.launch', text)
    with pytest.raises(Exception, match='.') as raised:
        plan.read([(path, [])])
    assert expected in launched.with_next(raised.value, path, False)


def test_an_experiment_adopts_too_and_what_the_file_says_of_places_makes_a_trial_another_one(package):
    write_map(package)
    path = write_stage(package, '2.0 1.5 0 0')
    made = []
    for first in ('1.0 2.0 0 90.0', '1.0 2.5 0 90.0'):
        write_stage(package, '2.0 1.5 0 0', first=first)
        config = launch_files.read([(path, [])], is_tolerant=True)
        assert launch_files.adopted(config, plan.LaunchOptions()).leave_out == ('/stage',)
        ingredients.forget()
        made.append(ingredients._of_launch(path, (), os.path.dirname(path), ('--adopt',))[ingredients.PARAMETERS])
    assert made[0] != made[1]


def test_an_experiment_of_a_file_that_cannot_work_says_why(package):
    path = package('none.launch', '<launch/>')
    with pytest.raises(ConfigurationError, match='adopt: this file has no robot'):
        launch_files.adopted(launch_files.read([(path, [])], is_tolerant=True), plan.LaunchOptions())
