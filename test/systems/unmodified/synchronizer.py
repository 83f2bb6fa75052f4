#!/usr/bin/env python3
"""Combines the measurements of two sensors at the same time, and at about the same time."""
import message_filters
import rospy
from geometry_msgs.msg import PointStamped


def exact(left, right):
    print('%.9f exact %.3f %.0f %.0f' % (rospy.get_time(), left.header.stamp.to_sec(), left.point.x, right.point.x))


def about(left, right):
    print('%.9f about %.3f %.3f' % (rospy.get_time(), left.header.stamp.to_sec(), right.header.stamp.to_sec()))


rospy.init_node('synchronizer')
left = message_filters.Subscriber('left', PointStamped)
right = message_filters.Subscriber('right', PointStamped)
message_filters.TimeSynchronizer([left, right], 10).registerCallback(exact)
message_filters.ApproximateTimeSynchronizer([left, right], 10, 0.11).registerCallback(about)
cache = message_filters.Cache(left, 100)
rospy.sleep(6.0)
print('%.9f %d since 3' % (rospy.get_time(), len(cache.getInterval(rospy.Time(3.0), rospy.Time.now()))))
