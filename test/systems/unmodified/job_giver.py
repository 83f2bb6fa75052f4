#!/usr/bin/env python3
"""Publishes jobs and counts those that are done; sleeps until the workshop is there."""
import threading

import rospy
from std_msgs.msg import String

condition = threading.Condition()
done = []


def on_done(msg):
    with condition:
        done.append(msg.data)
        condition.notify_all()


rospy.init_node('giver')
pub = rospy.Publisher('jobs', String, queue_size=10)
rospy.Subscriber('done', String, on_done)
rospy.sleep(1.0)
for i in range(9):
    pub.publish('job %d' % i)
    rospy.sleep(0.2)
with condition:
    while len(done) < 6:
        condition.wait(timeout=2.0)
        print('%.9f %d done' % (rospy.get_time(), len(done)))
print('%.9f over' % rospy.get_time())
