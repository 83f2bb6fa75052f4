#!/usr/bin/env python3
"""Introduces itself when it is up, and whenever it is asked."""
import rospy
from std_msgs.msg import String


def main():
    """Run until told to end."""
    rospy.init_node('robot')
    hello = rospy.Publisher('hello', String, queue_size=1)
    name = rospy.get_namespace().strip('/')
    rospy.Subscriber('/who', String, lambda _: hello.publish(name))
    rospy.sleep(0.03)  # s, which it takes to come up
    hello.publish(name)
    rospy.spin()


if __name__ == '__main__':
    main()
