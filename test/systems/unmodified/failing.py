#!/usr/bin/env python3
"""A program with a mistake that shows after 1.5 s."""
import rospy


def drive(places):
    return places[3]


def main():
    rospy.init_node('failing')
    rospy.sleep(1.5)
    try:
        drive([])
    except IndexError:
        raise RuntimeError('at %.1f s' % rospy.get_time())


main()
