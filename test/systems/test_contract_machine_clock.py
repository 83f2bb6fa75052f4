"""Without simulated time a robot is as slow as a real one."""
import unittest

import rospy
from actionlib_msgs.msg import GoalStatus
from robot_harness import RawClient, active_since_ns, pose_stamped

LAUNCH_FILE = """
<launch>  <!-- no time master: the robot uses the machine's clock, as move_base does -->
  <param name="/use_sim_time" value="false"/>
  <node pkg="move_base_abstract" type="move_base" name="move_base" required="true">
    <param name="max_speed" value="10.0"/>
  </node>
</launch>
"""
OWN_NODE = 'contract_machine_clock_test'


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
