#!/usr/bin/env python3
"""Calls a service that takes long to answer."""
import rospy
from std_msgs.msg import String
from std_srvs.srv import Trigger

rospy.init_node('asks_slowly')
ticks = rospy.Publisher('ticks', String, queue_size=1)
timer = rospy.Timer(rospy.Duration(0.1), lambda event: ticks.publish('tick'))
rospy.wait_for_service('/slow')
begin = rospy.get_time()
print('answered: %s' % rospy.ServiceProxy('/slow', Trigger)().success)
print('later: %s' % (rospy.get_time() >= begin + 1.0))
timer.shutdown()
