#!/usr/bin/env python3
"""Set a parameter in the middle of a turn that takes wall time; send a message; have a program read it."""
import subprocess
import sys
import time

import rospy
from std_msgs.msg import String

LOOK = 'import os, rosgraph; print("seen", rosgraph.Master("/look").getParam("/errand"), flush=True)'

rospy.init_node('messenger')
said = rospy.Publisher('/said', String, queue_size=1)
rospy.sleep(1.0)
rospy.set_param('/errand', 'half')
time.sleep(0.3)  # s, wall
rospy.set_param('/errand', 'done')
said.publish('look')
rospy.sleep(1.0)
if 'start' in sys.argv:
    rospy.set_param('/errand', 'for a program')
    subprocess.check_call([sys.executable, '-c', LOOK])
rospy.set_param('/errand', 'the last')
