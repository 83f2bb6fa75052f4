#!/usr/bin/env python3
"""Sends a mower row by row; each row is told with the place where it begins. ~correct: its twin.

The bug: the place is that of the pose that was heard last, and a pose may be under way when the mower says that it has
come to the end of its row.
"""
import rospy
from geometry_msgs.msg import Point, Pose2D
from std_msgs.msg import Int32

from move_base_abstract_ros import lockstep

ROWS = 4  # and the first, 0, which is none


class Coordinator:
    """Of one mower."""

    def __init__(self):
        self.x = 0.0
        self.rows = rospy.Publisher('rows', Point, queue_size=10)
        rospy.Subscriber('pose', Pose2D, self.on_pose)
        rospy.Subscriber('row_done', Int32, self.on_done)

    def on_pose(self, pose):
        """Remember where it is [m]."""
        self.x = pose.x

    def on_done(self, message):
        """Send the next row: from where it is, to the other side."""
        if message.data < ROWS:
            self.rows.publish(self.x, 10.0 if self.x < 5.0 else 0.0, message.data + 1)


class CorrectCoordinator(Coordinator):
    """Knows where each row ends."""

    def on_done(self, message):
        """Send the next row: from where the last one ends."""
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
