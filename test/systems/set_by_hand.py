#!/usr/bin/env python3
"""Set a parameter that a node of a run has asked for, as rosparam does, until the run is labelled."""
import sys
import time

import rosgraph
import rospy

from move_base_abstract.msg import TimeState

rospy.init_node('hand', disable_rostime=True)
master = rosgraph.Master('/hand')
while not master.hasParam('/waits'):
    time.sleep(0.02)
master.setParam('/of_no_interest', 1)
master.setParam(sys.argv[1], True)
while not rospy.wait_for_message('/time_master/state', TimeState).not_repeatable_because:
    pass
master.setParam(sys.argv[1], False)
