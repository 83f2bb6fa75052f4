#!/usr/bin/env python3
"""Give the others some seconds, then become a node and ask."""
import time

import rospy
from std_srvs.srv import Trigger

time.sleep(1.0)
time.sleep(2.0)
rospy.init_node('sleeper')
print('%.9f %s' % (rospy.get_time(), rospy.ServiceProxy('/store/stock', Trigger)().message))
