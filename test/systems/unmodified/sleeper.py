#!/usr/bin/env python3
"""Wait some seconds for the others, then become a node and call a service."""
import time

import rospy
from std_srvs.srv import Trigger

time.sleep(1.0)
time.sleep(2.0)
rospy.init_node('sleeper')
print('%.9f %s' % (rospy.get_time(), rospy.ServiceProxy('/store/stock', Trigger)().message))
