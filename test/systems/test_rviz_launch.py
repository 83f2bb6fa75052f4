"""RViz's launch file and configuration fit each other and the robots' topics. RViz itself is not started."""
import os
import unittest

import rospkg
import yaml
from roslaunch.config import ROSLaunchConfig
from roslaunch.xmlloader import XmlLoader

from move_base_abstract.config.settings import read_settings

PACKAGE = rospkg.RosPack().get_path('move_base_abstract')


def load(name, *arguments):
    """Return the ROSLaunchConfig of a launch file with name:=value arguments."""
    config = ROSLaunchConfig()
    path = os.path.join(PACKAGE, 'launch', name)
    XmlLoader(resolve_anon=False).load(path, config, argv=[path, *arguments], verbose=False)
    return config


def find(config, name):
    return [node for node in config.nodes if node.name == name]


class RvizLaunch(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with open(os.path.join(PACKAGE, 'rviz', 'simulator.rviz')) as stream:
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
