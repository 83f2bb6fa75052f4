"""The launch files: all of them load and are documented, and the example with two robots really runs.

GUARD [s, simulated] and waiting.GUARD [s, wall] only end a test that would never end.
"""

import glob
import os
import shlex
import tempfile
import time
import unittest
from xml.etree import ElementTree

import numpy as np
import rosgraph
import roslaunch.config
import roslaunch.xmlloader
import rospkg
import rospy
import waiting
import yaml
from actionlib import GoalStatus, SimpleActionClient
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from nav_msgs.msg import Odometry
from own_sockets import listening_addresses, pid_of
from roslib.packages import find_node
from warm import Loopback

from move_base_abstract.config.settings import read_settings
from move_base_abstract_mapf.layout import Grid, write_folder
from move_base_abstract_mapf.movingai import Problem
from move_base_abstract_ros.launching import plan
from move_base_abstract_ros.lockstep.programs import binary
from move_base_abstract_ros.loopback import find_executable

LAUNCH_FILE = """
<launch>  <!-- the existing two-robot setup with its navigation swapped: stock clients reach goals with both robots -->
  <include file="$(find move_base_abstract)/launch/examples/two_robots_move_base.launch">
    <arg name="navigation_pkg" value="move_base_abstract"/>
    <arg name="factor" value="20"/>
  </include>
</launch>
"""
OWN_NODE = 'launch_files_test'

GUARD = 600.0
SPEED = 1.0  # m/s, DWAPlannerROS/max_vel_trans of the example
TOLERANCE = 0.1  # m, DWAPlannerROS/xy_goal_tolerance of the example
LAUNCH = os.path.join(rospkg.RosPack().get_path('move_base_abstract'), 'launch')
FILES = sorted(glob.glob(LAUNCH + '/*.launch') + glob.glob(LAUNCH + '/examples/*.launch'))


def load(name, *arguments):
    """Return the ROSLaunchConfig of a launch file with name:=value arguments."""
    config = roslaunch.config.ROSLaunchConfig()
    path = os.path.join(LAUNCH, name)
    roslaunch.xmlloader.XmlLoader(resolve_anon=False).load(path, config, argv=[path, *arguments], verbose=False)
    return config


def nodes(config):
    """Return the full names of the nodes in order of the file."""
    return [node.namespace + node.name for node in config.nodes]


def parameter(config, name):
    return config.params[name].value


class LaunchFiles(unittest.TestCase):
    """The first tests only load the files; the last one uses the running example of launch_files.test."""

    def test_every_file_is_found_and_every_arg_is_documented(self):
        self.assertGreaterEqual(len(FILES), 6)
        for path in FILES:
            for arg in ElementTree.parse(path).getroot().findall('arg'):
                self.assertTrue(arg.get('doc'), f"{path}: arg '{arg.get('name')}' has no doc")

    def test_simulator_starts_a_fleet_instead_where_a_scenario_is_given(self):
        scenario = os.path.join(LAUNCH, '..', 'config', 'scenario.yaml')
        config = load('simulator.launch', 'scenario:=' + scenario, 'processes:=3', 'map:=/a/map.yaml')
        self.assertEqual(nodes(config), ['/time_master', '/map_server', '/fleet_0', '/fleet_1', '/fleet_2'])
        self.assertEqual([parameter(config, f'/fleet_2/{key}') for key in ('part', 'parts', 'use_map', 'scenario')],
                         [2, 3, True, scenario])
        self.assertEqual(nodes(load('fleet.launch')), ['/fleet'])
        self.assertNotIn('/fleet/use_map', load('fleet.launch').params)

    def test_the_soil_study_takes_names_speed_cell_and_field(self):
        config = load('soil_mapping.launch', 'names:=tractor, quad', 'speed:=3', 'cell:=2.5', 'field:=csv:/a.csv',
                      'crs:=metres', 'size:=100x50', 'sampling:=my_package.module:Class')
        self.assertEqual(nodes(config), ['/time_master', '/fleet', '/task_server', '/soil_coordinator'])
        names = ['tractor', 'quad']
        self.assertEqual(parameter(config, '/fleet/robots'), [{'name': name} for name in names])
        self.assertEqual(parameter(config, '/fleet/defaults/max_speed'), 3.0)
        self.assertEqual(parameter(config, '/task_server/robots'), names)
        own = {'names': names, 'robots': 2, 'speed': 3.0, 'cell_m': 2.5, 'field': 'csv:/a.csv', 'crs': 'metres',
               'size': '100x50', 'sampling': 'my_package.module:Class'}
        self.assertEqual({key: parameter(config, f'/soil_coordinator/{key}') for key in own}, own)
        usual = load('soil_mapping.launch')
        self.assertEqual(parameter(usual, '/soil_coordinator/names'), ['robot_0', 'robot_1', 'robot_2'])
        self.assertEqual(parameter(usual, '/fleet/robots'), [{'name': 'robot', 'count': 3, 'step_x': 10.0}])
        given = load('soil_mapping.launch', 'scenario:=/a.yaml')
        self.assertEqual(parameter(given, '/fleet/scenario'), '/a.yaml')
        self.assertNotIn('/fleet/robots', given.params)

    def test_stage_is_started_with_the_world_the_map_and_the_robots_that_belong_together(self):
        for arguments, world, scenario in (([], 'farm_yard', 'scenario'), (['world:=field'], 'field', 'soil_robots')):
            config = load('stage.launch', *arguments)
            self.assertEqual(nodes(config), ['/stageros', '/map_server', '/fleet'])  # no time master beside Stage
            stage, server, _ = config.nodes
            self.assertEqual((stage.package, stage.type, stage.respawn), ('stage_ros', 'stageros', True))
            *options, world_file = shlex.split(stage.args)
            self.assertEqual(options, ['-u'])
            for path, folder, name in ((world_file, 'worlds', world + '.world'), (server.args, 'maps', world + '.yaml'),
                                       (parameter(config, '/fleet/scenario'), 'config', scenario + '.yaml')):
                self.assertTrue(os.path.samefile(path, os.path.join(LAUNCH, '..', folder, name)), path)
            self.assertEqual(parameter(config, '/fleet/backend'), 'stage_ros')
            self.assertIs(parameter(config, '/use_sim_time'), True)
        headless = load('stage.launch', 'gui:=false', 'use_map:=false', 'respawn:=false')
        self.assertEqual(nodes(headless), ['/stageros', '/fleet'])
        self.assertEqual(shlex.split(headless.nodes[0].args)[:-1], ['-g', '-u'])
        self.assertEqual((headless.nodes[0].required, headless.nodes[0].respawn), (True, False))
        self.assertNotIn('/fleet/backend', load('fleet.launch').params)

    def test_simulator_starts_as_many_robots_as_its_text_names_each_at_its_pose(self):
        config = load('simulator.launch', 'robots:=a 1 2 3; b -4.5 0 0;c 0 0 0', 'factor:=7')
        self.assertEqual(nodes(config), ['/time_master', '/a/move_base', '/b/move_base', '/c/move_base'])
        self.assertEqual([parameter(config, f'/a/move_base/start_{k}') for k in ('x', 'y', 'yaw')], [1, 2, 3])
        self.assertEqual(parameter(config, '/b/move_base/start_x'), -4.5)
        self.assertEqual(parameter(config, '/time_master/factor'), 7)

    def test_simulator_with_a_map_serves_it_and_tells_the_robots_to_use_it(self):
        config = load('simulator.launch', 'map:=/some/map.yaml')
        self.assertIn('/map_server', nodes(config))
        [server] = [node for node in config.nodes if node.name == 'map_server']
        self.assertEqual(server.args, '/some/map.yaml')
        for number in range(3):
            self.assertIs(parameter(config, f'/robot_{number}/move_base/use_map'), True)
        without = load('simulator.launch')
        self.assertNotIn('/map_server', nodes(without))
        self.assertNotIn('/robot_0/move_base/use_map', without.params)

    def test_robot_launch_works_by_itself_and_its_own_parameters_win(self):
        config = load('robot.launch', 'name:=r', 'x:=1.5', 'required:=false', 'respawn:=true')
        self.assertEqual(nodes(config), ['/r/move_base'])
        self.assertEqual((config.nodes[0].required, config.nodes[0].respawn), (False, True))
        self.assertEqual(parameter(config, '/r/move_base/start_x'), 1.5)
        self.assertEqual(parameter(config, '/r/move_base/tf_prefix'), 'r')

    def test_the_example_differs_only_in_the_package_and_the_clock(self):
        real = load('examples/two_robots_move_base.launch')
        abstract = load('examples/two_robots_move_base.launch', 'navigation_pkg:=move_base_abstract')
        self.assertEqual(nodes(real), ['/robot_1/move_base', '/robot_2/move_base'])
        self.assertEqual(nodes(abstract), ['/time_master'] + nodes(real))
        self.assertEqual([node.package for node in real.nodes], ['move_base'] * 2)
        for name in real.params:
            self.assertEqual(parameter(real, name), parameter(abstract, name), name)

    def test_the_example_names_what_the_real_move_base_would_not_find_by_a_tf_prefix(self):
        for package in ('move_base', 'move_base_abstract'):
            config = load('examples/two_robots_move_base.launch', 'navigation_pkg:=' + package, 'map:=/a/map.yaml')
            self.assertIn('/map_server', nodes(config))
            for node in (node for node in config.nodes if node.type == 'move_base'):
                robot = node.namespace.strip('/')
                self.assertIn(('map', '/map'), [tuple(remap) for remap in node.remap_args])
                frames = {key: parameter(config, f'/{robot}/move_base/{key}') for key in (
                    'global_costmap/global_frame', 'global_costmap/robot_base_frame', 'local_costmap/global_frame',
                    'local_costmap/robot_base_frame')}
                self.assertEqual(list(frames.values()), ['map', robot + '/base_link', robot + '/odom',
                                                         robot + '/base_link'])

    def test_every_program_of_ours_in_every_file_listens_on_this_computer_only(self):
        # of a node that no user starts by its name: the module's name, below lockstep --own
        ours = {node.get('args').split()[-1] if node.get('type') == 'lockstep' else node.get('type')
                for path in FILES for node in ElementTree.parse(path).getroot().iter('node')
                if node.get('pkg') == 'move_base_abstract'}
        nodes = 'move_base_abstract_ros.nodes.'
        arguments = {'map_server': [os.path.join(LAUNCH, '..', 'maps', 'farm_yard.yaml')], 'fleet': [],
                     'time_master': [], 'task_server': ['_robots:=[a]'], 'move_base': [], 'task_source': [],
                     'dispatcher': [], 'velocity_robot': [], nodes + 'orders_run.mapf_drive_node': [],
                     'soil_mapping.ros.soil_coordinator': [], nodes + 'property_monitor_node': [],
                     nodes + 'radio_markers_node': []}
        self.assertEqual(ours | set(arguments), set(arguments))
        with Loopback() as ros, tempfile.TemporaryDirectory() as folder:
            write_folder(folder, Grid(np.zeros((1, 1), bool), 1.0), [Problem((0, 0), (0, 0))], 1.0, 'a test')
            ros.set_param('/mapf_drive_node', {'folder': folder, 'plan': os.path.join(folder, 'plan.txt')})
            with open(os.path.join(folder, 'plan.txt'), 'w') as stream:
                stream.write('Agent 0: (0,0)\n')
            for node in ('fleet', 'dispatcher'):
                ros.set_param('/{}/robots'.format(node), [{'name': 'a'}])
            ros.set_param('/task_source/places', [{'name': 'here', 'duration': 1.0}])
            ros.set_param('/task_source/arrivals', [{'place': 'here', 'rate': 1.0}])
            for type_, given in sorted(arguments.items()):
                name = type_.rpartition('.')[2]
                words = [find_executable('lockstep'), '--own', type_] if '.' in type_ else [find_executable(type_)]
                child = ros.spawn('/' + name, ['/usr/bin/env', '-u', 'ROS_IP', *words, *given, '__name:=' + name])
                self.assertEqual(self._addresses(ros, name, child), {'127.0.0.1'}, name)

    def test_programs_of_others_in_roscpp_listen_where_ros_ip_is(self):
        variable, library = binary.loopback_only(os.environ)
        made = plan.make_plan([(os.path.join(LAUNCH, 'simulator.launch'), [])], plan.LaunchOptions())
        self.assertEqual([dict(node.env_args).get(variable) for node in made.config.nodes_core], [library])
        with Loopback() as ros:
            for name, command in (
                    ('rosout', ['/usr/bin/env', variable + '=' + library, *find_node('rosout', 'rosout')]),
                    ('board', [find_executable('lockstep'), find_executable('shim_board')])):
                child = ros.spawn('/' + name, [*command, '__name:=' + name])
                self.assertEqual(self._addresses(ros, name, child), {'127.0.0.1'}, name)

    def _addresses(self, ros, name, child):
        deadline = time.monotonic() + waiting.GUARD
        while True:
            try:
                return listening_addresses(pid_of('/' + name, ros.uri))
            except rosgraph.MasterException:
                self.assertIsNone(child.process.poll(), child.last_lines())
                self.assertLess(time.monotonic(), deadline, child.last_lines())
                time.sleep(0.05)

    def test_both_robots_reach_a_goal_at_the_speed_of_the_existing_parameters(self):
        clients = {name: SimpleActionClient(f'/{name}/move_base', MoveBaseAction) for name in ('robot_1', 'robot_2')}
        for name, client in clients.items():
            self.assertTrue(client.wait_for_server(rospy.Duration.from_sec(GUARD)), name)
        start = rospy.Time.now()
        for client, y in zip(clients.values(), (0.0, 3.0)):
            client.send_goal(goal_at(20.0, y))
        for (name, client), y in zip(clients.items(), (0.0, 3.0)):
            self.assertTrue(client.wait_for_result(rospy.Duration.from_sec(GUARD)), name)
            self.assertEqual(client.get_state(), GoalStatus.SUCCEEDED, name)
            self.assertEqual(client.get_goal_status_text(), 'Goal reached.')
            here = rospy.wait_for_message(f'/{name}/base_pose_ground_truth', Odometry).pose.pose.position
            self.assertAlmostEqual(here.x, 20.0, delta=TOLERANCE + 1e-6)
            self.assertAlmostEqual(here.y, y, delta=TOLERANCE + 1e-6)
        self.assertGreaterEqual((rospy.Time.now() - start).to_sec(), (20.0 - TOLERANCE) / SPEED)


def find(config, name):
    return [node for node in config.nodes if node.name == name]


class RvizLaunch(unittest.TestCase):
    """RViz's launch file and configuration fit each other and the robots' topics. RViz itself is not started."""

    @classmethod
    def setUpClass(cls):
        with open(os.path.join(LAUNCH, '..', 'rviz', 'simulator.rviz')) as stream:
            cls.manager = yaml.safe_load(stream)['Visualization Manager']
        cls.displays = {display['Class']: display for display in cls.manager['Displays']}

    def remaps(self, *arguments):
        return sorted(map(tuple, find(load(*arguments), 'rviz')[0].remap_args))

    def test_the_mouse_drives_the_chosen_robot(self):
        self.assertEqual(self.remaps('rviz.launch', 'robot:=tractor'), [
            ('/initialpose', '/tractor/initialpose'), ('/move_base_simple/goal', '/tractor/move_base_simple/goal'),
            ('/scan', '/tractor/scan')])
        self.assertEqual(self.displays['rviz/LaserScan']['Topic'], '/scan')

    def test_a_robot_without_a_namespace_can_be_chosen(self):
        self.assertEqual(self.remaps('rviz.launch', 'robot:=/'), [
            ('/initialpose', '/initialpose'), ('/move_base_simple/goal', '/move_base_simple/goal'), ('/scan', '/scan')])

    def test_the_simulator_shows_rviz_when_asked_to_with_its_first_robot(self):
        self.assertEqual(find(load('simulator.launch'), 'rviz'), [])
        remaps = self.remaps('simulator.launch', 'rviz:=true', 'robots:=a 0 0 0; b 1 1 1')
        self.assertIn(('/initialpose', '/a/initialpose'), remaps)
        remaps = self.remaps('simulator.launch', 'rviz:=true', 'robots:=a 0 0 0; b 1 1 1', 'rviz_robot:=b')
        self.assertIn(('/initialpose', '/b/initialpose'), remaps)

    def test_the_simulator_leaves_the_clock_to_another_simulator_when_asked_to(self):
        self.assertEqual(len(find(load('simulator.launch'), 'time_master')), 1)
        config = load('simulator.launch', 'time_master:=false')
        self.assertEqual(find(config, 'time_master'), [])
        self.assertIs(config.params['/use_sim_time'].value, True)

    def test_the_tools_use_the_topics_that_the_launch_file_remaps(self):
        topics = {tool['Class']: tool['Topic'] for tool in self.manager['Tools'] if 'Topic' in tool}
        self.assertEqual(topics, {'rviz/SetGoal': '/move_base_simple/goal', 'rviz/SetInitialPose': '/initialpose'})

    def test_map_robots_and_tf_are_shown_from_above_in_the_map_frame(self):
        self.assertEqual(self.displays['rviz/Map']['Topic'], '/map')
        topic = read_settings({}, '/robot').values['marker_topic']
        self.assertEqual(self.displays['rviz/MarkerArray']['Marker Topic'], '/' + topic)
        self.assertIn('rviz/TF', self.displays)
        self.assertEqual(self.manager['Global Options']['Fixed Frame'], 'map')
        self.assertEqual(self.manager['Views']['Current']['Class'], 'rviz/TopDownOrtho')


def goal_at(x, y):
    """Return a goal at (x, y) [m] in the map frame, heading along x."""
    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = 'map'
    goal.target_pose.pose.position.x = x
    goal.target_pose.pose.position.y = y
    goal.target_pose.pose.orientation.w = 1.0
    return goal
