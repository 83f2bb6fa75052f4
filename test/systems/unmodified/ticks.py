#!/usr/bin/env python3
"""Publishes a number every second until it is shut down."""
import rospy
from std_msgs.msg import Int32

rospy.init_node('ticks')
pub = rospy.Publisher('ticks', Int32, queue_size=5)
rate = rospy.Rate(1.0)
count = 0
while not rospy.is_shutdown():
    pub.publish(count)
    count += 1
    try:
        rate.sleep()
    except rospy.ROSInterruptException:
        pass
