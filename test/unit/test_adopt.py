"""Launch files of others, in the patterns of public packages: what is made of them, and where their robots start."""
import dataclasses
import math
import shlex

import pytest
from roslaunch.core import RLException
from rospkg import ResourceNotFound

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.config.settings import read_settings
from move_base_abstract_ros.launching import adoption, command_line, plan
from move_base_abstract_ros.nodes.launch_run import launched
from strangers_package import adopt, package_fixture, write_map, write_stage  # noqa: F401 - a fixture

OUR_ROBOT = ('move_base/move_base', 'move_base_abstract/move_base')
OUR_MAP = ('map_server/map_server', 'move_base_abstract/map_server')
NAVIGATION = """<launch>
  <arg name="x" default="0.0"/>
  <arg name="y" default="0.0"/>
  <node pkg="move_base" type="move_base" name="move_base" respawn="true">
    <rosparam file="$(find nav_of_nobody)/param/costmap.yaml" command="load" ns="global_costmap"/>
    <remap from="cmd_vel" to="drive"/>
  </node>
  <node pkg="amcl" type="amcl" name="amcl">
    <param name="initial_pose_x" value="$(arg x)"/>
    <param name="initial_pose_y" value="$(arg y)"/>
    <param name="initial_pose_a" value="0.5"/>
  </node>
</launch>
"""
GROUP = """<group ns="{0}">
    <param name="robot_description" command="$(find xacro_of_nobody)/xacro x.urdf"/>
    <node pkg="gazebo_ros" type="spawn_model" name="spawn" args="-urdf -model {0} -x {1} -y {2} -z 0.1 -Y {3}
      -param robot_description"/>
  </group>"""


def test_only_an_error_of_a_launch_file_is_followed_by_what_helps_with_those_of_others():
    hint = '. If the file was written for Gazebo'
    assert hint in launched.with_next(RLException("No such file or directory: 'x.xml'"), 'a.launch', False)
    assert 'Gazebo' not in launched.with_next(RLException("No such file or directory: 'x.xml'"), 'a.launch', True)
    assert hint in launched.with_next(ConfigurationError('/stage publishes /clock itself'), 'a.launch', False)
    of_user = ConfigurationError('nofile: cannot be read: No such file or directory')
    assert launched.with_next(of_user, 'a.launch', False) == str(of_user)
    asks = launched.with_next(ResourceNotFound('x'), 'a.launch', False)
    assert asks.startswith('the package x is not found here; is its workspace sourced? If the file')


def test_robots_of_gazebo_in_groups_start_where_they_are_spawned(package):
    package('nav.launch', NAVIGATION.replace('value="0.5"', 'value="0.0"'))
    path = package('two.launch', """<launch>
      <arg name="model" default="$(env TURTLEBOT3_MODEL)"/>
      <include file="$(find gazebo_ros)/launch/empty_world.launch"><arg name="gui" value="false"/></include>
      {} {}
      <group ns="tb3_0"><include file="$(find of_a_stranger)/launch/nav.launch"/></group>
      <group ns="tb3_1"><include file="$(dirname)/nav.launch"/></group>
      <node pkg="rviz" type="rviz" name="rviz"/>
    </launch>""".format(GROUP.format('tb3_0', '-7.0', '1.5', '1.57'), GROUP.format('tb3_1', '7', '-1', '0')))
    made = adopt(path)
    assert made.problems == ()
    assert made.options.param == {
        '/tb3_0/move_base/tf_prefix': 'tb3_0', '/tb3_1/move_base/tf_prefix': 'tb3_1'}
    assert tuple(made.options.replace.items()) == (OUR_ROBOT,)
    assert set(made.options.leave_out) >= {'/tb3_0/spawn', '/tb3_1/spawn', '/tb3_0/amcl', '/tb3_1/amcl'}
    assert made.options.param == {
        '/tb3_0/move_base/tf_prefix': 'tb3_0', '/tb3_1/move_base/tf_prefix': 'tb3_1'}
    assert sum('/spawn (gazebo_ros/spawn_model) is left out: it puts a model into a simulator that is not there' in line
               for line in made.done) == 2
    missing = [line for line in made.remarks if 'gazebo_ros/launch/empty_world.launch is not here' in line]
    assert len(missing) == 1 and 'two.launch:3' in missing[0]
    assert any("no TURTLEBOT3_MODEL, and 'burger' is taken" in line for line in made.remarks)
    assert any('nav_of_nobody/param/costmap.yaml is not here' in line and 'included at two.launch:' in line
               for line in made.remarks)


def test_a_pose_of_amcl_that_is_not_zero_comes_before_that_of_the_spawner_and_both_are_told(package):
    package('nav.launch', NAVIGATION)
    path = package('one.launch', """<launch>{}<group ns="r"><include file="$(dirname)/nav.launch">
      <arg name="x" value="2.0"/></include></group></launch>""".format(GROUP.format('r', '5', '0', '0')))
    made = adopt(path)
    assert tuple(made.options.start.items()) == (('/r/move_base', (2.0, 0.0, 0.5)),)
    assert any('could start elsewhere: (5, 0, 0) of the spawner /r/spawn' in line
               and '--start /r/move_base=5,0,0' in line for line in made.remarks)


@pytest.mark.parametrize(('arguments', 'expected'), [((), (0.0, 0.0, 0.0)), (('far:=true', 'x:=3'), (3.0, 9.0, 0.0))])
def test_arguments_and_conditions_count(package, arguments, expected):
    path = package('one.launch', """<launch>
      <arg name="far" default="false"/> <arg name="x" default="0.0"/>
      <node pkg="move_base" type="move_base" name="move_base"/>
      <node pkg="amcl" type="amcl" name="amcl">
        <param name="initial_pose_x" value="$(arg x)"/>
        <param name="initial_pose_y" value="$(eval 3 * 3)" if="$(arg far)"/>
        <param name="initial_pose_y" value="0" unless="$(arg far)"/>
      </node></launch>""")
    assert tuple(adopt(path, *arguments).options.start.items()) == (('/move_base', expected),)


def test_robots_of_stage_start_in_the_frame_of_the_map(package):
    write_map(package, '[-2.0, -1.0, 0.0]')
    made = adopt(write_stage(package, '10.0 20.0 0 0'))  # its lower left corner (8, 18.5) is the map's (-2, -1)
    assert tuple(made.options.start.items()) == (('/robot_0/move_base', (1.0 - 10.0, 2.0 - 19.5, math.pi / 2)),
                                  ('/robot_1/move_base', (-1.0 - 10.0, 1.0 - 19.5, math.pi)))
    assert ('/robot_0/move_base/stage_offset_x', 10.0) in made.options.param.items()
    assert ('/robot_1/move_base/stage_offset_y', 19.5) in made.options.param.items()
    assert tuple(made.options.replace.items()) == (OUR_MAP, OUR_ROBOT)


def test_a_floor_plan_that_is_turned_turns_the_places_too(package):
    write_map(package)
    made = adopt(write_stage(package, '-1.5 2.0 0 90.0', first='-1.0 3.0 0 90.0'))
    assert [*made.options.start.items()][0] == ('/robot_0/move_base', (3.0, 1.0, 0.0))


def test_fake_localization_says_where_the_map_lies_if_no_map_is_served(package):
    path = write_stage(package, '0 0 0 0')
    with open(path) as stream:
        text = stream.read().replace('</launch>', """<node pkg="fake_localization" type="fake_localization" name="fake">
      <param name="delta_x" value="3.0"/><param name="delta_y" value="1.0"/></node></launch>""")
    made = adopt(package('stage.launch', text))
    assert [*made.options.start.items()][0] == ('/robot_0/move_base', (-2.0, 1.0, math.pi / 2))
    assert any("the map's frame is at (3, 1, 0) in Stage's world, by delta_* of fake_localization" in line
               for line in made.done)


def test_poses_in_a_mapping_count_too(package):
    path = package('one.launch', """<launch><node pkg="move_base" type="move_base" name="move_base"/>
      <node pkg="amcl" type="amcl" name="amcl"><rosparam>{initial_pose: {x: 4.0, y: 2, yaw: 0.5}}</rosparam></node>
    </launch>""")
    assert tuple(adopt(path).options.start.items()) == (('/move_base', (4.0, 2.0, 0.5)),)


def test_the_origin_of_a_floor_plan_moves_its_middle(package):
    write_map(package)
    made = adopt(write_stage(package, '0 0 0 0 ] origin [ 2.0 1.5 0 0'))
    assert [*made.options.start.items()][0] == ('/robot_0/move_base', (1.0, 2.0, math.pi / 2))


def test_the_drawn_part_of_an_image_is_what_stage_stretches(package):
    package('maps/walls.yaml', '')
    row = ' '.join(['255'] * 10 + ['0'] * 40 + ['255'] * 10)
    empty = ' '.join(['255'] * 60)
    package('maps/walls.pgm', 'P2\n60 50\n255\n{}\n'.format('\n'.join([empty] * 15 + [row] * 30 + [empty] * 5)))
    package('maps/walls.yaml', 'image: walls.pgm\nresolution: 0.1\norigin: [0.0, 0.0, 0.0]\nnegate: 0\n'
            'occupied_thresh: 0.65\nfree_thresh: 0.196\n')
    made = adopt(write_stage(package, '2.0 1.5 0 0'))  # what is drawn begins 1 m and 0.5 m within the map
    assert [*made.options.start.values()][0][:2] == (2.0, 2.5)


def test_a_map_that_is_not_the_floor_plans_is_said_and_places_stay_as_they_are(package):
    write_map(package, columns=50)
    made = adopt(write_stage(package, '2.0 1.5 0 0'))
    assert [*made.options.start.items()][0] == ('/robot_0/move_base', (1.0, 2.0, math.pi / 2))
    assert any('the floor plan is 4 m x 3 m, the map 5 m x 3 m' in line and 'stage.launch:3' in line
               for line in made.remarks)


def test_a_navigation_that_is_not_installed_is_a_robot_with_the_pose_handed_to_its_localizer(package):
    path = package('one.launch', """<launch>
      <include file="$(find nav_of_nobody)/launch/includes/move_base.launch.xml"/>
      <include file="$(find nav_of_nobody)/launch/includes/amcl.launch.xml">
        <arg name="initial_pose_x" value="2.0"/><arg name="initial_pose_y" value="-3"/>
        <arg name="scan_topic" value="scan"/></include>
    </launch>""")
    made = adopt(path)
    assert made.options.add == {'/move_base': 'move_base_abstract/move_base'}
    assert tuple(made.options.start.items()) == (('/move_base', (2.0, -3.0, 0.0)),)
    assert made.problems == ()


def test_nodes_of_other_machines_run_here(package):
    path = package('far.launch', """<launch><machine name="robot" address="192.0.2.1" env-loader="/x"/>
      <node pkg="move_base" type="move_base" name="move_base" machine="robot"/>
      <node pkg="amcl" type="amcl" name="amcl" machine="of_nobody"/></launch>""")
    made = adopt(path)
    assert made.problems == () and made.options.tolerant
    with pytest.raises(Exception, match='unknown machine'):
        plan.read([(path, [])])


def test_a_script_that_publishes_the_clock_cannot_work_and_a_clock_is_left_out(package):
    program = '#!/usr/bin/env python3\nimport rospy\nrospy.Publisher("/clock", rospy.AnyMsg)\n'
    other = 'import rospy\nfrom rosgraph_msgs.msg import Clock\nTOPIC = "/clock"\nrospy.Publisher(TOPIC, Clock)\n'
    package('scripts/world.py', '#!/usr/bin/env python3\n' + other, 0o755)
    package('scripts/wall.py', '#!/usr/bin/env python3\n' + other.replace('(TOPIC', '("wall"'), 0o755)
    package('scripts/fake_clock.py', program, 0o755)
    path = package('one.launch', """<launch>
      <node pkg="move_base" type="move_base" name="move_base"/>
      <node pkg="of_a_stranger" type="world.py" name="world"/> <node pkg="of_a_stranger" type="wall.py" name="wall"/>
      <node pkg="of_a_stranger" type="fake_clock.py" name="ticker"/>
      <node pkg="rosbag" type="play" name="player" args="--clock x.bag"/></launch>""")
    made = adopt(path)
    assert len(made.problems) == 1
    assert '/world (of_a_stranger/world.py) publishes /clock' in made.problems[0]
    assert 'one.launch:3' in made.problems[0] and '--leave-out /world' in made.problems[0]
    assert {'/ticker', '/player'} <= set(made.options.leave_out)
    assert adopt(path, leave_out=('/world',)).problems == ()


def test_robots_that_would_end_with_an_error_are_named_and_those_of_a_simulator_are_ours(package):
    path = package('three.launch', """<launch>
      <group ns="a"><node pkg="move_base" type="move_base" name="move_base">
        <param name="controller_frequency" value="fast"/></node></group>
      <group ns="b"><node pkg="move_base_abstract" type="move_base" name="move_base">
        <param name="backend" value="stage_ros"/></node></group>
      <group ns="c"><node pkg="move_base_abstract" type="move_base_abstract_actionserver" name="move_base"
        args="c stage_ros 2.0 4.0 5.0 0.5 0.1"/></group></launch>""")
    made = adopt(path)
    assert len(made.problems) == 1
    assert '/a/move_base would end with an error' in made.problems[0] and 'three.launch:2' in made.problems[0]
    assert ('/b/move_base/backend', 'builtin') in made.options.param.items()
    assert made.options.node_args == {'/c/move_base': 'c builtin 2.0 4.0 5.0 0.5 0.1'}



def test_what_cannot_start_here_is_left_out_and_told(package):
    package('scripts/old.py', '#!/usr/bin/env python\nprint "old"\n', 0o755)
    package('scripts/needs.py', '#!/usr/bin/env python3\nimport rospy\nfrom of_a_stranger.msg import Task\n', 0o755)
    package('scripts/good.py', '#!/usr/bin/env python3\nimport os.path\nfrom std_msgs.msg import String\n', 0o755)
    package('scripts/shell', '#!/usr/bin/env shell_of_nobody\n', 0o755)
    package('scripts/two.py', '#!/usr/bin/env python_of_nobody\nimport rospy\n', 0o755)  # takes part, by our Python
    path = package('one.launch', """<launch><node pkg="move_base" type="move_base" name="move_base"/>
      <node pkg="of_a_stranger" type="shell" name="shell"/> <node pkg="of_a_stranger" type="two.py" name="two"/>
      <node pkg="of_a_stranger" type="old.py" name="old"/> <node pkg="of_a_stranger" type="needs.py" name="needs"/>
      <node pkg="of_a_stranger" type="good.py" name="good"/> <node pkg="of_a_stranger" type="not_built" name="cpp"/>
    </launch>""")
    made = adopt(path)
    assert made.options.leave_out == ('/shell', '/old', '/needs', '/cpp')
    text = '\n'.join(made.remarks)
    assert 'it is a program for shell_of_nobody, which is not here' in text
    assert 'it is not written for this Python (old.py, line 2' in text
    assert 'it imports of_a_stranger.msg (line 3), which is not here' in text
    assert '/cpp (of_a_stranger/not_built) is left out: this program is not installed here; build its package' in text


def test_a_world_of_a_package_that_is_not_here_is_told_by_its_name(package):
    line, = [line for line in adopt(package('one.launch', """<launch>
      <node pkg="stage_ros" type="stageros" name="stage" args="$(find of_nobody)/two.world"/>
      <node pkg="move_base" type="move_base" name="move_base"/></launch>""")).remarks if 'two.world' in line]
    assert 'the world file cannot be read: of_nobody/two.world: No such file or directory (' in line


def test_places_that_nobody_says_and_robots_at_one_place_are_told(package):
    path = package('two.launch', """<launch>
      <group ns="a"><node pkg="move_base" type="move_base" name="move_base"/></group>
      <group ns="b"><node pkg="move_base" type="move_base" name="move_base"/></group></launch>""")
    text = '\n'.join(adopt(path).remarks)
    assert '/a/move_base starts at (0, 0, 0): the file gives no place; --start /a/move_base=X,Y,YAW gives one' in text
    assert '/a/move_base and /b/move_base start at one place, (0, 0)' in text


def test_a_file_without_a_robot_cannot_work(package):
    made = adopt(package('none.launch', '<launch><param name="a" value="1"/></launch>'))
    assert len(made.problems) == 1 and '--add /NAMESPACE/move_base=move_base_abstract/move_base' in made.problems[0]


def test_the_environment_that_a_package_would_have_set_counts(package):
    package('env-hooks/1.sh.em', ': ${OF_A_STRANGER_X:=`rospack find of_a_stranger`/maps}\n')
    path = package('one.launch', """<launch><node pkg="move_base" type="move_base" name="move_base"/>
      <arg name="of" default="of_nobody"/><param name="joined" value="$(eval find(of) + '/x')"/>
      <param name="own" value="$(eval find('of_a_stranger'))"/>
      <param name="folder" value="$(env OF_A_STRANGER_X)"/></launch>""")
    config = plan.read([(path, [])], True)
    assert config.params['/joined'].value == '/not_installed/of_nobody/x'
    assert config.params['/own'].value.endswith('/src/of_a_stranger')
    assert config.params['/folder'].value.endswith('/of_a_stranger/maps')


def test_the_command_line_says_the_same(package):
    write_map(package)
    path = write_stage(package, '10.0 20.0 0 0')
    _parser, options = launched.read_words(['--adopt', '--until', '9', path])
    made = adoption.adopt(plan.read([(path, [])], True), plan.launch_options(options.run), read_settings)
    typed = command_line.typed('lockstep_launch', options.one, made.options, options.command)
    _parser, options = launched.read_words(shlex.split(typed)[3:])
    assert dataclasses.replace(plan.launch_options(options.run), is_told=True) == made.options
    assert all(word in typed for word in ('--tolerant', '--start', '--param', '--replace', '--until 9'))



def test_what_was_asked_for_stays(package):
    path = package('one.launch', """<launch><node pkg="move_base" type="move_base" name="move_base"/>
      <node pkg="amcl" type="amcl" name="amcl"><param name="initial_pose_x" value="4"/></node></launch>""")
    made = adopt(path, start={'/move_base': (1.0, 1.0, 1.0)}, onlooker=('/amcl',))
    assert tuple(made.options.start.items()) == (('/move_base', (1.0, 1.0, 1.0)),)
    assert made.options.leave_out == ()


@pytest.mark.parametrize('words', [['--start', '/a=1,2'], ['--start', 'a'], ['--param', 'x'], ['--add', 'a=b'],
                                   ['--start', '/a=1,2,nan']])
def test_options_that_say_nothing_are_refused(words):
    with pytest.raises(SystemExit):
        launched.read_words([*words, 'x.launch'])


def test_a_robot_that_is_not_there_cannot_start_anywhere(package):
    path = package('one.launch', '<launch><node pkg="move_base_abstract" type="move_base" name="move_base"/></launch>')
    with pytest.raises(ConfigurationError, match='--start /b: the launch file has no node of this name; it has /m'):
        plan.plan_of(plan.read([(path, [])]), plan.LaunchOptions(start={'/b': (0.0, 0.0, 0.0)}))


@pytest.mark.parametrize(('prefix', 'is_tolerant', 'no_displays', 'expected'), [
    ('xterm -hold -e', False, 'there is no screen', "'xterm -hold -e': it only displays, and there is no screen"),
    ('no_such_terminal -e', True, '', "'no_such_terminal -e': it is not here"), ('nice -n 2', True, 'no screen', ''),
    ('python', False, '', '')])
def test_a_launch_prefix_that_cannot_be_seen_or_is_not_here_is_left_out_and_told(package, prefix, is_tolerant,
                                                                               no_displays, expected):
    package('scripts/a.py', '#!/usr/bin/env python3\nimport rospy\n', 0o755)
    path = package('one.launch', '<launch><node pkg="of_a_stranger" type="a.py" name="a" launch-prefix="{}"/>'
                   '</launch>'.format(prefix))
    options = plan.LaunchOptions(tolerant=is_tolerant, no_displays=no_displays)
    made = plan.plan_of(plan.read([(path, [])], True), options)
    assert made.notes == ['/a is started without its launch-prefix ' + expected] * bool(expected)
    assert [prefix.partition(' ')[0] in node.launch_prefix for node in made.config.nodes if node.name == 'a'] == [
        not expected]


@pytest.mark.parametrize(('attributes', 'problem'), [
    ('launch-prefix="no_such_terminal -e"', "/a: its launch-prefix starts 'no_such_terminal', which is not here"),
    ('launch-prefix="bash -c \'x"', '/a: launch-prefix: got "bash -c \'x", which is not a list of words: No closing'),
    ('args="--x \'open"', '/a: its args "--x \'open" are no list of words: No closing quotation')])
def test_a_node_whose_command_cannot_be_made_ends_the_run_before_it_begins(package, attributes, problem):
    package('scripts/a.py', '#!/usr/bin/env python3\nimport rospy\n', 0o755)
    path = package('one.launch', '<launch><node pkg="of_a_stranger" type="a.py" name="a" {}/></launch>'.format(
        attributes))
    config = plan.read([(path, [])], True)
    with pytest.raises(ConfigurationError) as raised:
        plan.plan_of(config, plan.LaunchOptions())
    assert problem in str(raised.value)


def test_no_guess_by_a_part_of_a_name_has_precedence_over_a_program_that_is_here(package):
    for name in ('kobuki_fleet', 'team_slam', 'laser_tag'):
        package('../{}/package.xml'.format(name), '<package><name>{}</name></package>'.format(name))
        for program, more in (('coordinator.py', ''), ('keys.py', 'import termios\n')):
            package('../{}/scripts/{}'.format(name, program), '#!/usr/bin/env python3\nimport rospy\n' + more, 0o755)
    path = package('one.launch', """<launch><node pkg="move_base" type="move_base" name="move_base"/>
      <node pkg="kobuki_fleet" type="coordinator.py" name="a" args="-x 30 -y 20" respawn="true"/>
      <node pkg="team_slam" type="coordinator.py" name="b"/> <node pkg="laser_tag" type="coordinator.py" name="c"/>
      <node pkg="kobuki_fleet" type="keys.py" name="keys"/> <node pkg="kobuki_fleet" type="not_built" name="task"/>
      <node pkg="laser_of_nobody" type="filter" name="filter"/>
      <node pkg="joy" type="joy_node" name="joy"/></launch>""")
    made = adopt(path)
    assert made.options.leave_out == ('/keys', '/task', '/filter', '/joy')
    assert made.options.no_respawn and tuple(made.options.start.items()) == ()
    for name in 'abc':
        assert sum(line.startswith('/{} ('.format(name)) and 'stays, because its program is here' in line
                   and '--leave-out /{} '.format(name) in line for line in made.remarks) == 1
    assert any('/task (kobuki_fleet/not_built) is left out: this program is not installed here; build its package'
               in line for line in made.remarks)
    assert any('/keys (kobuki_fleet/keys.py) is left out' in line and '--participant /keys keeps it' in line
               for line in made.done)
    assert adopt(path, participant=('/keys',)).options.leave_out == ('/task', '/filter', '/joy')


def test_a_second_mention_of_a_place_is_the_robots_place_too(package):
    node = '<node pkg="{0}" type="{0}" name="{0}"><param name="initial_pose_x" value="{1}"/></node>'
    other = node.replace('value="{1}"', 'value="{2}"').replace('name="{0}">', 'name="own_{0}">')
    robot = '<group ns="{3}"><node pkg="move_base" type="move_base" name="move_base"/>' + node + other + '</group>'
    made = adopt(package('two.launch', '<launch>{}{}</launch>'.format(
        robot.format('amcl', 2, 2, 'r1'), robot.format('amcl', 5, 7, 'r2'))))
    assert tuple(made.options.start.items()) == (('/r1/move_base', (2.0, 0.0, 0.0)), ('/r2/move_base', (5.0, 0.0, 0.0)))
    assert not any('is not a robot of this run' in line for line in made.remarks)
    assert ['/r2/move_base could start elsewhere: (7, 0, 0)' in line for line in made.remarks].count(True) == 1


def test_a_nodelet_that_stands_alone_and_is_not_here_is_left_out(package):
    made = adopt(package('one.launch', """<launch><node pkg="move_base" type="move_base" name="move_base"/>
      <node pkg="nodelet" type="nodelet" name="sync" args="standalone of_nobody/sync"/></launch>"""))
    assert made.options.leave_out == ('/sync',)


def test_a_program_that_reads_a_keyboard_is_left_out_whatever_its_name(package):
    package('scripts/buttons.py', '#!/usr/bin/env python3\nimport rospy\nimport sys, select, termios, tty\n', 0o755)
    path = package('one.launch', """<launch><node pkg="move_base" type="move_base" name="move_base"/>
      <node pkg="of_a_stranger" type="buttons.py" name="buttons"/></launch>""")
    assert adopt(path).options.leave_out == ('/buttons',)
    assert adopt(path, participant=('/buttons',)).options.leave_out == ()
