#!/usr/bin/env python3
"""Reads the settings once at the start and again every three seconds."""
import rospy
from std_msgs.msg import Float32, String

rospy.init_node('reader')
for i in range(5):
    mode = rospy.wait_for_message('settings/mode', String)
    speed = rospy.wait_for_message('settings/speed', Float32)
    print('%.9f %s %.1f' % (rospy.get_time(), mode.data, speed.data))
    rospy.sleep(3.0)
