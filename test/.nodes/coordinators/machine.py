#!/usr/bin/env python3
"""Does eight jobs of 10 ms, one every second, and publishes the beginning and the end of each."""
import rospy
from std_msgs.msg import Int32


def main():
    """Run until the node is shut down."""
    rospy.init_node('machine')
    begun = rospy.Publisher('begun', Int32, queue_size=10)
    ended = rospy.Publisher('ended', Int32, queue_size=10)
    for job in range(8):
        rospy.sleep(1.0)
        begun.publish(job)
        rospy.sleep(0.01)
        ended.publish(job)
    rospy.spin()


if __name__ == '__main__':
    main()
