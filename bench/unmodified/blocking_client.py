#!/usr/bin/env python3
"""A user's script that sends a goal and waits for its result, again and again. usage: blocking_client.py GOALS."""

import json
import sys

import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal

rospy.init_node('client')
client = actionlib.SimpleActionClient('/robot_0/move_base', MoveBaseAction)
client.wait_for_server()
count = int(sys.argv[1])
print('begin', flush=True)
for number in range(count):
    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = 'map'
    goal.target_pose.pose.position.x = 20.0 * (number % 2)
    goal.target_pose.pose.orientation.w = 1.0
    client.send_goal(goal)
    client.wait_for_result()
print(json.dumps({'count': count}), flush=True)
