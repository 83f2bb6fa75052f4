#!/usr/bin/env python3
"""An onlooker that listens to the topic argv[1] of texts, and sets /onlooker_hears when it is connected."""
import sys
import time

import rospy
from std_msgs.msg import String

rospy.init_node('onlooker', anonymous=True, disable_rostime=True)
subscriber = rospy.Subscriber(sys.argv[1], String, lambda message: None)
while subscriber.get_num_connections() < 1 and not rospy.is_shutdown():
    time.sleep(0.01)
rospy.set_param('/onlooker_hears', True)
rospy.spin()
