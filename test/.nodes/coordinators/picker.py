#!/usr/bin/env python3
"""Picks ten times, first ~first [s] after the beginning and then once a second."""
import rospy
from std_msgs.msg import Empty, Int32


def main():
    """Run until the node is shut down."""
    rospy.init_node('picker')
    picked = rospy.Publisher('picked', Int32, queue_size=10)
    rospy.wait_for_message('/begin', Empty)
    rospy.sleep(rospy.get_param('~first'))
    for _ in range(10):
        picked.publish(1)
        rospy.sleep(1.0)
    rospy.spin()


if __name__ == '__main__':
    main()
