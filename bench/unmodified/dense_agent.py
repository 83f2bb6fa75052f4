#!/usr/bin/env python3
"""A user's node of a dense system, which knows nothing of a simulator: the agent of one robot among several.

usage: dense_agent.py ROBOT INDEX
"""

import random
import sys
import threading

import actionlib
import rospy
import tf2_ros
from geometry_msgs.msg import PointStamped
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal

LOOP_HZ = 30.0
SPACING = 2.0  # m, between the robots' lanes


class Agent:
    """Drives its robot to and fro, and publishes the robot's position for the other agents."""

    def __init__(self, robot, index):
        self._robot = robot
        self._y = SPACING * index
        self._x = 0.0
        self._random = random.Random(index)
        self._is_idle = threading.Event()
        self._is_idle.set()
        self._count = 0
        self._buffer = tf2_ros.Buffer()
        self._listener = tf2_ros.TransformListener(self._buffer)
        self._client = actionlib.SimpleActionClient(f'/{robot}/move_base', MoveBaseAction)
        self._positions = rospy.Publisher('/positions', PointStamped, queue_size=100)
        rospy.Subscriber('/positions', PointStamped, self._on_position)

    def run(self):
        """Send goals until the node is shut down."""
        self._client.wait_for_server()
        rate = rospy.Rate(LOOP_HZ)
        while not rospy.is_shutdown():
            if self._is_idle.is_set():
                self._is_idle.clear()
                self._send_goal()
            rate.sleep()

    def _send_goal(self):
        length = self._random.uniform(5.0, 25.0)
        self._x += length if self._x <= 0.0 else -length
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id = 'map'
        goal.target_pose.header.stamp = rospy.Time.now()
        goal.target_pose.pose.position.x = self._x
        goal.target_pose.pose.position.y = self._y
        goal.target_pose.pose.orientation.w = 1.0
        self._client.send_goal(goal, self._on_end, feedback_cb=lambda _feedback: self._send_position())

    def _on_end(self, _state, _result):
        self._send_position()
        self._is_idle.set()

    def _send_position(self):
        try:
            pose = self._buffer.lookup_transform('map', self._robot + '/base_link', rospy.Time(0))
        except tf2_ros.TransformException:
            return
        position = PointStamped()
        position.header.stamp = pose.header.stamp
        position.header.frame_id = self._robot
        position.point.x, position.point.y = pose.transform.translation.x, pose.transform.translation.y
        self._positions.publish(position)

    def _on_position(self, _position):
        self._count += 1


def main():
    """Run the agent."""
    rospy.init_node('agent')
    try:
        Agent(sys.argv[1], int(sys.argv[2])).run()
    except rospy.ROSInterruptException:
        pass


if __name__ == '__main__':
    main()
