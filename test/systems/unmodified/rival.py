#!/usr/bin/env python3
"""Wait for the messages of another node in a loop without sleep, as that node does itself."""
import rospy
from std_msgs.msg import String

rospy.init_node('rival')
told = []
rospy.Subscriber('/events', String, told.append)
while not rospy.is_shutdown() and len(told) < 2:
    pass
print('%.9f %s' % (rospy.get_time(), [message.data for message in told]))
