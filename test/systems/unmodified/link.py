#!/usr/bin/env python3
"""A link of a chain: publishes the message of the link before as soon as it comes."""
import sys
import time

import rospy
from std_msgs.msg import String

rospy.init_node('link')
before, after = rospy.myargv(sys.argv)[1:3]
word = rospy.wait_for_message(before, String).data if before != '-' else 'go'
if rospy.get_param('~slow', 0.0):
    time.sleep(rospy.get_param('~slow'))  # it loads something
said = rospy.Publisher(after, String, queue_size=1, latch=True)
said.publish(word)
rospy.spin()
