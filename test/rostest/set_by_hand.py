#!/usr/bin/env python3
"""Set a parameter when a node of a run has asked for it for a while, as somebody with rosparam."""
import sys
import time

import rosgraph

master = rosgraph.Master('/hand')
while not master.hasParam('/waits'):
    time.sleep(0.02)
master.setParam('/of_no_interest', 1)
master.setParam(sys.argv[1], True)
