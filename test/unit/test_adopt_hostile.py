"""Launch files and worlds that are wrong, huge or without an end: told with their place, and never a traceback."""
import os

import pytest
from roslaunch.core import RLException

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract_ros.adopting import neighbours, poses, reading, worlds
from move_base_abstract_ros.launching import plan
from strangers_package import adopt, package_fixture  # noqa: F401 - a fixture

ROBOT = '<node pkg="move_base" type="move_base" name="move_base"/>'
SPAWNED = '<node pkg="gazebo_ros" type="spawn_model" name="s" args="-urdf -param robot_description -model {0} -x {1}"/>'


@pytest.mark.parametrize(('text', 'expected'), [
    ('<include/>', "missing required attribute: 'file'"), ('<node/>', "missing required attribute: 'name'"),
    ('<arg name="a" value="$(eval 1/0)"/>', 'division by zero'),
    ('<arg name="a" value="$(nonsense)"/>', 'Unknown substitution command')])
def test_what_roslaunch_cannot_read_is_told_with_its_place(package, text, expected):
    package('inner.launch', '<launch>\n{}\n</launch>'.format(text))
    path = package('one.launch', '<launch>\n\n<include file="$(dirname)/inner.launch"/></launch>')
    with pytest.raises(RLException) as caught:
        adopt(path)
    assert expected in str(caught.value)
    assert 'inner.launch:2, included at one.launch:3' in str(caught.value)


@pytest.mark.parametrize('again', ['<include file="$(dirname)/one.launch"/>', """
  <include if="$(eval n > 0)" file="$(dirname)/one.launch"><arg name="n" value="$(eval n - 1)"/></include>"""])
def test_files_that_include_one_another_without_an_end_are_refused(package, again, monkeypatch):
    monkeypatch.setattr(reading, '_MOST_INCLUDED', 40)
    path = package('one.launch', '<launch><arg name="n" default="20"/>{}</launch>'.format(again * 2))
    with pytest.raises(RLException, match='include one another without an end'):
        adopt(path)


def test_an_include_without_a_folder_is_found_beside_its_file_and_told(package, monkeypatch):
    monkeypatch.chdir(os.path.dirname(package('../else/x', '')))
    package('amcl.launch', '<launch><node pkg="amcl" type="amcl" name="amcl">'
            '<param name="initial_pose_x" value="3"/></node></launch>')
    made = adopt(package('one.launch', '<launch>{}<include file="amcl.launch"/></launch>'.format(ROBOT)))
    assert tuple(made.options.start.items()) == (('/move_base', (3.0, 0.0, 0.0)),)
    assert any('amcl.launch is taken from beside the file that includes it' in line and 'one.launch:1' in line
               for line in made.remarks)


def test_parameters_that_no_server_takes_are_not_set_and_told(package):
    package('empty.yaml', 'lists: [1, null]\nnothing:\nsome: {one: 1, none: null}\nhuge: 3000000000\n')
    path = package('one.launch', '<launch>{}<rosparam file="$(dirname)/empty.yaml" command="load" ns="below"/>\n'
                   '<param name="below/other" value="3000000000"/></launch>'.format(ROBOT))
    config = plan.read([(path, [])], True)
    assert {key for key in config.params if key.startswith('/below')} == {'/below/some/one'}
    assert sum('has no value' in line and 'one.launch:1' in line for line in adopt(path).remarks) == 4


@pytest.mark.parametrize('text', ['a: &a {b: *a}\n', 'a0: &a0 [1, 2, 3, 4, 5, 6, 7, 8, 9]\n' + ''.join(
    'a{0}: &a{0} {{{1}}}\n'.format(k, ', '.join('k{}: *a{}'.format(one, k - 1) for one in range(9)))
    for k in range(1, 9))])
def test_parameters_that_stand_for_more_than_anybody_holds_are_refused(package, text):
    package('bomb.yaml', text)
    with pytest.raises(RLException, match='with aliases 500000 values') as caught:
        adopt(package('one.launch', '<launch><rosparam file="$(dirname)/bomb.yaml" command="load"/></launch>'))
    assert 'one.launch:1' in str(caught.value)


@pytest.mark.parametrize('value', ['{a: 1}', '{a: {b: [c]}}', '[[a]]', '3', '[1]'])
@pytest.mark.parametrize('name', ['participants', 'event_log', 'mode', 'end_with', 'onlookers', 'end_at'])
def test_a_value_of_the_time_masters_is_refused_where_it_is_read_and_otherwise_replaced(package, name, value):
    path = package('one.launch', '<launch><node pkg="move_base_abstract" type="time_master" name="time_master">'
                   '<rosparam>{}: {}</rosparam></node>{}</launch>'.format(
                       name, value, ROBOT.replace('"move_base"', '"move_base_abstract"', 1)))
    options, key = plan.LaunchOptions(parameters={'end_at': 5.0}), '/time_master/' + name
    if name in ('participants', 'event_log'):
        with pytest.raises(ConfigurationError, match=r'{}(\[0\])?: got .*; allowed: '.format(key)):
            plan.log_of_run(plan.make_plan([path], options), '/nowhere')
        return
    made = plan.make_plan([path], options)
    assert [one for one in made.config.params if one.startswith(key)] == [key]
    assert made.config.params[key].value in ('lockstep', [], 5.0)
    assert any(line.startswith(key + ' is ') for line in made.notes) == (name != 'end_at')


def test_aliases_are_read(package):
    package('a.yaml', 'a: &a {x: 1}\nb: *a\nc: "*"\n')
    path = package('one.launch', '<launch><rosparam file="$(dirname)/a.yaml" command="load"/></launch>')
    assert plan.read([(path, [])], True).params['/b/x'].value == 1


def test_a_package_file_that_is_a_pipe_is_none(tmp_path):
    (tmp_path / 'inner').mkdir()
    os.mkfifo(str(tmp_path / 'inner' / 'package.xml'))
    assert neighbours.packages_below(str(tmp_path)) == {}


def test_a_localizer_outside_of_namespaces_is_no_robot_where_robots_are_put_into_some(package):
    path = package('two.launch', """<launch><group ns="jackal0">{}</group><group ns="jackal1">{}</group>
      <node pkg="amcl" type="amcl" name="amcl_jackal0"><param name="initial_pose_x" value="0.0"/></node>
      <node pkg="amcl" type="amcl" name="amcl_jackal1"><param name="initial_pose_x" value="7.0"/></node></launch>
      """.format(SPAWNED.format('jackal0', 2), SPAWNED.format('jackal1', 5)))
    made = adopt(path)
    assert [(one['name'], one['start_x']) for one in made.options.param['/velocity_robots']['robots']] == [
        ('jackal0', 2.0), ('jackal1', 5.0)]


def test_a_navigation_that_is_not_here_is_known_however_its_name_is_written(package):
    made = adopt(package('one.launch', '<launch><include file="$(find of_nobody)/launch/movebase.launch"/></launch>'))
    assert list(made.options.add) == ['/move_base']


@pytest.mark.parametrize('name', ['r 1', 'a-b', '../x', '--record', 'r$x', 'rö'])
def test_names_that_ros_does_not_take_are_told(package, name):
    made = adopt(package('one.launch', '<launch><group ns="{}">{}</group></launch>'.format(name, ROBOT)))
    assert len(made.problems) == 1 and 'is not a name that ROS accepts' in made.problems[0]
    assert 'one.launch:1' in made.problems[0]


@pytest.mark.parametrize('number', ['9' * 400, 'nan', 'inf', '-1e999', 'x', ''])
def test_numbers_that_are_no_place_do_not_count(package, number):
    made = adopt(package('one.launch', """<launch>{}<node pkg="amcl" type="amcl" name="amcl">
      <param name="initial_pose_x" value="{}"/></node></launch>""".format(ROBOT, number)))
    assert tuple(made.options.start.items()) == () and made.problems == ()


@pytest.mark.parametrize(('text', 'expected'), [
    ('image: gone.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n',
     'gone.pgm, is not here'), ('[1, 2', 'its map cannot be read'), (None, 'maps/a.yaml is not here')])
def test_a_map_that_cannot_be_served_is_left_out_and_told(package, text, expected):
    if text is not None:
        package('maps/a.yaml', text)
    made = adopt(package('one.launch', """<launch>{}<node pkg="map_server" type="map_server" name="map_server"
      args="$(dirname)/../maps/a.yaml"/></launch>""".format(ROBOT)))
    assert made.options.leave_out == ('/map_server',)
    assert any(expected in line and 'one.launch:1' in line for line in made.remarks)


def world_of(tmp_path, text):
    path = tmp_path / 'a.world'
    path.write_text(text)
    return str(path)


@pytest.mark.parametrize(('text', 'expected'), [
    ('a ( ' * 100000, 'lie within one another'), ('position ( )\n' * 1001, 'allowed: up to 1000'),
    ('#' * ((1 << 22) + 1), 'allowed: up to 4194304 characters'), ('include "a.world"\n' * 2, 'files are included')])
def test_worlds_that_nobody_could_mean_are_refused(tmp_path, text, expected):
    with pytest.raises(ValueError, match=expected):
        worlds.read(world_of(tmp_path, text))


def test_parts_of_a_world_that_say_nothing_are_nothing(tmp_path):
    found = worlds.read(world_of(tmp_path, 'model ( name [ ] bitmap [ ] size [ ] ) position ( name [ ] pose [ 3 4 ] )'))
    assert found == worlds.World((('', (3.0, 4.0, 0.0)),), None, (worlds.Body(),))


def test_a_world_that_is_no_file_is_told_and_nobody_waits_for_it(package, tmp_path):
    os.mkfifo(str(tmp_path / 'pipe'))
    for path in (tmp_path / 'pipe', tmp_path, '/dev/zero'):
        config = plan.read([(package('one.launch', '<launch><node pkg="stage_ros" type="stageros" name="s" args="{}"/>'
                                     '</launch>'.format(path)), [])], True)
        _hints, (stage,) = poses.hints(config)
        assert 'the world file cannot be read' in stage.why
