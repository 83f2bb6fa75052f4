#!/usr/bin/env python3
"""A depot that gives out tools; a request takes 0.3 s."""
import rospy
from std_srvs.srv import SetBool, SetBoolResponse, Trigger, TriggerResponse

tools = 2


def take(request):
    global tools
    rospy.sleep(0.3)
    if tools == 0:
        return TriggerResponse(success=False, message='none left')
    tools -= 1
    return TriggerResponse(success=True, message='%d left' % tools)


def give(request):
    global tools
    if not request.data:
        raise ValueError('what shall I do with that?')
    tools += 1
    return SetBoolResponse(success=True)


if __name__ == '__main__':
    rospy.init_node('depot')
    rospy.sleep(2.0)  # takes its time to start
    rospy.Service('~take', Trigger, take)
    rospy.Service('~give', SetBool, give)
    rospy.spin()
