#!/usr/bin/env python3
"""Waits for three messages in a loop with time.sleep."""
import time

import rospy
from std_msgs.msg import String

rospy.init_node('wall_loop')
messages = []
rospy.Subscriber('greeting', String, messages.append)
looks = 0
while len(messages) < 3:
    time.sleep(0.1)
    looks += 1
print('%.9f after %d looks' % (rospy.get_time(), looks))
