#!/usr/bin/env python3
"""Drives robots and reacts to messages on the way: feedback changes its goals, and it counts odometry, tf and more."""
import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage


class Driver(object):
    def __init__(self, robot, index, goals):
        self.robot = robot
        self.index = index
        self.left = goals
        self.heard = 0
        self.odometry = 0
        self.client = actionlib.SimpleActionClient('/' + robot + '/move_base', MoveBaseAction)
        self.client.wait_for_server()
        rospy.Subscriber('/' + robot + '/odom', Odometry, self.on_odometry)
        self.is_free = True

    def next(self):
        self.is_free = False
        self.left -= 1
        self.heard = 0
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id = 'map'
        goal.target_pose.pose.position.x = 3.0 + (7 * self.left + self.index) % 5
        goal.target_pose.pose.position.y = 2.0 * self.index + self.left % 2
        goal.target_pose.pose.orientation.w = 1.0
        self.client.send_goal(goal, done_cb=self.done, feedback_cb=self.on_feedback)

    def on_feedback(self, feedback):
        self.heard += 1
        if self.left % 3 == 1 and self.heard == 11 + self.index:
            self.client.cancel_goal()
        elif self.left % 3 == 2 and self.heard > 30:
            self.is_free = True

    def on_odometry(self, message):
        self.odometry += 1

    def done(self, state, result):
        print('%.9f %s %s after %d' % (rospy.get_time(), self.robot, GoalStatus.to_string(state), self.heard))
        self.is_free = True


if __name__ == '__main__':
    rospy.init_node('follower')
    transforms = []
    rospy.Subscriber('/tf', TFMessage, lambda message: transforms.extend(message.transforms))
    more = []
    for topic in rospy.get_param('~more', []):
        rospy.Subscriber(topic, rospy.AnyMsg, more.append)
    drivers = [Driver('robot_%d' % i, i, 12) for i in range(rospy.get_param('~robots', 3))]
    rate = rospy.Rate(7)
    while not rospy.is_shutdown() and any(driver.left or not driver.is_free for driver in drivers):
        for driver in drivers:
            if driver.is_free and driver.left:
                driver.next()
        rate.sleep()
    print('%.9f heard %s odometry, %d transforms, %d more' % (
        rospy.get_time(), [driver.odometry for driver in drivers], len(transforms), len(more)))
