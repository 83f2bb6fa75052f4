#!/usr/bin/env python3
"""Never come to an end of one thought."""
import itertools

import rospy


def brood():
    return any(number < 0 for number in itertools.count())


rospy.init_node('brooder')
brood()
