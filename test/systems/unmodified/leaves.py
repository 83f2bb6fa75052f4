#!/usr/bin/env python3
"""Writes a temporary file that it does not remove, and publishes its name."""
import tempfile

import rospy
from std_msgs.msg import String

rospy.init_node('leaves')
left = rospy.Publisher('/left', String, queue_size=1, latch=True)
rospy.Subscriber('/left', String, lambda message: None)
with tempfile.NamedTemporaryFile('w', delete=False) as stream:
    stream.write('kept')
left.publish(stream.name)
rospy.sleep(1.0)
