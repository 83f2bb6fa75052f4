#!/usr/bin/env python3
"""Bids for tasks on behalf of one robot, drives to those that it wins, and tells when it has arrived.

A bid is how far the robot has to go, behind what it has to do already. An award that comes again is said yes to again:
the first yes may have been lost. So may the word that a task is done, which is said three times.
"""
import collections
import json
import math

import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from std_msgs.msg import String


class Bidder:
    """One robot's."""

    def __init__(self):
        self.robot = rospy.get_namespace().strip('/')
        self.place = rospy.get_param('~start_x'), rospy.get_param('~start_y')  # where its last task is
        self.left = 0.0  # m, of its tasks that are not done
        self.queue, self.won = collections.deque(), set()
        self.bid = rospy.Publisher('/auction/bid', String, queue_size=100)
        self.taken = rospy.Publisher('/auction/taken', String, queue_size=100)
        self.done = rospy.Publisher('/auction/done', String, queue_size=100)
        self.drive = actionlib.SimpleActionClient('move_base', MoveBaseAction)
        self.drive.wait_for_server()
        rospy.Subscriber('/auction/task', String, self.on_task)
        rospy.Subscriber('/auction/award', String, self.on_award)

    def on_task(self, message):
        """Bid."""
        number, auction, x, y = json.loads(message.data)
        cost = self.left + math.dist(self.place, (x, y))
        self.bid.publish(json.dumps([number, auction, self.robot, cost]))

    def on_award(self, message):
        """Take what it has won."""
        number, robot, x, y = json.loads(message.data)
        if robot != self.robot:
            return
        self.taken.publish(json.dumps([number, self.robot]))
        if number not in self.won:
            self.won.add(number)
            way = math.dist(self.place, (x, y))
            self.left += way
            self.place = x, y
            self.queue.append((number, x, y, way))

    def run(self):
        """Do one task after the other."""
        while not rospy.is_shutdown():
            if not self.queue:
                rospy.sleep(0.5)
                continue
            number, x, y, way = self.queue.popleft()
            goal = MoveBaseGoal()
            goal.target_pose.header.frame_id = 'map'
            goal.target_pose.pose.position.x, goal.target_pose.pose.position.y = x, y
            goal.target_pose.pose.orientation.w = 1.0
            self.drive.send_goal_and_wait(goal)
            self.left -= way
            for _ in range(3):
                self.done.publish(json.dumps([number, self.robot]))
                rospy.sleep(0.5)


if __name__ == '__main__':
    rospy.init_node('bidder')
    try:
        Bidder().run()
    except rospy.ROSInterruptException:
        pass  # the run is over
