#!/usr/bin/env python3
"""Publish that jobs are opened and closed, all at one instant."""
import rospy
from std_msgs.msg import String


def go(_message):
    for number in range(3):
        opened.publish('job %d' % number)
        closed.publish('job %d' % number)


rospy.init_node('clerk')
opened = rospy.Publisher('/opened', String, queue_size=10)
closed = rospy.Publisher('/closed', String, queue_size=10)
rospy.Subscriber('/ready', String, go)
rospy.spin()
