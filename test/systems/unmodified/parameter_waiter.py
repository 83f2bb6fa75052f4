#!/usr/bin/env python3
"""Wait for a parameter that another node sets."""
import sys

import rospy

rospy.init_node('waiter')
rospy.sleep(1.0)
rospy.set_param('/waits', True)
while not rospy.get_param(sys.argv[1], False):
    rospy.sleep(0.5)
print('it is there', flush=True)
while rospy.get_param(sys.argv[1]):
    rospy.sleep(0.5)
