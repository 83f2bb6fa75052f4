#!/usr/bin/env python3
"""A user's script that only starts a node."""

import rospy

rospy.init_node('starts')
print('started', flush=True)
