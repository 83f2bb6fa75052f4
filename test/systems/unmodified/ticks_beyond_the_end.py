#!/usr/bin/env python3
"""Prints after each sleep. Its log is slow, so that it takes long to shut down."""
import logging
import select
import time

import rospy


class SlowLog(logging.Handler):
    def emit(self, record):
        select.select([], [], [], 1.5)


rospy.init_node('ticks')
logging.getLogger('rosout').addHandler(SlowLog(logging.FATAL))
while not rospy.is_shutdown():
    time.sleep(0.5)
    print('tick')
