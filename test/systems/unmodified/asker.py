#!/usr/bin/env python3
"""Takes tools from the depot and gives them back."""
import rospy
from std_srvs.srv import SetBool, Trigger

rospy.init_node('worker')
persistent = rospy.get_param('~persistent', False)
try:
    rospy.wait_for_service('/depot/take', timeout=1.0)
except rospy.ROSException as e:
    print('%.9f %s' % (rospy.get_time(), e))
rospy.wait_for_service('/depot/take')
take = rospy.ServiceProxy('/depot/take', Trigger, persistent=persistent)
give = rospy.ServiceProxy('/depot/give', SetBool, persistent=persistent)
for i in range(6):
    answer = take()
    print('%.9f %s %s' % (rospy.get_time(), answer.success, answer.message))
    if answer.success:
        rospy.sleep(0.5)
        give(True)
    else:
        rospy.sleep(0.1)
try:
    give(False)
except rospy.ServiceException as e:
    print('%.9f %s' % (rospy.get_time(), e))
