#!/usr/bin/env python3
"""See who is there at the start, in three ways, and later who has come."""
import time

import rosgraph
import rospy

time.sleep(0.1)
rospy.init_node('census')
topics = sorted(name for name, kind in rospy.get_published_topics() if name.startswith('/link_'))
print('%.9f %d: %s' % (rospy.get_time(), len(topics), ' '.join(topics)))
publishers = rosgraph.Master('/census').getSystemState()[0]
print('%.9f %d' % (rospy.get_time(), len([name for name, nodes in publishers if name.startswith('/link_')])))
while not [name for name, kind in rospy.get_published_topics() if name == '/late']:
    pass
print('%.9f late' % rospy.get_time())
