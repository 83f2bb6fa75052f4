#!/usr/bin/env python3
"""A user's script that does nothing but start."""

import rospy

rospy.init_node('starts')
print('started', flush=True)
