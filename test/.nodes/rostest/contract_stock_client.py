#!/usr/bin/python3
"""A stock SimpleActionClient loses a result that comes too fast; with this package it never does."""
import sys
import unittest
from pathlib import Path

import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseGoal

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / 'systems'))

from robot_harness import pose_stamped, simple_client

LOST = rospy.Duration(3000.0)  # simulated; 30 s of wall time


class StockClient(unittest.TestCase):
    """The robot arrives after 1 ms of simulated time, so each result is as early as it may be."""

    def test_hundreds_of_goals_in_a_row_are_all_answered(self):
        client = simple_client()
        answered, goals = 0, rospy.get_param('~goals')
        for number in range(goals):
            client.send_goal(MoveBaseGoal(pose_stamped(float(number % 2))))
            self.assertTrue(client.wait_for_result(LOST), 'goal {} was never answered'.format(number))
            answered += client.get_state() == GoalStatus.SUCCEEDED
        self.assertEqual(answered, goals)


if __name__ == '__main__':
    rospy.init_node('contract_stock_client_test')
    rostest.rosrun('move_base_abstract', 'contract_stock_client', StockClient)
