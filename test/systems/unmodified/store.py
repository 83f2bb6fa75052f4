#!/usr/bin/env python3
"""A store that opens after a while."""
import rospy
from std_msgs.msg import Int32
from std_srvs.srv import Trigger, TriggerResponse

rospy.init_node('store')
sold = rospy.Publisher('~sold', Int32, queue_size=1)
rospy.sleep(1.5)
rospy.Service('~stock', Trigger, lambda request: TriggerResponse(True, '%d pieces' % (rospy.get_time() * 1e3)))
rospy.sleep(0.505)
rospy.set_param('~open', True)
rospy.spin()
