#!/usr/bin/env python3
"""Wait for flags in several ways without sleeping for any time; a timer raises each flag after a second."""
import os
import sys
import threading

import rospy

raised = threading.Event()
count = 0


class Worker:
    def __init__(self):
        self.stop = False
        self.total = 0

    def work(self):
        while not self.stop:
            self.total += 1


def by_event():
    while not raised.wait(0):
        pass


def by_sleep():
    while not raised.is_set():
        rospy.sleep(0)


def by_yield():
    while not raised.is_set():
        os.sched_yield()


def by_parameter():
    global count
    while not raised.is_set() and not rospy.is_shutdown():
        count += bool(rospy.get_param('/speed', 1.0))


def by_work():
    worker = Worker()
    thread = threading.Thread(target=worker.work)
    thread.start()
    raised.wait()
    worker.stop = True
    thread.join()


rospy.init_node('restless')
for name in sys.argv[1].split(','):
    raised.clear()
    timer = rospy.Timer(rospy.Duration(1.0), lambda _event: raised.set(), oneshot=True)
    {'event': by_event, 'sleep': by_sleep, 'yield': by_yield, 'parameter': by_parameter, 'work': by_work}[name]()
    timer.join()
    print('%.2f %s' % (rospy.get_time(), name))
print('asked %d times' % count)
