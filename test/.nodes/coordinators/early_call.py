#!/usr/bin/env python3
"""Asks a store for its stock, 0.1 s after its start. ~correct: without the bug.

The bug: nothing ensures that the store has started. If it has not, the call of its service fails.
"""
import rospy
from std_srvs.srv import Trigger


class Coordinator:
    """The coordinator of one store."""

    def __init__(self):
        self.stock = rospy.ServiceProxy('stock', Trigger)

    def ask(self):
        """Return the stock in words."""
        return self.stock().message


class CorrectCoordinator(Coordinator):
    """The coordinator without the bug: it waits for the service."""

    def ask(self):
        """Return the stock in words, when the store is there."""
        self.stock.wait_for_service()
        return super().ask()


def main():
    """Run until the stock is known."""
    rospy.init_node('coordinator')
    coordinator = CorrectCoordinator() if rospy.get_param('~correct') else Coordinator()
    rospy.sleep(0.1)
    rospy.loginfo('the store has %s', coordinator.ask())
    rospy.sleep(1.0)


if __name__ == '__main__':
    main()
