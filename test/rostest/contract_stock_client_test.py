#!/usr/bin/python3
"""A stock SimpleActionClient loses a result that comes too fast; with this package it never does."""
import unittest

import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseGoal
from robot_harness import pose_stamped, simple_client

GOALS = 1000
LOST = rospy.Duration(3000.0)  # simulated; 30 s of wall time


class StockClient(unittest.TestCase):
    """The robot arrives after 1 ms of simulated time, so each result is as early as it may be."""

    def test_a_thousand_goals_in_a_row_are_all_answered(self):
        client = simple_client()
        answered = 0
        for number in range(GOALS):
            client.send_goal(MoveBaseGoal(pose_stamped(float(number % 2))))
            self.assertTrue(client.wait_for_result(LOST), 'goal {} was never answered'.format(number))
            answered += client.get_state() == GoalStatus.SUCCEEDED
        self.assertEqual(answered, GOALS)


if __name__ == '__main__':
    rospy.init_node('contract_stock_client_test')
    rostest.rosrun('move_base_abstract', 'contract_stock_client', StockClient)
