#!/usr/bin/env python3
"""A user's script: a loop at 1 Hz. usage: poller.py TICKS."""

import json
import sys
import time

import rospy

rospy.init_node('poller')
rate = rospy.Rate(1)
count = int(sys.argv[1])
first = rospy.Time.now()
begin = time.perf_counter()
for _ in range(count):
    rate.sleep()
wall = time.perf_counter() - begin
is_exact = (rospy.Time.now() - first).to_nsec() == count * 1000000000
print(json.dumps({'per_s': count / wall, 'exact': is_exact}), flush=True)
