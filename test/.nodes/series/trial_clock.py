#!/usr/bin/env python3
"""Sends the robot to a place, reports when the trial's time is over, then sleeps, as many programs do at the end."""
import sys
from time import sleep

import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from std_msgs.msg import Bool

if __name__ == '__main__':
    rospy.init_node('trial_clock')
    trial, budget = (float(word.strip('"')) for word in rospy.myargv(sys.argv)[1:])
    over = rospy.Publisher('/budget_elapsed', Bool, queue_size=1)
    client = actionlib.SimpleActionClient('/robot_0/move_base', MoveBaseAction)
    client.wait_for_server()
    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = 'map'
    goal.target_pose.pose.position.x, goal.target_pose.pose.orientation.w = 10.0 * trial, 1.0
    client.send_goal(goal)
    begin = rospy.get_time()
    while not rospy.is_shutdown():
        if rospy.get_time() - begin > budget:
            over.publish(True)
            sleep(5)
            break
        rospy.sleep(0.1)
