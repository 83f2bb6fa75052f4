#!/usr/bin/env python3
"""Hear the topic argv[1] of texts and take no part."""
import sys

import rospy
from std_msgs.msg import String

rospy.init_node('onlooker', anonymous=True, disable_rostime=True)
rospy.Subscriber(sys.argv[1], String, lambda message: None)
rospy.spin()
