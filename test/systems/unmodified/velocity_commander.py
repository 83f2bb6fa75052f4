#!/usr/bin/env python3
"""Drives one robot round and round by velocities at 10 Hz, as many controllers do, and looks at odometry and tf."""
import math

import rospy
import tf2_ros
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry


class Commander(object):
    def __init__(self):
        self.odometry = None
        self.heard = 0
        self.commands = rospy.Publisher('cmd_vel', Twist, queue_size=1)
        rospy.Subscriber('odom', Odometry, self.on_odometry)
        self.buffer = tf2_ros.Buffer()
        self.listener = tf2_ros.TransformListener(self.buffer)

    def on_odometry(self, message):
        self.odometry = message
        self.heard += 1

    def turn_of(self, seconds):
        """Drive straight for two seconds, then turn for one."""
        command = Twist()
        if seconds % 3.0 < 2.0:
            command.linear.x = 0.4
        else:
            command.linear.x = 0.1
            command.angular.z = math.pi / 2.0
        return command

    def run(self, frames, seconds):
        rate = rospy.Rate(10)
        begin = rospy.get_time()
        while not rospy.is_shutdown() and rospy.get_time() - begin < seconds:
            self.commands.publish(self.turn_of(rospy.get_time() - begin))
            rate.sleep()
        rospy.sleep(2.0)  # the watchdog stops the robot meanwhile
        pose, speed = self.odometry.pose.pose, self.odometry.twist.twist.linear.x
        seen = self.buffer.lookup_transform(frames + 'odom', frames + 'base_link', rospy.Time(0)).transform
        print('%.9f odometry %.9f %.9f %.9f at %.3f m/s, %d heard, in %s; tf %.9f %.9f' % (
            rospy.get_time(), pose.position.x, pose.position.y, pose.orientation.z, speed, self.heard,
            self.odometry.header.frame_id, seen.translation.x, seen.translation.y))


if __name__ == '__main__':
    rospy.init_node('commander')
    commander = Commander()
    rospy.wait_for_message('odom', Odometry)
    commander.run(rospy.get_param('~frames', ''), rospy.get_param('~seconds', 12.0))
