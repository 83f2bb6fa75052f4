#!/usr/bin/env python3
"""Counts the picks of two pickers in a store that takes 10 ms to answer. ~correct: without the bug.

The bug: rospy calls the two subscribers in two threads, and one reads the total that the other is about to write.
"""
import threading

import rospy
from std_msgs.msg import Empty, Int32

from move_base_abstract_ros import lockstep

PICKS = 10  # picks of each picker


class Coordinator:
    """The coordinator, which keeps the total."""

    def __init__(self):
        self.total = 0
        self.heard = 0
        for number in (1, 2):
            rospy.Subscriber('picker_{}/picked'.format(number), Int32, self.on_picked, queue_size=100)

    def on_picked(self, message):
        """Add the picks to the total in the store."""
        self.heard += 1
        total = self.total
        rospy.sleep(0.01)
        self.total = total + message.data


class CorrectCoordinator(Coordinator):
    """The coordinator without the bug: a lock lets in one thread at a time."""

    def __init__(self):
        self.lock = threading.Lock()
        super().__init__()

    def on_picked(self, message):
        """Add the picks to the total in the store."""
        with self.lock:
            super().on_picked(message)


def main():
    """Run until all is picked."""
    rospy.init_node('coordinator')
    lockstep.join()
    coordinator = CorrectCoordinator() if rospy.get_param('~correct') else Coordinator()
    begin = rospy.Publisher('begin', Empty, queue_size=1, latch=True)
    begin.publish()
    while coordinator.heard < 2 * PICKS:
        rospy.sleep(1.0)
    rospy.sleep(1.0)
    if coordinator.total != 2 * PICKS:
        raise RuntimeError('{} were picked, {} are in the book'.format(2 * PICKS, coordinator.total))


if __name__ == '__main__':
    main()
