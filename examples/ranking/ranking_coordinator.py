#!/usr/bin/env python3
"""Sends robots to the tasks of a mission by stock actionlib, with the real move_base or with this package.

Parameters: ~policy, ~robots (as in a scenario), ~tasks ([x, y, yaw] each; m, m, rad; frame map), ~wait [s] before the
first goal, ~limit [s], and ~output, a file to which a line of JSON is added.
"""
import json
import math
import os
import sys
import threading

import actionlib
import rospy
from geometry_msgs.msg import Quaternion
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from dispatching import Dispatcher  # noqa: E402


class Coordinator:
    """Sends the goals that the dispatcher chooses; ``over_at`` [s] is set when no task is left."""

    def __init__(self, robots, tasks, policy):
        self._lock = threading.RLock()
        self._tasks = tasks
        self.dispatcher = Dispatcher(policy, [(robot['start_x'], robot['start_y']) for robot in robots],
                                     [tuple(task[:2]) for task in tasks])
        self._clients = [actionlib.ActionClient('/{}/move_base'.format(robot['name']), MoveBaseAction)
                         for robot in robots]
        self._handles = {}  # kept, since actionlib reports nothing for a handle that was deleted
        self.over_at = None  # s
        for client in self._clients:
            client.wait_for_server()

    def begin(self):
        """Send each robot that gets a task now."""
        with self._lock:
            for number, task in self.dispatcher.begin(rospy.get_time()):
                self._send(number, task)
            if self.dispatcher.over:
                self.over_at = rospy.get_time()

    def _send(self, number, task):
        x, y, yaw = self._tasks[task]
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id = 'map'
        goal.target_pose.header.stamp = rospy.Time.now()
        goal.target_pose.pose.position.x, goal.target_pose.pose.position.y = x, y
        goal.target_pose.pose.orientation = Quaternion(0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw))
        # a simple client takes no goal in its own callback
        self._handles[number] = self._clients[number].send_goal(
            goal, lambda handle: self._changed(number, task, handle))

    def _changed(self, number, task, handle):
        if handle.get_comm_state() != actionlib.CommState.DONE:
            return
        state = handle.get_terminal_state()
        rospy.loginfo('robot_%d, task %d: %s', number, task, actionlib.TerminalState.to_string(state))
        with self._lock:
            self.dispatcher.ended(number, state == actionlib.TerminalState.SUCCEEDED)
            self.begin()

    def stop(self):
        """Cancel all goals."""
        for client in self._clients:
            client.cancel_all_goals()


def main():
    """Run one mission."""
    rospy.init_node('coordinator')
    policy, robots = rospy.get_param('~policy'), rospy.get_param('~robots')
    coordinator = Coordinator(robots, rospy.get_param('~tasks'), policy)
    rospy.sleep(rospy.get_param('~wait', 1.0))  # until the costmaps are there
    start, limit = rospy.get_time(), rospy.get_param('~limit', 900.0)
    coordinator.begin()
    while coordinator.over_at is None and rospy.get_time() - start < limit and not rospy.is_shutdown():
        rospy.sleep(1.0)
    over_at = coordinator.over_at
    row = {'policy': policy, 'robots': len(robots), 'ended': over_at is not None,
           'mission_s': round((start + limit if over_at is None else over_at) - start, 3),
           'done': len(coordinator.dispatcher.done), 'failed': len(coordinator.dispatcher.failed)}
    coordinator.stop()
    rospy.loginfo('%s', json.dumps(row))
    if rospy.get_param('~output', ''):
        with open(rospy.get_param('~output'), 'a') as file:
            file.write(json.dumps(row) + '\n')


if __name__ == '__main__':
    main()
