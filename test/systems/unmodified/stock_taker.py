#!/usr/bin/env python3
"""Wait for the store, ask for its stock and list its topics; become a node only after that."""
import time

import rospy
from std_srvs.srv import Trigger

time.sleep(0.2)  # let the others start
rospy.wait_for_service('/store/stock')
answer = rospy.ServiceProxy('/store/stock', Trigger)()
topics = sorted(name for name, kind in rospy.get_published_topics() if name.startswith('/store'))
while not rospy.has_param('/store/open'):
    pass
rospy.init_node('stock_taker')
print('%.9f %s %s' % (rospy.get_time(), answer.message, topics))
rospy.sleep(1.0)
print('%.9f %s' % (rospy.get_time(), rospy.ServiceProxy('/store/stock', Trigger)().message))
pub = rospy.Publisher('~stock', rospy.AnyMsg, queue_size=1)
