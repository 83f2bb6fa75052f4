#!/usr/bin/env python3
"""Publish frontiers at 200 Hz from 2 s on, and a word for a partner now and then."""
import rospy
from std_msgs.msg import Float64, String

rospy.init_node('finder')
frontiers = rospy.Publisher('/frontiers', Float64, queue_size=10)
partner = rospy.Publisher('/partner', String, queue_size=10)
rospy.sleep(1.0)
rate = rospy.Rate(200)
for number in range(3060):
    frontiers.publish(0.5 * number)
    if number % 300 == 299:
        partner.publish('come')
    rate.sleep()
