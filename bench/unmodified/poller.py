#!/usr/bin/env python3
"""A user's script with a loop at 1 Hz. usage: poller.py TICKS."""

import json
import sys

import rospy

rospy.init_node('poller')
rate = rospy.Rate(1)
count = int(sys.argv[1])
first = rospy.Time.now()
print('begin', flush=True)
for _ in range(count):
    rate.sleep()
is_exact = (rospy.Time.now() - first).to_nsec() == count * 1000000000
print(json.dumps({'count': count, 'exact': is_exact}), flush=True)
