#!/usr/bin/env python3
"""A user's node that drives one robot by velocities and scans, and knows nothing of a simulator.

usage: driven_agent.py ROBOT INDEX
"""

import sys

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

LOOP_HZ = 10.0
FAR = 3.0  # m


class Agent:
    """Wanders: ahead while there is room, and away from what is near."""

    def __init__(self, robot):
        self._scan = None
        self._odometry = None
        self._commands = rospy.Publisher(f'/{robot}/cmd_vel', Twist, queue_size=1)
        rospy.Subscriber(f'/{robot}/base_scan', LaserScan, self._on_scan)
        rospy.Subscriber(f'/{robot}/odom', Odometry, self._on_odometry)

    def run(self):
        """Send velocities until the node is shut down."""
        rate = rospy.Rate(LOOP_HZ)
        while not rospy.is_shutdown():
            if self._scan is not None:
                self._commands.publish(self._command())
            rate.sleep()

    def _command(self):
        ranges = self._scan.ranges
        third = len(ranges) // 3
        right, ahead, left = (min(*part, FAR) for part in (
            ranges[:third], ranges[third:2 * third], ranges[2 * third:]))
        command = Twist()
        command.linear.x = max(0.0, 0.4 * (ahead - 0.6))
        command.angular.z = 0.8 * (left - right) / FAR + (0.6 if ahead < 1.0 else 0.05)
        return command

    def _on_scan(self, scan):
        self._scan = scan

    def _on_odometry(self, odometry):
        self._odometry = odometry


def main():
    """Run the agent."""
    rospy.init_node('agent')
    try:
        Agent(sys.argv[1]).run()
    except rospy.ROSInterruptException:
        pass


if __name__ == '__main__':
    main()
