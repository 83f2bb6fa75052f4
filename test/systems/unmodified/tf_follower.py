#!/usr/bin/env python3
"""Prints the distance of the robot from a landmark that the node itself broadcasts, as in the tf2 tutorial."""
import math

import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped

if __name__ == '__main__':
    rospy.init_node('follower')
    robot = rospy.get_param('~frame', 'robot_0/base_link')
    tf_buffer = tf2_ros.Buffer()
    listener = tf2_ros.TransformListener(tf_buffer)
    broadcaster = tf2_ros.StaticTransformBroadcaster()
    landmark = TransformStamped()
    landmark.header.stamp = rospy.Time.now()
    landmark.header.frame_id = 'map'
    landmark.child_frame_id = 'landmark'
    landmark.transform.translation.x = 10.0
    landmark.transform.rotation.w = 1.0
    broadcaster.sendTransform(landmark)

    first = tf_buffer.lookup_transform('landmark', robot, rospy.Time(0), rospy.Duration(5.0))
    print('%.9f first %.3f' % (rospy.get_time(), first.transform.translation.x))
    rate = rospy.Rate(2.0)
    for i in range(16):
        try:
            now = rospy.Time.now()
            trans = tf_buffer.lookup_transform('landmark', robot, now, rospy.Duration(1.0))
            print('%.9f %.3f of %.3f' % (rospy.get_time(), math.hypot(
                trans.transform.translation.x, trans.transform.translation.y), now.to_sec()))
        except (tf2_ros.LookupException, tf2_ros.ConnectivityException, tf2_ros.ExtrapolationException) as e:
            print('%.9f %s' % (rospy.get_time(), type(e).__name__))
        rate.sleep()
    try:
        tf_buffer.lookup_transform('map', 'nowhere', rospy.Time(0), rospy.Duration(2.0))
    except tf2_ros.LookupException as e:
        print('%.9f %s' % (rospy.get_time(), e))
