#!/usr/bin/env python3
"""Publishes its name when it has started, and each time it is asked."""
import rospy
from std_msgs.msg import String


def main():
    """Run until the node is shut down."""
    rospy.init_node('robot')
    hello = rospy.Publisher('hello', String, queue_size=1)
    name = rospy.get_namespace().strip('/')
    rospy.Subscriber('/who', String, lambda _: hello.publish(name))
    rospy.sleep(0.03)  # s that the robot takes to start
    hello.publish(name)
    rospy.spin()


if __name__ == '__main__':
    main()
