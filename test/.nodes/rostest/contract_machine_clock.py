#!/usr/bin/python3
"""Without simulated time a robot is as slow as a real one."""
import sys
import unittest
from pathlib import Path

import rospy
import rostest
from actionlib_msgs.msg import GoalStatus

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / 'systems'))

from robot_harness import RawClient, active_since_ns, pose_stamped


class MachineClock(unittest.TestCase):
    """The robot drives at 10 m/s."""

    def test_a_goal_takes_its_time_by_the_machines_clock(self):
        client = RawClient()
        before = rospy.Time.now()
        goal_id = client.send(pose_stamped(5.0))
        start_ns = active_since_ns(client, goal_id)
        ended = client.ending(goal_id)
        self.assertEqual(ended.status.status, GoalStatus.SUCCEEDED)
        self.assertEqual(ended.header.stamp.to_nsec() - start_ns, 500_000_000)
        self.assertGreaterEqual((rospy.Time.now() - before).to_nsec(), 500_000_000)


if __name__ == '__main__':
    rospy.init_node('contract_machine_clock_test')
    rostest.rosrun('move_base_abstract', 'contract_machine_clock', MachineClock)
