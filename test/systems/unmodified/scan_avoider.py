#!/usr/bin/env python3
"""Drives one robot by its scans, and by nothing else: ahead while there is room, otherwise it turns to the left."""
import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import LaserScan


class Avoider(object):
    def __init__(self, wanted):
        self.left = wanted
        self.turns = 0
        self.commands = rospy.Publisher('cmd_vel', Twist, queue_size=1)
        rospy.Subscriber('base_scan', LaserScan, self.on_scan, queue_size=1)

    def on_scan(self, scan):
        if not self.left:
            return
        self.left -= 1
        middle, width = len(scan.ranges) // 2, len(scan.ranges) // 12
        ahead = min(scan.ranges[middle - width:middle + width])
        command = Twist()
        if ahead > 1.0:
            command.linear.x = 0.5
        else:
            self.turns += 1
            command.angular.z = 0.6
        self.commands.publish(command)
        print('%.9f %s %.6f' % (scan.header.stamp.to_sec(), scan.header.frame_id, ahead))


if __name__ == '__main__':
    rospy.init_node('avoider')
    avoider = Avoider(rospy.get_param('~scans', 60))
    while not rospy.is_shutdown() and avoider.left:
        rospy.sleep(0.5)
    print('turned away at %d scans' % avoider.turns)
