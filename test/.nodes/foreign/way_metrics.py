#!/usr/bin/env python3
"""Publishes every five seconds how far each robot has driven."""
import math

import rospy
from nav_msgs.msg import Odometry
from std_msgs.msg import String

last = {}
way = {}


def on_odom(message, name):
    here = message.pose.pose.position
    if name in last:
        way[name] = way.get(name, 0.0) + math.hypot(here.x - last[name].x, here.y - last[name].y)
    last[name] = here


def report(event):
    publisher.publish(', '.join('%s %.3f m' % (name, way[name]) for name in sorted(way)))


rospy.init_node('metrics')
publisher = rospy.Publisher('/metrics', String, queue_size=10)
for robot in ('robot_0', 'robot_1', 'robot_2'):
    rospy.Subscriber('/%s/odom' % robot, Odometry, on_odom, callback_args=robot)
timer = rospy.Timer(rospy.Duration(5), report)
rospy.wait_for_message('/finished', String)
timer.shutdown()
