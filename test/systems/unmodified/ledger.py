#!/usr/bin/env python3
"""Keep a book of jobs: one callback makes an entry, with many log lines and notes, and the other needs it."""
import rospy
from std_msgs.msg import String

jobs = {}


def opened(message):
    for step in range(300):
        rospy.loginfo('%s: step %d', message.data, step)
        notes.publish('%s %d' % (message.data, step))
    jobs[message.data] = rospy.get_time()


def closed(message):
    print('%s took %.9f s' % (message.data, rospy.get_time() - jobs[message.data]))


rospy.init_node('ledger')
notes = rospy.Publisher('/notes', String, queue_size=1000)
rospy.Subscriber('/opened', String, opened)
rospy.Subscriber('/closed', String, closed)
ready = rospy.Publisher('/ready', String, queue_size=1, latch=True)
while not rospy.has_param('/onlooker_hears') and not rospy.is_shutdown():
    rospy.sleep(1.0)
ready.publish('go')
rospy.spin()
