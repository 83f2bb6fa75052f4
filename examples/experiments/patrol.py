#!/usr/bin/env python3
"""Drives round four corners and looks around at each for a random time; publishes on ``finished`` at the end."""
import random

import actionlib
import rospy
from geometry_msgs.msg import Point
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from std_msgs.msg import String

CORNERS = [Point(0.0, 0.0, 0.0), Point(10.0, 0.0, 0.0), Point(10.0, 10.0, 0.0), Point(0.0, 10.0, 0.0)]


def goal_at(corner):
    """Return the goal at ``corner`` [m], in frame map."""
    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = 'map'
    goal.target_pose.header.stamp = rospy.Time.now()
    goal.target_pose.pose.position = corner
    goal.target_pose.pose.orientation.w = 1.0
    return goal


def main():
    """Drive ~rounds rounds, publish on ``finished``, and end."""
    rospy.init_node('patrol')
    finished = rospy.Publisher('finished', String, queue_size=1, latch=True)
    client = actionlib.SimpleActionClient('move_base', MoveBaseAction)
    client.wait_for_server()
    for _ in range(rospy.get_param('~rounds', 3)):
        for corner in CORNERS:
            client.send_goal(goal_at(corner))
            client.wait_for_result()
            rospy.sleep(random.expovariate(1.0 / rospy.get_param('~pause', 2.0)))
    finished.publish(rospy.get_namespace())


if __name__ == '__main__':
    main()
