#!/usr/bin/env python3
"""Drives to random places, drawn by the default generators of numpy and Python."""
import random

import actionlib
import numpy as np
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal

rospy.init_node('walker')
client = actionlib.SimpleActionClient('move_base', MoveBaseAction)
client.wait_for_server()
names = {'north', 'east', 'south', 'west'}
for i in range(5):
    for name in names:  # a set, in its own order
        pass
    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = 'map'
    goal.target_pose.pose.position.x = random.random() * 4
    goal.target_pose.pose.position.y = np.random.normal(0.0, 1.0)
    goal.target_pose.pose.orientation.w = 1.0
    client.send_goal(goal)
    client.wait_for_result()
    rospy.sleep(random.choice([0.1, 0.2, 0.3]))
    p = goal.target_pose.pose.position
    print('%.9f %s %.6f %.6f' % (rospy.get_time(), name, p.x, p.y))
