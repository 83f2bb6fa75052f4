#!/usr/bin/env python3
"""Print the poses that robots publish, and drive one robot for a while."""
import rospy
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from nav_msgs.msg import Odometry


def hear(robot, topic, kind):
    rospy.Subscriber('/%s/%s' % (robot, topic), kind, lambda message: print(
        robot, topic, message.header.stamp, message.pose.pose.position.x,
        getattr(message, 'twist', None) and message.twist.twist.linear.x))


rospy.init_node('odometer')
goal = rospy.Publisher('/robot_0/move_base_simple/goal', PoseStamped, queue_size=1, latch=True)
for robot in ('robot_0', 'robot_1'):
    hear(robot, 'odom', Odometry)
    hear(robot, 'base_pose_ground_truth', Odometry)
    hear(robot, 'amcl_pose', PoseWithCovarianceStamped)
rospy.sleep(rospy.Duration(2, 50000000))
target = PoseStamped()
target.header.frame_id = 'map'
target.pose.position.x = 1.0
target.pose.orientation.w = 1.0
goal.publish(target)
rospy.spin()
