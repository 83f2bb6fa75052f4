#!/usr/bin/env python3
"""Runs trials as published studies do: a launch file by ROSLaunchParent, until a topic reports the end of its time."""
import os
import sys

import roslaunch
import rospy
from geometry_msgs.msg import PoseStamped
from roslaunch.parent import ROSLaunchParent
from std_msgs.msg import Bool

HERE = os.path.dirname(os.path.abspath(__file__))
NAME = 'trials.launch'

for trial in sys.argv[1:]:
    words = [os.path.join(HERE, NAME), 'trial:=' + trial, 'budget:="30"']
    files = [(roslaunch.rlutil.resolve_launch_arguments(words)[0], words[1:])]
    parent = ROSLaunchParent('run_trials', files, is_core=True)
    parent.start()
    rospy.init_node('run_trials', anonymous=True)
    places = []
    subscriber = rospy.Subscriber('/robot_0/robot_pose', PoseStamped,
                                  lambda message, places=places: places.append(message.pose.position.x))
    while not rospy.is_shutdown():
        is_over = False
        try:
            is_over = rospy.wait_for_message('/budget_elapsed', Bool, timeout=1).data
        except rospy.ROSException:
            pass
        if is_over:
            rospy.loginfo('trial %s over at %.3f s, at %s', trial, rospy.get_time(), places[-1])
            parent.shutdown()
            break
