#!/usr/bin/env python3
"""Read parameters at a rate, in all ways that rospy has."""
import sys

import rosgraph
import rosparam
import rospy

rospy.init_node('reader')
rate = rospy.Rate(float(sys.argv[1]))
master = rosgraph.Master(rospy.get_name())
for _ in range(int(sys.argv[2])):
    latest = [rospy.get_param('/board/latest', None), rospy.get_param_cached('/board/latest', None),
              rosparam.get_param('/board').get('latest') if rospy.has_param('/board') else None]
    assert latest[0] == latest[1] == latest[2], latest
    print('%.3f' % rospy.get_time(), latest[0], rospy.get_param('/board', {}), rospy.search_param('board/latest'),
          master.hasParam('/board/a'), [name for name in rospy.get_param_names() if name.startswith('/board')])
    rate.sleep()
