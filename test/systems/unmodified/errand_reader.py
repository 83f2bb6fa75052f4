#!/usr/bin/env python3
"""Read a parameter every 0.1 s, and when a message asks for it."""
import rospy
from std_msgs.msg import String


def look(what):
    print('%.3f %s %s' % (rospy.get_time(), what, rospy.get_param('/errand', None)), flush=True)


rospy.init_node('errand_reader')
rospy.Subscriber('/said', String, lambda text: look('told'))
for _ in range(25):
    look('sees')
    rospy.sleep(0.1)
