#!/usr/bin/env python3
"""Waits for the hello of each robot, on topics whose names it gets by a message. ~correct: without the bug.

The bug: a robot says hello once, when it has started. If the names come later than that, the hello is lost.
"""
import rospy
from std_msgs.msg import String

from move_base_abstract_ros import lockstep


class Coordinator:
    """The coordinator of two robots."""

    def __init__(self):
        self.robots = []
        rospy.Subscriber('team', String, self.on_team)

    def on_team(self, message):
        """Listen to each robot of the team."""
        for name in message.data.split():
            rospy.Subscriber(name + '/hello', String, lambda hello: self.robots.append(hello.data))

    def look(self):
        """Do nothing while robots are missing."""


class CorrectCoordinator(Coordinator):
    """The coordinator without the bug: it also asks the robots for their names, until all have answered."""

    def __init__(self):
        super().__init__()
        self.ask = rospy.Publisher('who', String, queue_size=1)

    def look(self):
        """Ask all robots: an answer is lost if its connection is not up yet."""
        self.ask.publish('')


def main():
    """Run until all robots are known."""
    rospy.init_node('coordinator')
    lockstep.join()
    coordinator = CorrectCoordinator() if rospy.get_param('~correct') else Coordinator()
    while len(set(coordinator.robots)) < 2:
        rospy.sleep(1.0)
        coordinator.look()
        if rospy.get_time() > 60.0:
            raise RuntimeError('only these have said who they are: {}'.format(sorted(coordinator.robots)))


if __name__ == '__main__':
    main()
