#!/usr/bin/env python3
"""A small state machine: drive to a goal in time; otherwise cancel, rest, and try again with more patience."""
import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal


class Machine:
    def __init__(self):
        self.state = 'connect'
        self.patience = 2.0
        self.client = actionlib.SimpleActionClient('move_base', MoveBaseAction)

    def connect(self):
        return 'drive' if self.client.wait_for_server(rospy.Duration(5.0)) else 'failed'

    def drive(self):
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id = 'map'
        goal.target_pose.pose.position.x = 7.0
        goal.target_pose.pose.orientation.w = 1.0
        self.client.send_goal(goal)
        if self.client.wait_for_result(rospy.Duration(self.patience)):
            return 'arrived' if self.client.get_state() == GoalStatus.SUCCEEDED else 'failed'
        return 'timeout'

    def timeout(self):
        self.client.cancel_goal()
        self.client.wait_for_result()
        print('%.9f after cancel: %s' % (rospy.get_time(), GoalStatus.to_string(self.client.get_state())))
        self.patience *= 2
        rospy.sleep(0.5)
        return 'drive'

    def run(self):
        while self.state not in ('arrived', 'failed') and not rospy.is_shutdown():
            print('%.9f %s' % (rospy.get_time(), self.state))
            self.state = getattr(self, self.state)()
        print('%.9f %s' % (rospy.get_time(), self.state))


if __name__ == '__main__':
    rospy.init_node('machine')
    Machine().run()
