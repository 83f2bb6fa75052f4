#!/usr/bin/env python3
"""A user's script that waits by looking at a variable, without sleeping. usage: looker.py SECONDS."""

import json
import sys

import rospy

rospy.init_node('looker')
ends = []
seconds = int(sys.argv[1])
first = rospy.Time.now()
rospy.Timer(rospy.Duration(seconds), ends.append, oneshot=True)
print('begin', flush=True)
while not ends:
    pass
is_exact = (rospy.Time.now() - first).to_nsec() == seconds * 1000000000
print(json.dumps({'count': seconds, 'exact': is_exact}), flush=True)
