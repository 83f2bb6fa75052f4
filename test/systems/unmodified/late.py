#!/usr/bin/env python3
"""Advertise a topic late."""
import rospy
from std_msgs.msg import String

rospy.init_node('late')
rospy.sleep(1.234)
rospy.Publisher('/late', String, queue_size=1)
rospy.spin()
