#!/usr/bin/env python3
"""Somebody's own simulator: a unicycle that is integrated in steps. It knows nothing of lockstep.

cmd_vel in, odom out (both in its namespace), at ~rate [Hz]; noise of the wheels by numpy's global generator.
"""
import math

import numpy as np
import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry


class Unicycle:
    """A robot on two wheels, whose pose is that of the last step (m, rad, frame odom)."""

    def __init__(self):
        self.pose = [0.0, 0.0, 0.0]
        self.command = Twist()
        self.noise = rospy.get_param('~noise', 0.02)  # share of the speed
        self.publisher = rospy.Publisher('odom', Odometry, queue_size=10)
        rospy.Subscriber('cmd_vel', Twist, self.take)
        self.period = 1.0 / rospy.get_param('~rate', 50.0)
        rospy.Timer(rospy.Duration(self.period), self.step)

    def take(self, command):
        """Drive by ``command`` from the next step on."""
        self.command = command

    def step(self, event):
        """Drive for one period."""
        speed = self.command.linear.x * (1.0 + self.noise * np.random.normal())  # noqa: NPY002 - as many a node does
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
