#!/usr/bin/env python3
"""Keep accounts of jobs and log every step: one callback opens an account, and another callback needs it."""
import rospy
from std_msgs.msg import String

accounts = {}


def opened(message):
    for step in range(300):
        rospy.loginfo('%s: step %d', message.data, step)
    accounts[message.data] = rospy.get_time()


def closed(message):
    print('%s took %.9f s' % (message.data, rospy.get_time() - accounts[message.data]))
    rospy.logwarn('%s is closed', message.data)


rospy.init_node('accountant')
rospy.loginfo('accounts are open')
rospy.Subscriber('/opened', String, opened)
rospy.Subscriber('/closed', String, closed)
ready = rospy.Publisher('/ready', String, queue_size=1)
rospy.sleep(4.0)  # let the connections come up
ready.publish('go')
rospy.spin()
