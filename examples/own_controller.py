#!/usr/bin/env python3
"""Drives a robot to ~goals [[x, y], ...] (m, frame odom), by odom and cmd_vel; ends when all goals are reached."""
import math

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry

NEAR = 0.2  # m


class Controller:
    """Turns the robot towards its goal, and drives faster the better the robot faces it."""

    def __init__(self):
        self.goals = rospy.get_param('~goals')
        self.publisher = rospy.Publisher('cmd_vel', Twist, queue_size=10)
        rospy.Subscriber('odom', Odometry, self.steer)

    def steer(self, odometry):
        """Publish the command for the pose in ``odometry``."""
        place, turn = odometry.pose.pose.position, odometry.pose.pose.orientation
        if math.hypot(self.goals[0][0] - place.x, self.goals[0][1] - place.y) < NEAR:
            rospy.loginfo('at %s at %.2f s', self.goals.pop(0), odometry.header.stamp.to_sec())
        command = Twist()
        if self.goals:
            x, y = self.goals[0]
            error = math.atan2(y - place.y, x - place.x) - 2 * math.atan2(turn.z, turn.w)
            error = math.atan2(math.sin(error), math.cos(error))
            command.linear.x, command.angular.z = max(0.0, math.cos(error)), 2.0 * error
        self.publisher.publish(command)
        if not self.goals:
            rospy.signal_shutdown('all goals are reached')


rospy.init_node('controller')
Controller()
rospy.spin()
