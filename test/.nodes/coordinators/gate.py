#!/usr/bin/env python3
"""Waits to be opened. It is an error if that does not happen within 10 s."""
import rospy
from std_msgs.msg import Empty


def main():
    """Run for 10 s."""
    rospy.init_node('gate')
    opened = []
    rospy.Subscriber('open', Empty, opened.append)
    rospy.sleep(10.0)
    if not opened:
        raise RuntimeError('nobody has opened the gate')


if __name__ == '__main__':
    main()
