#!/usr/bin/env python3
"""List the topics and nodes at the start in three ways, and wait for a late topic."""
import time
from xmlrpc.client import ServerProxy

import rosgraph
import rospy
import rostopic

time.sleep(0.1)
rospy.init_node('census')
topics = [name for name, kind in rospy.get_published_topics() if name.startswith('/link_')]
print('%.9f %d: %s' % (rospy.get_time(), len(topics), ' '.join(topics)))
publishers, _, services = rosgraph.Master('/census').getSystemState()
print('%.9f %s' % (rospy.get_time(), ' '.join(name for name, nodes in publishers if name.startswith('/link_'))))
print(' '.join(dict(publishers)['/rosout']))
assert [name for name, nodes in services] == sorted(name for name, nodes in services)
# The answer is the same in each way of asking.
assert topics == [name for name, kind in ServerProxy(rosgraph.get_master_uri()).getTopicTypes('/census')[2]
                  if name.startswith('/link_')]
assert rostopic.find_by_type('std_msgs/String') == topics
names = rospy.get_param_names()
assert names == sorted(names) and list(rospy.get_param('/time_master')) == sorted(rospy.get_param('/time_master'))
while not [name for name, kind in rospy.get_published_topics() if name == '/late']:
    pass
print('%.9f late' % rospy.get_time())
