#!/usr/bin/env python3
"""Calls a service of another node as soon as the service is there."""
import time

import rospy
from roscpp.srv import GetLoggers

rospy.init_node('asks')
ask = rospy.ServiceProxy('/other/get_loggers', GetLoggers)
for _ in range(200):
    try:
        print('answered: %s' % bool(ask().loggers))
        break
    except rospy.ServiceException:
        time.sleep(0.1)
