#!/usr/bin/env python3
"""Waits for a bag, and plays it as fast as it was recorded."""
import rosbag
import rospy
from std_msgs.msg import Float64

path = rospy.myargv()[1]
rospy.init_node('player')
rospy.sleep(0.05)
bag = None
while bag is None:
    rospy.sleep(0.5)
    try:
        bag = rosbag.Bag(path)
    except (IOError, rosbag.ROSBagException):
        print('%.9f not yet' % rospy.get_time())
pub = rospy.Publisher('played', Float64, queue_size=100)
rospy.sleep(1.0)
offset = None
for topic, msg, t in bag.read_messages(topics=['numbers']):
    if offset is None:
        offset = rospy.Time.now() - t
    rospy.sleep(t + offset - rospy.Time.now())
    pub.publish(msg)
    print('%.9f %.1f' % (rospy.get_time(), msg.data))
