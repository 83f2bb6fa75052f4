#!/usr/bin/env python3
"""Publishes a new job after 6.5 s, and another one 6 s later."""
import rospy
from std_msgs.msg import Int32


def main():
    """Run until the node is shut down."""
    rospy.init_node('job_source')
    jobs = rospy.Publisher('jobs', Int32, queue_size=10)
    for number, wait in ((3, 6.5), (4, 6.0)):
        rospy.sleep(wait)
        jobs.publish(number)
    rospy.spin()


if __name__ == '__main__':
    main()
