#!/usr/bin/env python3
"""Compute for ever in one call."""
import itertools

import rospy


def brood():
    return any(number < 0 for number in itertools.count())


rospy.init_node('brooder')
brood()
