#!/usr/bin/env python3
"""Gives each task, in the order of arrival, to the nearest idle robot. It uses stock actionlib and nothing else."""
import threading
from math import hypot

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from nav_msgs.msg import Odometry

from move_base_abstract.msg import PlaceTaskAction, PlaceTaskGoal, Task

lock, tasks, idle = threading.RLock(), [], []


class Robot:
    """One robot, which drives to a task and works there."""

    def __init__(self, name):
        self.name = name
        self.drive = actionlib.SimpleActionClient('/{}/move_base'.format(name), MoveBaseAction)
        self.work = actionlib.SimpleActionClient('/{}/work'.format(name), PlaceTaskAction)
        self.drive.wait_for_server()
        self.work.wait_for_server()
        self.at = rospy.wait_for_message('/{}/base_pose_ground_truth'.format(name), Odometry).pose.pose.position

    def do(self, task):
        """Begin a task; :func:`done` is called when it has ended."""
        def arrived(state, _):
            if state != GoalStatus.SUCCEEDED:
                return done(self, task, state)
            return self.work.send_goal(PlaceTaskGoal(task), lambda end, _: done(self, task, end))
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id, goal.target_pose.pose = task.header.frame_id, task.pose
        self.at = task.pose.position
        self.drive.send_goal(goal, arrived)


def assign(new_tasks=(), new_idle=()):
    """Note new tasks and new idle robots, then give each waiting task, oldest first, to the nearest idle robot."""
    with lock:
        tasks.extend(new_tasks)
        idle.extend(new_idle)
        while tasks and idle:
            task = tasks.pop(0)
            place = task.pose.position
            robot = min(idle, key=lambda one: hypot(one.at.x - place.x, one.at.y - place.y))
            idle.remove(robot)
            robot.do(task)


def done(robot, task, state):
    """Log how a task ended, and give the robot its next task."""
    took = (rospy.Time.now() - task.header.stamp).to_sec()
    rospy.loginfo('%s by %s after %.3f s: %s', task.id, robot.name, took, GoalStatus.to_string(state))
    assign(new_idle=[robot])


rospy.init_node('coordinator')
robots = [Robot(name) for name in rospy.get_param('~robots')]  # kept, or Python would delete a robot that is not idle
assign(new_idle=robots)
rospy.Subscriber('/tasks', Task, lambda task: assign([task]), queue_size=1000)
rospy.spin()
