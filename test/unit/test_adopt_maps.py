"""A map in a launch file of others counts, as with upstream's planner; parameters without an effect are named."""
import math
import os
from types import SimpleNamespace

import pytest
from roslaunch.core import Node

from move_base_abstract.common.geometry import Pose2D
from move_base_abstract.common.options import of_words
from move_base_abstract.lockstep.run_options import RunOptions
from move_base_abstract_ros.adopting import floors
from move_base_abstract_ros.launching import plan, started
from strangers_package import adopt, package_fixture, write_map, write_stage  # noqa: F401 - a fixture

SERVER = '<node pkg="map_server" type="map_server" name="map_server" args="$(dirname)/../maps/walls.yaml"/>'
FILE = """<launch>
  {server}
  <node pkg="amcl" type="amcl" name="amcl">
    <param name="initial_pose_x" value="{x}"/><param name="initial_pose_y" value="1.5"/>
    <param name="initial_cov_xx" value="0.25"/>
  </node>
  <node pkg="move_base" type="move_base" name="move_base">
    <rosparam>{{{param}}}</rosparam>
  </node>
</launch>"""
GRID = {'/move_base/use_map': True, '/move_base/routes': 'grid', '/move_base/leave_obstacles': True}


@pytest.fixture(name='file')
def file_fixture(package):
    """Return write(**parts of FILE): the path of a launch file with a map of 4 m x 3 m."""
    write_map(package)
    return lambda server=SERVER, x=1.0, param='': package('one.launch', FILE.format(server=server, x=x, param=param))


def remarks(made, words):
    return [line for line in made.remarks if words in line]


def test_a_map_server_in_the_file_means_that_robots_go_around_its_map_and_a_note_says_how_to_undo_it(file):
    made = adopt(file(param="""robot_radius: 0.2, base_local_planner: dwa_local_planner/DWAPlannerROS,
      DWAPlannerROS: {max_vel_x: 0.5, xy_goal_tolerance: 0.25, yaw_goal_tolerance: 0.3},
      global_costmap: {inflation_radius: 0.15, track_unknown_space: true},
      NavfnROS: {allow_unknown: false, default_tolerance: 0.4}"""))
    assert made.options.param == GRID
    line, = remarks(made, 'uses the map of')
    assert line.startswith(
        '/move_base uses the map of /map_server, as upstream would (routes: grid, radius 0.206 m, inflation 0.15 m, '
        'unknown cells not free, tolerances 0.25 m and 0.3 rad, or 0.4 m beside a goal): ways lead around what it ')
    assert line.endswith('--param /move_base/use_map=false undoes it, --param use_map=false for all robots')


FLEX = """<launch>{server}
  <node pkg="amcl" type="amcl" name="amcl"><param name="initial_pose_x" value="2.0"/></node>
  <node pkg="mbf_costmap_nav" type="mbf_costmap_nav" name="move_base_flex"><rosparam>
    {{controllers: [{{name: eband, type: x/EBandPlannerROS}}, {{name: teb, type: x/TebLocalPlannerROS}}],
      planners: [{{name: GlobalPlanner, type: global_planner/GlobalPlanner}}], GlobalPlanner: {{allow_unknown: false}},
      teb: {{max_vel_x: 0.7, xy_goal_tolerance: 0.15}},
      global_costmap: {{robot_radius: 0.3, track_unknown_space: true}}}}</rosparam></node>
  {relay}</launch>"""
RELAY = '<node pkg="mbf_costmap_nav" type="move_base_legacy_relay.py" name="move_base">{}</node>'.format(
    '<param name="base_local_planner" value="x/teb"/>')


@pytest.mark.parametrize(('relay', 'local'), [(RELAY, 'teb'), ('', 'eband')])
def test_move_base_flex_is_a_robot_with_its_own_costmaps_and_the_planners_of_its_relay(package, relay, local):
    write_map(package)
    path = package('flex.launch', FLEX.format(server=SERVER, relay=relay))
    made = adopt(path)
    assert not made.problems and made.options.leave_out == ('/amcl', *['/move_base'] * bool(relay))
    assert made.options.replace['mbf_costmap_nav/mbf_costmap_nav'] == 'move_base_abstract/move_base'
    assert made.options.start == {'/move_base_flex': (2.0, 0.0, 0.0)}
    assert made.options.param['/move_base_flex/base_local_planner'] == local
    line, = remarks(made, 'uses the map of')
    assert 'radius 0.304 m, unknown cells not free, tolerances {:g} m'.format(0.15 * bool(relay)) in line
    assert len(remarks(made, 'exe_path')) == 1
    plan.plan_of(plan.read([(path, [])], True), plan.launch_options(made.options))  # it can be started


def test_a_use_map_for_all_robots_that_is_neither_true_nor_false_is_a_problem(file):
    assert adopt(file(), param={'/use_map': 'maybe'}).problems == (
        "parameter use_map above /move_base: got 'maybe'; allowed: true or false",)


@pytest.mark.parametrize('name', ['/use_map', '/move_base/use_map'])
def test_the_parameter_use_map_undoes_it_for_all_robots_or_for_one(file, name):
    made = adopt(file(), param={name: False})
    assert made.options.param == {name: False}
    assert not remarks(made, 'uses the map')


def test_what_the_user_gives_of_routes_takes_precedence(file):
    made = adopt(file(), param={'/move_base/routes': 'none'})
    assert made.options.param == {'/move_base/use_map': True, '/move_base/routes': 'none'}
    assert remarks(made, 'goals in occupied cells cannot be reached')


@pytest.mark.parametrize(('param', 'why'), [
    ('global_costmap: {static_map: false}', 'its global costmap has no static layer'),
    ('global_costmap: {plugins: [{name: o, type: "costmap_2d::ObstacleLayer"}]}', 'has no static layer'),
    ('global_costmap: {plugins: [{name: s, type: "costmap_2d::StaticLayer"}], s: {enabled: false}}', 'no static layer'),
    ('global_costmap: {global_frame: odom}', 'its global frame is odom, and the map of /map_server is in the frame')])
def test_a_robot_whose_planner_has_no_map_drives_straight_and_is_told(file, param, why):
    made = adopt(file(param=param))
    assert made.options.param == {}
    assert len(remarks(made, '/move_base uses no map and drives straight: ')) == len(remarks(made, why)) == 1


@pytest.mark.parametrize(('node', 'param', 'topic', 'is_used'), [
    ('', '', None, True),
    ('<remap from="map" to="yard"/>', '', None, False),
    ('<remap from="map" to="yard"/>', 'global_costmap: {map_topic: yard}', '/yard', True),
    ('<remap from="map" to="yard"/>',
     'global_costmap: {plugins: [{name: s, type: "costmap_2d::StaticLayer"}], s: {map_topic: /yard}}', '/yard', True)])
def test_the_topic_of_the_map_is_that_of_the_static_layer(file, node, param, topic, is_used):
    server = SERVER.replace('/>', '>{}</node>'.format(node))
    made = adopt(file(server=server, param=param))
    assert made.options.param.get('/move_base/use_map', False) == is_used
    assert len(remarks(made, 'nothing in the file serves /map')) == (not is_used)
    assert made.options.param.get('/move_base/map_topic', topic) == topic


def test_each_robot_uses_the_map_in_its_namespace_or_the_one_for_all(package):
    write_map(package)
    group = '<group ns="{}">{}<node pkg="move_base" type="move_base" name="move_base"/></group>'
    made = adopt(package('two.launch', '<launch>{}{}{}</launch>'.format(
        SERVER, group.format('a', SERVER), group.format('b', ''))))
    assert made.options.param['/a/move_base/map_topic'] == '/a/map'
    assert '/b/move_base/map_topic' not in made.options.param
    assert made.options.param['/b/move_base/routes'] == 'grid'
    assert len(remarks(made, 'uses the map of')) == 2


def test_the_topic_that_the_user_gives_is_the_one_of_the_map(package):
    write_map(package)
    text = '<launch>{}{}<node pkg="move_base" type="move_base" name="move_base"/></launch>'
    path = package('one.launch', text.format(SERVER, SERVER.replace('name="map_server"', 'name="yard" ns="yard"')))
    made = adopt(path, param={'/move_base/map_topic': '/yard/map'})
    assert remarks(made, '/move_base uses the map of /yard/yard,')
    assert remarks(made, 'no robot uses the map of /map_server on /map')
    assert remarks(adopt(path, param={'/move_base/map_topic': '/x'}), 'nothing in the file serves /x')


def test_a_second_map_that_no_robot_uses_is_named(file):
    made = adopt(file(server=SERVER + SERVER.replace('name="map_server"', 'name="keepout"').replace(
        '/>', '><remap from="map" to="keepout_map"/></node>')))
    assert remarks(made, 'no robot uses the map of /keepout on /keepout_map')


@pytest.mark.parametrize('server', ['', SERVER.replace('walls.yaml', 'none.yaml')])
def test_without_a_map_nothing_changes(file, server):
    made = adopt(file(server=server))
    assert made.options.param == {}
    assert not remarks(made, 'map and drives straight')


@pytest.mark.parametrize(('x', 'text'), [
    (1.0, None), (0.05, 'in an occupied cell of the map of /map_server, and may leave'),
    (-3.0, 'starts at (-3, 1.5), off the map of /map_server, and may leave that place (leave_obstacles)')])
def test_a_start_where_upstream_would_not_be_is_told(file, x, text):
    made = adopt(file(x=x))
    assert len(remarks(made, 'starts at')) == (text is not None)
    assert text is None or remarks(made, text)


def test_parameters_without_an_effect_are_named_in_one_list(file):
    made = adopt(file(param="""planner_patience: 3.0, recovery_behaviors: [{name: r, type: x/R}], r: {far: 1.0},
      max_speed: 1.0, oscillation_timeout: 2.0, global_costmap: {obstacle_range: 2.5, keepout: {map_topic: k},
      plugins: [{name: s, type: "costmap_2d::StaticLayer"}, {name: keepout, type: "costmap_2d::StaticLayer"},
        {name: i, type: "costmap_2d::InflationLayer"}, {name: o, type: "costmap_2d::ObstacleLayer"}],
      i: {inflation_radius: 0.3, cost_scaling_factor: 5.0}}, Unknown: {of: {nobody: 1}}, tf_prefix: r"""))
    assert made.unread == (
        '/amcl: initial_cov_xx',
        '/move_base: global_costmap/i/cost_scaling_factor, global_costmap/keepout/map_topic, '
        'global_costmap/obstacle_range,',
        '    global_costmap/plugins, oscillation_timeout, planner_patience (only with abort_policy: upstream), r/far,',
        '    recovery_behaviors (only with abort_policy: upstream), Unknown/of/nobody')


def test_robots_with_the_same_parameters_share_an_entry_and_the_policy_makes_patience_count(package):
    group = """<group ns="{}"><node pkg="move_base" type="move_base" name="move_base">
      <rosparam>{{planner_patience: 3.0, controller_patience: 2.0}}</rosparam></node></group>"""
    path = package('two.launch', '<launch>{}{}</launch>'.format(group.format('a'), group.format('b')))
    assert adopt(path).unread == (
        '/a/move_base and /b/move_base: controller_patience, planner_patience (only with abort_policy: upstream)',)
    made = adopt(path, param={'/a/move_base/abort_policy': 'upstream', '/b/move_base/abort_policy': 'upstream'})
    assert made.unread == ('/a/move_base and /b/move_base: controller_patience',)


@pytest.mark.parametrize(('robot', 'add'), [
    ('<include file="$(find of_nobody)/launch/move_base.launch"/>', {}),
    ('', {'/r/move_base': 'move_base_abstract/move_base'})])
def test_a_robot_that_is_added_is_one_like_those_of_the_file(package, robot, add):
    write_map(package)
    text = """<launch>{}<group ns="r">{}<param name="move_base/controller_patience" value="{}"/>
      <param name="move_base/xy_goal_tolerance" value="{}"/></group></launch>"""
    made = adopt(package('added.launch', text.format(SERVER, robot, 2.0, 0.25)), add=add)
    assert not made.problems
    assert remarks(made, '/r/move_base uses the map of /map_server, ') and remarks(made, 'tolerances 0.25 m')
    assert made.unread == ('/r/move_base: controller_patience',)
    problem, = adopt(package('added.launch', text.format(SERVER, robot, 2.0, -1.0)), add=add).problems
    assert problem.startswith('/r/move_base would end with an error: parameter /r/move_base/xy_goal_tolerance: got -1')


@pytest.mark.parametrize('image', ['/home/somebody/maps/walls.pgm', 'C:\\maps\\walls.pgm', 'not_here/walls.pgm'])
def test_an_image_that_lies_beside_the_map_is_taken_where_the_map_names_another_place(package, file, image):
    yaml = package('maps/other.yaml', '')
    with open(yaml.replace('other', 'walls')) as stream:
        text = stream.read()
    package('maps/walls.yaml', text.replace('image: walls.pgm', 'image: ' + image))
    beside = os.path.join(os.path.dirname(yaml), 'walls.pgm')
    made = adopt(file())
    assert made.options.param == {**GRID, '/map_server/image': beside} and '/map_server' not in made.options.leave_out
    assert remarks(made, '/map_server takes {}, which lies beside walls.yaml: the image that '.format(beside))
    os.unlink(beside)
    assert '/map_server' in adopt(file()).options.leave_out


def without_map(path):
    """Take the map_server out of a launch file."""
    with open(path) as stream:
        text = [line for line in stream if 'pkg="map_server"' not in line]
    with open(path, 'w') as stream:
        stream.writelines(text)
    return path


def test_without_a_map_the_floor_plan_of_stages_world_is_the_map_in_the_frame_of_that_world(package):
    write_map(package)
    path = without_map(write_stage(package, '10.0 20.0 0 0'))
    made = adopt(path)
    world = os.path.normpath(os.path.dirname(path) + '/../worlds/two.world')
    (name, added), = made.options.add.items()
    assert (name, os.path.normpath(added.split()[1])) == ('/map_server', world)
    assert added.split()[0] == 'move_base_abstract/map_server'
    assert made.options.start['/robot_0/move_base'] == (1.0, 2.0, math.pi / 2)
    assert made.options.param['/robot_0/move_base/routes'] == 'grid'
    assert remarks(made, '/robot_0/move_base starts at (1, 2), off the map of /map_server, and may leave')
    assert not remarks(made, "places in Stage's world")
    assert [line for line in made.done if line.startswith("/map_server is added: the floor plan of Stage's world two")]
    assert adopt(path, param={'/use_map': False}).options.add == {}  # nobody needs it
    cells, resolution, origin = floors.map_of(world)
    assert (cells.shape, resolution, origin) == ((30, 40), 0.1, Pose2D(8.0, 18.5))
    assert cells[0].min() == cells[-1].min() == cells[:, 0].min() == cells[:, -1].min() == 100
    assert cells[1:-1, 1:-1].max() == 0
    own = Node('move_base_abstract', 'map_server', args=added.split()[1])
    config = SimpleNamespace(nodes=[own])
    started._take_real_map_server(config)
    assert own.package == 'move_base_abstract'


def test_the_drawn_part_of_a_floor_plan_is_as_large_as_its_model_and_turned_with_it(package):
    write_map(package)
    rows = [[255] * 10 for _ in range(8)]
    rows[2][3] = rows[5][6] = rows[2][6] = 0  # drawn: 4 columns, 4 rows; its south-west corner is free
    package('maps/walls.pgm', 'P2\n10 8\n255\n{}\n'.format('\n'.join(' '.join(map(str, row)) for row in rows)))
    write_stage(package, '1.0 2.0 0 90.0')
    cells, resolution, origin = floors.map_of(package('worlds/x', '')[:-1] + 'two.world')
    assert (resolution, cells.shape) == (0.75, (4, 5))  # 4 m x 3 m
    assert cells.tolist() == [[0, 0, 0, 0, 100], [0] * 5, [0] * 5, [100, 0, 0, 0, 100]]
    assert (origin.x, origin.y, origin.yaw) == pytest.approx((1.0 + 1.5, 2.0 - 2.0, math.pi / 2))


@pytest.mark.parametrize('pose', ['0 0 0 0 ] size [ 0 0 0', '0 0 0 0 ] bitmap [ "none.pgm"'])
def test_a_floor_plan_that_cannot_be_read_is_no_map(package, pose):
    write_map(package)
    made = adopt(without_map(write_stage(package, pose)))
    assert made.options.add == {}
    assert remarks(made, "places in Stage's world count as places of the map")


@pytest.mark.parametrize(('words', 'problem'), [
    (['/move_base/use_map=true', '/move_base/routes=grid'], None),
    (['/move_base={use_map: true, routes: grid}'], None),
    (['/move_base={use_map: true}', 'move_base/routes=grid'], None),
    (['/move_base={routes: grid}'], "routes: got 'grid' with use_map: false"),
    (['/move_base={use_map: maybe}'], "use_map: got 'maybe'")])
def test_parameters_of_the_user_are_checked_as_they_are_set(package, words, problem):
    path = package('one.launch', '<launch><node pkg="move_base" type="move_base" name="move_base"/></launch>')
    given = [word for one in words for word in ('--param', one)]
    problems = adopt(path, param=of_words(RunOptions, given).param).problems
    assert [problem in one for one in problems] == ([True] if problem else [])
