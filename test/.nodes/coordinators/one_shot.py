#!/usr/bin/env python3
"""Tells a gate to open, once, 0.2 s after its start. ~correct: without the bug.

The bug: a message is lost if its subscriber is not there yet, or its connection is not up.
"""
import rospy
from std_msgs.msg import Empty


class Coordinator:
    """The coordinator of one gate."""

    def __init__(self):
        self.opening = rospy.Publisher('open', Empty, queue_size=1)

    def open(self):
        """Open the gate."""
        self.opening.publish()


class CorrectCoordinator(Coordinator):
    """The coordinator without the bug: it waits for the gate to listen."""

    def open(self):
        """Open the gate, when it listens."""
        while self.opening.get_num_connections() == 0:
            rospy.sleep(0.1)
        super().open()


def main():
    """Run until the gate ends the run."""
    rospy.init_node('coordinator')
    coordinator = CorrectCoordinator() if rospy.get_param('~correct') else Coordinator()
    rospy.sleep(0.2)
    coordinator.open()
    rospy.spin()


if __name__ == '__main__':
    main()
