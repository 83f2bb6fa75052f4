#!/usr/bin/env python3
"""Waits for robots to introduce themselves, on topics whose names it is told. ~correct: its twin.

The bug: robots say it once, when they are up, and it listens as soon as it has its names: who was first had luck.
"""
import rospy
from std_msgs.msg import String

from move_base_abstract_ros import lockstep


class Coordinator:
    """Of two robots."""

    def __init__(self):
        self.robots = []
        rospy.Subscriber('team', String, self.on_team)

    def on_team(self, message):
        """Listen to who belongs to the team."""
        for name in message.data.split():
            rospy.Subscriber(name + '/hello', String, lambda hello: self.robots.append(hello.data))


class CorrectCoordinator(Coordinator):
    """Asks those whom it has not heard."""

    def on_team(self, message):
        """Listen, then ask."""
        super().on_team(message)
        self.ask = rospy.Publisher('who', String, queue_size=1, latch=True)
        self.ask.publish(message.data)


def main():
    """Run until all robots are known."""
    rospy.init_node('coordinator')
    lockstep.join()
    coordinator = CorrectCoordinator() if rospy.get_param('~correct') else Coordinator()
    while len(set(coordinator.robots)) < 2:
        rospy.sleep(1.0)
        if rospy.get_time() > 60.0:
            raise RuntimeError('only these have said who they are: {}'.format(sorted(coordinator.robots)))


if __name__ == '__main__':
    main()
