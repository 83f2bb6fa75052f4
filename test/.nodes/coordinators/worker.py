#!/usr/bin/env python3
"""Accepts a task within 0.15 s and needs 3 s for it. It accepts a known task again, but does not do it again."""
import rospy
from std_msgs.msg import Int32


def main():
    """Run until the node is shut down."""
    rospy.init_node('worker')
    offers, known = [], []
    accepted = rospy.Publisher('accepted', Int32, queue_size=10)
    done = rospy.Publisher('done', Int32, queue_size=10)
    rospy.Subscriber('task', Int32, lambda task: offers.append(task.data))
    while not rospy.is_shutdown():
        rospy.sleep(0.05)
        while offers:
            task = offers.pop(0)
            rospy.sleep(0.1)
            accepted.publish(task)
            if task not in known:
                known.append(task)
                rospy.sleep(3.0)
                done.publish(task)


if __name__ == '__main__':
    main()
