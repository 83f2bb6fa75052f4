#!/usr/bin/env python3
"""Orders an urgent drive after 9.97 s, and counts the drives. It ends with an error unless there were three."""
import rospy
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseActionResult
from std_msgs.msg import Empty, Float64


def main():
    """Run until the coordinator has finished."""
    rospy.init_node('customer')
    arrived = []
    finished = []
    rospy.Subscriber('robot_1/move_base/result', MoveBaseActionResult,
                     lambda message: arrived.append(message.status.status))
    rospy.Subscriber('finished', Empty, finished.append)
    urgent = rospy.Publisher('urgent', Float64, queue_size=1)
    rospy.sleep(9.97)
    urgent.publish(-5.0)
    while not finished:
        rospy.sleep(1.0)
    drives = arrived.count(GoalStatus.SUCCEEDED)
    if drives != 3:
        raise RuntimeError('3 drives were ordered, the robot has made {}'.format(drives))


if __name__ == '__main__':
    main()
