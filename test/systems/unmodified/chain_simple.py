#!/usr/bin/env python3
"""A tour in which the end of a goal starts a short break, and the end of the break sends the next goal."""
import threading

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal


class Tour(object):
    def __init__(self, places):
        self.places = list(places)
        self.finished = threading.Event()
        self.client = actionlib.SimpleActionClient('move_base', MoveBaseAction)
        rospy.loginfo('waiting for move_base')
        self.client.wait_for_server()

    def next(self, event=None):
        if not self.places:
            self.finished.set()
            return
        x, y = self.places.pop(0)
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id = 'map'
        goal.target_pose.pose.position.x = x
        goal.target_pose.pose.position.y = y
        goal.target_pose.pose.orientation.w = 1.0
        self.client.send_goal(goal, done_cb=self.done, active_cb=self.active)

    def active(self):
        print('%.9f active' % rospy.get_time())

    def done(self, state, result):
        print('%.9f %s, %d to go' % (rospy.get_time(), GoalStatus.to_string(state), len(self.places)))
        rospy.Timer(rospy.Duration(0.5), self.next, oneshot=True)


if __name__ == '__main__':
    rospy.init_node('tour')
    tour = Tour([(3.0, 0.0), (3.0, 2.0), (0.0, 0.0)])
    tour.next()
    tour.finished.wait()
    print('%.9f finished' % rospy.get_time())
