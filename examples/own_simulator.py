#!/usr/bin/env python3
"""A simulator of one's own: a unicycle that is integrated in steps. It knows nothing of lockstep.

It reads cmd_vel and publishes odom, both in its namespace, at ~rate [Hz]. The noise of the wheels comes from numpy's
global generator.
"""
import math

import numpy as np
import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry


class Unicycle:
    """A robot on two wheels. Its pose (m, rad, frame odom) is the one after the last step."""

    def __init__(self):
        self.pose = [0.0, 0.0, 0.0]
        self.command = Twist()
        self.noise = rospy.get_param('~noise', 0.02)  # standard deviation, as a share of the speed
        self.publisher = rospy.Publisher('odom', Odometry, queue_size=10)
        rospy.Subscriber('cmd_vel', Twist, self.take)
        self.period = 1.0 / rospy.get_param('~rate', 50.0)
        rospy.Timer(rospy.Duration(self.period), self.step)

    def take(self, command):
        """Use ``command`` from the next step on."""
        self.command = command

    def step(self, event):
        """Drive for one period."""
        speed = self.command.linear.x * (1.0 + self.noise * np.random.normal())  # noqa: NPY002 - as many nodes do
        x, y, yaw = self.pose
        self.pose = [x + speed * self.period * math.cos(yaw), y + speed * self.period * math.sin(yaw),
                     yaw + self.command.angular.z * self.period]
        message = Odometry()
        message.header.stamp, message.header.frame_id = event.current_real, 'odom'
        message.pose.pose.position.x, message.pose.pose.position.y, yaw = self.pose
        message.pose.pose.orientation.z, message.pose.pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
        self.publisher.publish(message)


rospy.init_node('simulator')
Unicycle()
rospy.spin()
