"""The node soil_coordinator as a user starts it: its topics during the mission, and its files.

GUARD [s, wall] only ends a test that would never end.
"""
import csv
import json
import os
import time
import unittest

import pytest
import rospy
from nav_msgs.msg import OccupancyGrid
from std_msgs.msg import Float64
from visualization_msgs.msg import Marker, MarkerArray
from waiting import GUARD, wait_for

pytestmark = pytest.mark.night
LAUNCH_FILE = """
<launch>  <!-- the study as a user starts it, two robots, 30 times real time -->
  <include file="$(find move_base_abstract)/launch/soil_mapping.launch">
    <arg name="factor" value="30"/>
    <arg name="robots" value="2"/>
    <arg name="sampling" value="random"/>
    <arg name="budget" value="150"/>
    <arg name="dwell" value="2"/>
    <arg name="dwell_spread" value="0.5"/>
    <arg name="seed" value="5"/>
    <arg name="stay" value="true"/>
    <arg name="output" value="$(optenv ROS_HOME /tmp)/soil_mapping_trial"/>
  </include>
  <param name="/soil_launch_test/output" value="$(optenv ROS_HOME /tmp)/soil_mapping_trial"/>
</launch>
"""

NODE = '/soil_coordinator/'


class Shown(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node('soil_launch_test')
        cls.messages = {}
        for topic, kind in (('prediction', OccupancyGrid), ('variance', OccupancyGrid), ('markers', MarkerArray),
                            ('rmse', Float64), ('mean_variance', Float64)):
            cls.messages[topic] = []
            rospy.Subscriber(NODE + topic, kind, cls.messages[topic].append)
        cls.output = rospy.get_param('~output')

    def wait(self, condition):
        wait_for('it', condition, GUARD)

    def test_maps_come_in_their_frames_and_cover_the_field(self):
        for topic, frame in (('prediction', 'map'), ('variance', 'variance')):
            self.wait(lambda topic=topic: self.messages[topic])
            grid = self.messages[topic][0]
            self.assertEqual(grid.header.frame_id, frame)
            self.assertEqual((grid.info.width, grid.info.height, grid.info.resolution), (324, 220, 1.0))
            self.assertEqual(len(grid.data), 324 * 220)
            self.assertTrue(1 <= min(grid.data) <= max(grid.data) <= 98)

    def test_a_map_that_is_there_comes_to_those_who_listen_late(self):
        self.wait(lambda: self.messages['prediction'])
        self.assertEqual(rospy.wait_for_message(NODE + 'prediction', OccupancyGrid, GUARD).info.width, 324)

    def test_samples_and_tasks_are_markers(self):
        def shows(namespace):
            return any(marker.ns == namespace and marker.action == Marker.ADD and marker.points
                       for message in self.messages['markers'] for marker in message.markers)
        self.wait(lambda: shows('samples') and shows('tasks') and shows('ways'))

    def test_rmse_and_variance_come_with_the_maps(self):
        self.wait(lambda: self.messages['rmse'] and self.messages['mean_variance'])
        self.assertGreater(self.messages['rmse'][0].data, 0.0)

    def test_the_mission_leaves_a_complete_trial(self):
        about = os.path.join(self.output, 'trial.json')
        self.wait(lambda: os.path.exists(about) and os.stat(about).st_mtime > STARTED)
        with open(about, encoding='utf-8') as stream:
            about = json.load(stream)
        self.assertEqual((about['config']['robots'], about['config']['sampling'], about['seed']), (2, 'random', 5))
        self.assertEqual(about['engine']['name'], 'ros')
        self.assertGreaterEqual(about['simulated_s'], 150.0)
        with open(os.path.join(self.output, 'events.csv'), newline='', encoding='utf-8') as stream:
            events = list(csv.DictReader(stream))
        dwells = {float(event['value']) for event in events if event['event'] == 'dwell'}
        self.assertGreater(len(dwells), 2)
        self.assertTrue(all(1.5 <= dwell <= 2.5 for dwell in dwells), dwells)
        self.assertEqual([(event['x_m'], event['y_m']) for event in events[:2]],
                         [(event['x_m'], event['y_m']) for event in events if event['event'] == 'dwell'][:2])


STARTED = time.time()
