#!/usr/bin/env python3
"""Put jobs from a topic into a queue, from which two workers take them."""
import queue
import threading

import rospy
from std_msgs.msg import String

jobs = queue.Queue(maxsize=3)


def on_job(msg):
    try:
        jobs.put(msg.data, timeout=1.0)
    except queue.Full:
        print('%.9f no room for %s' % (rospy.get_time(), msg.data))


def work(number, pub):
    while not rospy.is_shutdown():
        try:
            job = jobs.get(timeout=4.0)
        except queue.Empty:
            print('%.9f worker %d has nothing to do' % (rospy.get_time(), number))
            return
        rospy.sleep(1.5)
        pub.publish('%d did %s' % (number, job))
        print('%.9f worker %d did %s' % (rospy.get_time(), number, job))
        jobs.task_done()


rospy.init_node('workshop')
pub = rospy.Publisher('done', String, queue_size=10)
rospy.Subscriber('jobs', String, on_job, queue_size=10)
threads = [threading.Thread(target=work, args=(i, pub)) for i in range(2)]
for thread in threads:
    thread.daemon = True
    thread.start()
for thread in threads:
    thread.join()
jobs.join()
print('%.9f closed' % rospy.get_time())
