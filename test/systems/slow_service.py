#!/usr/bin/env python3
"""A node that takes no part: its service sleeps for a simulated second before it answers."""
import rospy
from std_srvs.srv import Trigger, TriggerResponse


def answer(_request):
    rospy.sleep(1.0)
    return TriggerResponse(success=True)


rospy.init_node('slow')
rospy.Service('/slow', Trigger, answer)
rospy.spin()
