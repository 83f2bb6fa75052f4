#!/usr/bin/env python3
"""Says who is in the team, when somebody listens."""
import rospy
from std_msgs.msg import String


def main():
    """Run until told to end."""
    rospy.init_node('team')
    team = rospy.Publisher('team', String, queue_size=1, latch=True)
    team.publish('robot_1 robot_2')
    rospy.spin()


if __name__ == '__main__':
    main()
