"""A stock SimpleActionClient loses a result that comes too fast; with this package it never does."""
import unittest

import rospy
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseGoal
from night import times
from robot_harness import pose_stamped, simple_client

LAUNCH_FILE = """
<launch>  <!-- a stock client that gets its results as early as possible -->
  <include file="$(find move_base_abstract)/launch/time_master.launch">
    <arg name="factor" value="100"/>
  </include>
  <node pkg="move_base_abstract" type="move_base" name="move_base" required="true">
    <param name="max_speed" value="1000.0"/>
  </node>
</launch>
"""
OWN_NODE = 'contract_stock_client_test'

GOALS = times(200, 1000)
LOST = rospy.Duration(3000.0)  # simulated; 30 s of wall time


class StockClient(unittest.TestCase):
    """The robot arrives after 1 ms of simulated time, so each result is as early as it may be."""

    def test_hundreds_of_goals_in_a_row_are_all_answered(self):
        client = simple_client()
        answered = 0
        for number in range(GOALS):
            client.send_goal(MoveBaseGoal(pose_stamped(float(number % 2))))
            self.assertTrue(client.wait_for_result(LOST), 'goal {} was never answered'.format(number))
            answered += client.get_state() == GoalStatus.SUCCEEDED
        self.assertEqual(answered, GOALS)
