#!/usr/bin/env python3
"""Have a library do a loop, as programs do that use OpenCV: the library's path, and the number of threads (0: its own)."""
import ctypes
import sys

import rospy

rospy.init_node('pool')
rospy.sleep(1.0)
print('threads:', ctypes.CDLL(sys.argv[1]).tbb_stand_in_loop(int(sys.argv[2])), rospy.get_time())
rospy.sleep(1.0)
