"""A test of own_simulator.launch: a simulator and controllers that know nothing of this package.

Run it by ``python3 -m pytest -p move_base_abstract_testing test_own_simulator.py``.
"""
import math

import pytest
import rospy
from nav_msgs.msg import Odometry


@pytest.mark.lockstep(launch='own_simulator.launch')
def test_a_controller_reaches_its_last_goal_and_twice_in_the_same_way(lockstep):
    """The noise of the wheels follows from the seed, so a second run is identical."""
    poses = []
    rospy.Subscriber('/robot_1/odom', Odometry, lambda message: poses.append(message.pose.pose.position))
    lockstep.run_until(lambda: poses and poses[-1].x < -1.8, limit=10, what='robot_1 comes to its first goal')
    lockstep.run_until(lambda: math.hypot(poses[-1].x, poses[-1].y) < 0.2, limit=10, what='robot_1 comes back')
    lockstep.assert_identical()
