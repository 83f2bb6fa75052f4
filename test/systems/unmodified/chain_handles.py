#!/usr/bin/env python3
"""Sends each robot its next goal in the callback at the end of the last goal (actionlib.ActionClient)."""
import random

import actionlib
import rospy
from actionlib import CommState, TerminalState
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from std_msgs.msg import String


class Robot:
    def __init__(self, name, goals, log):
        self.name = name
        self.left = goals
        self.log = log
        self.handle = None
        self.client = actionlib.ActionClient('/%s/move_base' % name, MoveBaseAction)
        self.client.wait_for_server()

    def send(self):
        self.left -= 1
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id = 'map'
        goal.target_pose.header.stamp = rospy.Time.now()
        goal.target_pose.pose.position.x = random.uniform(-5, 5)
        goal.target_pose.pose.position.y = random.uniform(-5, 5)
        goal.target_pose.pose.orientation.w = 1.0
        self.handle = self.client.send_goal(goal, self.on_transition)

    def on_transition(self, handle):
        if handle.get_comm_state() == CommState.DONE:
            self.log.publish('%s %s' % (self.name, TerminalState.to_string(handle.get_terminal_state())))
            print('%.9f %s %d' % (rospy.get_time(), self.name, handle.get_terminal_state()))
            if self.left > 0:
                self.send()


rospy.init_node('dispatcher')
log = rospy.Publisher('/events', String, queue_size=100)
robots = [Robot(name, 5, log) for name in rospy.get_param('~robots')]
for robot in robots:
    robot.send()
while not rospy.is_shutdown() and any(r.left or r.handle.get_comm_state() != CommState.DONE for r in robots):
    rospy.sleep(0.1)
print('%.9f all done' % rospy.get_time())
