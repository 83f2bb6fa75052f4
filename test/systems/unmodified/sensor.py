#!/usr/bin/env python3
"""A sensor with a rate and a delay, which counts the messages of the other sensor by AnyMsg."""
import rospy
from geometry_msgs.msg import PointStamped

rospy.init_node('sensor')
pub = rospy.Publisher('~out', PointStamped, queue_size=5)
other = []
rospy.Subscriber('~other', rospy.AnyMsg, other.append)
rate = rospy.Rate(rospy.get_param('~rate'))
delay = rospy.get_param('~delay', 0.0)
count = 0
while not rospy.is_shutdown() and rospy.get_time() < 6.0:
    msg = PointStamped()
    msg.header.stamp = rospy.Time.now()
    msg.point.x = count
    count += 1
    rospy.sleep(delay)
    pub.publish(msg)
    rate.sleep()
print('%.9f %d of mine, %d of the other' % (rospy.get_time(), count, len(other)))
