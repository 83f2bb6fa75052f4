#!/usr/bin/python3
"""A stand-in for stage_ros as a process that can be killed and started again: clock, truth, odometry, tf, cmd_pose.

usage: stage_stand_in.py BEGIN NAME X Y [NAME X Y ...]    (X, Y [m]: start of a robot in Stage's world)

Time begins at BEGIN [s], which is 0 for a Stage that has just started, and moves by 0.1 s every 0.02 s of wall time.
Like Stage, it uses its own clock for stamps, whatever comes on /clock, and its odometry, with "gps", is the pose in its
world.
"""
import sys
import time

import rospy
import tf2_ros
from geometry_msgs.msg import Pose
from nav_msgs.msg import Odometry
from robot_harness import to_transform
from rosgraph_msgs.msg import Clock

from move_base_abstract.common.units import seconds_to_ns
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract_ros.messages import conversions

STEP_NS = 100_000_000
PERIOD = 0.02  # s, wall


class Robot:
    def __init__(self, name, pose):
        self._name = name
        self._pose = pose
        self._odom = rospy.Publisher(f'/{name}/odom', Odometry, queue_size=10)
        self._truth = rospy.Publisher(f'/{name}/base_pose_ground_truth', Odometry, queue_size=10)
        rospy.Subscriber(f'/{name}/cmd_pose', Pose, self._on_cmd_pose, queue_size=10)

    def _on_cmd_pose(self, message):
        self._pose = conversions.from_pose(message)

    def tell(self, stamp_ns):
        """Publish the pose of the robot; return odom -> base_link."""
        frame = f'{self._name}/odom'
        message = Odometry(header=conversions.to_header(frame, stamp_ns))
        message.pose.pose = conversions.to_pose(self._pose)
        self._odom.publish(message)
        self._truth.publish(message)
        return to_transform(self._pose, frame, f'{self._name}/base_link', stamp_ns)


def main():
    begin, *words = rospy.myargv()[1:]
    rospy.init_node('stageros')
    robots = [Robot(name, Pose2D(float(x), float(y))) for name, x, y in zip(*[iter(words)] * 3)]
    clock = rospy.Publisher('/clock', Clock, queue_size=10)
    tf = tf2_ros.TransformBroadcaster()
    stamp_ns = seconds_to_ns(float(begin))
    while not rospy.is_shutdown():
        stamp_ns += STEP_NS
        tf.sendTransform([robot.tell(stamp_ns) for robot in robots])
        clock.publish(Clock(conversions.to_time(stamp_ns)))
        time.sleep(PERIOD)


if __name__ == '__main__':
    sys.exit(main())
