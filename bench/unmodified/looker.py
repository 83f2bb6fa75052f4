#!/usr/bin/env python3
"""A user's script that waits by looking at a variable, without sleeping. usage: looker.py SECONDS."""

import json
import sys

import rospy

rospy.init_node('looker')
is_over = False


def end(_event):
    """End the wait."""
    global is_over
    is_over = True


seconds = int(sys.argv[1])
first = rospy.Time.now()
rospy.Timer(rospy.Duration(seconds), end, oneshot=True)
print('begin', flush=True)
while not is_over:
    pass
is_exact = (rospy.Time.now() - first).to_nsec() == seconds * 1000000000
print(json.dumps({'count': seconds, 'exact': is_exact}), flush=True)
