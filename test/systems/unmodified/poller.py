#!/usr/bin/env python3
"""Print the robot's position once a second."""
import rospy
from nav_msgs.msg import Odometry


class Poller:
    def __init__(self):
        self.odom = None
        self.count = 0
        rospy.Subscriber('odom', Odometry, self.on_odom)

    def on_odom(self, msg):
        self.odom = msg
        self.count += 1


if __name__ == '__main__':
    rospy.init_node('poller')
    poller = Poller()
    rate = rospy.Rate(rospy.get_param('~rate', 1.0))
    ticks = 0
    while not rospy.is_shutdown() and ticks < rospy.get_param('~ticks', 20):
        rate.sleep()
        ticks += 1
        x = poller.odom.pose.pose.position.x if poller.odom else float('nan')
        print('%.9f tick %d x=%.6f of %d' % (rospy.get_time(), ticks, x, poller.count))
