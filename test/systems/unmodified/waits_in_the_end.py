#!/usr/bin/env python3
"""Does some work and then waits for ever, for more work or for an event that never comes (the first argument)."""
import queue
import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import rospy
from actionlib.msg import TestActionGoal, TestActionResult
from actionlib_msgs.msg import GoalID
from std_srvs.srv import Empty, EmptyResponse

lock = threading.Lock()
jobs = queue.Queue()
closed = threading.Event()


def work():
    while True:
        rospy.sleep(jobs.get())


def wait_for_jobs():
    for pause in (1.0, 2.0, 0.5):
        jobs.put(pause)
    with ThreadPoolExecutor(2) as pool:
        print('asked: %s' % pool.submit(sum, (1, 2)).result())
        threading.Thread(target=work, daemon=True).start()
        worker = threading.Thread(target=work)
        worker.start()
        worker.join()


def wait_for_itself():
    def serve(_request):
        with lock:
            rospy.ServiceProxy('serve', Empty)()
        return EmptyResponse()
    rospy.Service('serve', Empty, serve)
    rospy.wait_for_service('serve')
    rospy.ServiceProxy('serve', Empty)()


def wait_for_a_goal():
    """Send a goal to a server that ignores it; the client waits for its end by an event."""
    rospy.Subscriber('go/goal', TestActionGoal, lambda _goal: None)
    rospy.Publisher('go/result', TestActionResult, queue_size=1)
    rospy.Subscriber('go/result', TestActionResult, lambda _result: closed.set())
    pub = rospy.Publisher('go/goal', TestActionGoal, queue_size=1)
    rospy.sleep(1.0)
    pub.publish(goal_id=GoalID(id='first'))
    closed.wait()


rospy.init_node('waiter')
{'jobs': wait_for_jobs, 'itself': wait_for_itself, 'goal': wait_for_a_goal}[sys.argv[1]]()
