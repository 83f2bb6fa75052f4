#!/usr/bin/env python3
"""Publishes settings for other nodes on latched topics, and changes one now and then."""
import rospy
from std_msgs.msg import Float32, String

rospy.init_node('settings')
mode = rospy.Publisher('settings/mode', String, queue_size=1, latch=True)
speed = rospy.Publisher('settings/speed', Float32, queue_size=1, latch=True)
mode.publish('day')
for i in range(6):
    speed.publish(1.0 + 0.5 * i)
    rospy.sleep(2.0)
mode.publish('night')
rospy.spin()
