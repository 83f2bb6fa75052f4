#!/usr/bin/env python3
"""Sends a mower row by row; each order has the place where the row begins. ~correct: without the bug.

The bug: it takes the place from the last pose that it has heard, but a newer pose may still be under way when the mower
reports the end of its row.
"""
import rospy
from geometry_msgs.msg import Point, Pose2D
from std_msgs.msg import Int32

from move_base_abstract_ros import lockstep

ROWS = 4  # without row 0, which the mower reports at the start


class Coordinator:
    """The coordinator of one mower."""

    def __init__(self):
        self.x = 0.0
        self.rows = rospy.Publisher('rows', Point, queue_size=10)
        rospy.Subscriber('pose', Pose2D, self.on_pose)
        rospy.Subscriber('row_done', Int32, self.on_done)

    def on_pose(self, pose):
        """Note the x of the mower [m]."""
        self.x = pose.x

    def on_done(self, message):
        """Order the next row, from the last known x to the other side."""
        if message.data < ROWS:
            self.rows.publish(self.x, 10.0 if self.x < 5.0 else 0.0, message.data + 1)


class CorrectCoordinator(Coordinator):
    """The coordinator without the bug: it computes where each row ends."""

    def on_done(self, message):
        """Order the next row, from the end of the last row."""
        self.x = 10.0 * (message.data % 2)
        super().on_done(message)


def main():
    """Run until the mower ends the run."""
    rospy.init_node('coordinator')
    lockstep.join()
    _coordinator = CorrectCoordinator() if rospy.get_param('~correct') else Coordinator()
    rospy.spin()


if __name__ == '__main__':
    main()
