#!/usr/bin/env python3
"""Bids for tasks on behalf of one robot, drives to the tasks that it wins, and reports each task that is done.

A bid is the distance [m] that the robot drives until it is at the task, after all tasks that it already has. If an
award comes again, the bidder confirms it again, since its first answer may have been lost. For the same reason it
reports three times that a task is done.
"""
import collections
import json
import math

import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from std_msgs.msg import String


class Bidder:
    """The bidder of one robot."""

    def __init__(self):
        self.robot = rospy.get_namespace().strip('/')
        self.place = rospy.get_param('~start_x'), rospy.get_param('~start_y')  # m, of its last task
        self.left = 0.0  # m: way to drive for the tasks that are not done
        self.queue, self.won = collections.deque(), set()
        self.bid = rospy.Publisher('/auction/bid', String, queue_size=100)
        self.taken = rospy.Publisher('/auction/taken', String, queue_size=100)
        self.done = rospy.Publisher('/auction/done', String, queue_size=100)
        self.drive = actionlib.SimpleActionClient('move_base', MoveBaseAction)
        self.drive.wait_for_server()
        rospy.Subscriber('/auction/task', String, self.on_task)
        rospy.Subscriber('/auction/award', String, self.on_award)

    def on_task(self, message):
        """Bid for the task."""
        number, auction, x, y = json.loads(message.data)
        cost = self.left + math.dist(self.place, (x, y))
        self.bid.publish(json.dumps([number, auction, self.robot, cost]))

    def on_award(self, message):
        """Confirm an award to this robot, and queue its task unless it is known."""
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
        """Drive to the queued tasks, one after the other."""
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
