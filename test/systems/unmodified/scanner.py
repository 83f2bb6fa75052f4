#!/usr/bin/env python3
"""Print a robot's laser scans and its pose from tf at the same instants, while another robot drives by."""
import hashlib
import struct

import rospy
import tf2_ros
from geometry_msgs.msg import PoseStamped
from sensor_msgs.msg import LaserScan


def on_scan(scan):
    place = buffer.lookup_transform('map', scan.header.frame_id, scan.header.stamp).transform
    print('scan', scan.header.stamp, hashlib.sha1(struct.pack('<%df' % len(scan.ranges), *scan.ranges)).hexdigest(),
          len(scan.ranges), scan.angle_increment, '%.9f' % place.translation.x, '%.9f' % place.translation.y,
          place.translation.z)


rospy.init_node('scanner')
buffer = tf2_ros.Buffer(debug=False)
listener = tf2_ros.TransformListener(buffer)
rospy.Subscriber('/robot_0/' + rospy.get_param('~topic', 'scan'), LaserScan, on_scan)
goals = [rospy.Publisher('/robot_%d/move_base_simple/goal' % i, PoseStamped, queue_size=1, latch=True) for i in range(2)]
rospy.sleep(1.5)
for number, goal in enumerate(goals):
    target = PoseStamped()
    target.header.frame_id = 'map'
    target.pose.position.x, target.pose.position.y = 13.0 - number, 6.0 - 2.0 * number
    target.pose.orientation.w = 1.0
    goal.publish(target)
rospy.spin()
