#!/usr/bin/env python3
"""Robots that drive as cmd_vel says, for systems that steer by velocities: odometry and tf ten times a second.

Parameters: ~robots, {name: [x, y, yaw]} [m, m, rad]; ~frame and ~base, the names of frames, with {} for the robot's
name; ~is_holonomic, whether linear.y counts.
"""
import math

import rospy
from geometry_msgs.msg import TransformStamped, Twist
from nav_msgs.msg import Odometry
from tf2_ros import TransformBroadcaster

PERIOD = 0.1  # s, simulated


class Robot:
    """One robot: where it is, and the velocity that it has been told."""

    def __init__(self, name, pose):
        """Begin at ``pose``."""
        self.x, self.y, self.yaw = map(float, pose)
        self.told = Twist()
        self.frame, self.base = (rospy.get_param(key, default).format(name) for key, default in (
            ('~frame', '{}/odom'), ('~base', '{}/base_link')))
        self.odometry = rospy.Publisher('/{}/odom'.format(name), Odometry, queue_size=1)
        rospy.Subscriber('/{}/cmd_vel'.format(name), Twist, self._hear)

    def _hear(self, twist):
        self.told = twist

    def drive(self, is_holonomic):
        """Go on for one period."""
        forward, aside = self.told.linear.x, self.told.linear.y if is_holonomic else 0.0
        self.x += PERIOD * (forward * math.cos(self.yaw) - aside * math.sin(self.yaw))
        self.y += PERIOD * (forward * math.sin(self.yaw) + aside * math.cos(self.yaw))
        self.yaw += PERIOD * self.told.angular.z

    def tell(self, now, tree):
        """Publish the odometry, and the frame."""
        said = Odometry()
        said.header.stamp, said.header.frame_id, said.child_frame_id = now, self.frame, self.base
        said.pose.pose.position.x, said.pose.pose.position.y = self.x, self.y
        said.pose.pose.orientation.z, said.pose.pose.orientation.w = math.sin(self.yaw / 2), math.cos(self.yaw / 2)
        said.twist.twist = self.told
        self.odometry.publish(said)
        frame = TransformStamped(said.header, self.base, None)
        frame.transform.translation.x, frame.transform.translation.y = self.x, self.y
        frame.transform.rotation = said.pose.pose.orientation
        tree.sendTransform(frame)


def main():
    """Drive until the run is over."""
    rospy.init_node('velocity_robots')
    is_holonomic, tree = rospy.get_param('~is_holonomic', False), TransformBroadcaster()
    robots = [Robot(name, pose) for name, pose in sorted(rospy.get_param('~robots').items())]
    rate = rospy.Rate(1.0 / PERIOD)
    while not rospy.is_shutdown():
        for robot in robots:
            robot.drive(is_holonomic)
            robot.tell(rospy.Time.now(), tree)
        rate.sleep()


if __name__ == '__main__':
    try:
        main()
    except rospy.ROSInterruptException:
        pass
