#!/usr/bin/env python3
"""Waits for messages of the battery, one after the other, and charges it when it is low."""
import rospy
from std_msgs.msg import Empty, Float32

rospy.init_node('charger')
pub = rospy.Publisher('charge', Empty, queue_size=1)
for i in range(10):
    try:
        level = rospy.wait_for_message('battery', Float32, timeout=0.75).data
        print('%.9f level %.2f' % (rospy.get_time(), level))
        if level < 0.9:
            pub.publish()
    except rospy.ROSException as e:
        print('%.9f %s' % (rospy.get_time(), e))
