#!/usr/bin/env python3
"""Publishes the names of the robots in the team, latched."""
import rospy
from std_msgs.msg import String


def main():
    """Run until the node is shut down."""
    rospy.init_node('team')
    team = rospy.Publisher('team', String, queue_size=1, latch=True)
    team.publish('robot_1 robot_2')
    rospy.spin()


if __name__ == '__main__':
    main()
