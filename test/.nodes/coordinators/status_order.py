#!/usr/bin/env python3
"""Keeps a list of the jobs that a machine has begun, and removes those that have ended. ~correct: without the bug.

The bug: beginnings and ends come on two topics, and nothing ensures that the beginning of a job is heard first.
"""
import rospy
from std_msgs.msg import Int32

JOBS = 8


class Coordinator:
    """The coordinator of one machine."""

    def __init__(self):
        self.heard = []
        self.running = []
        self.ended = 0
        for name in ('begun', 'ended'):
            rospy.Subscriber(name, Int32, lambda job, what=name: self.heard.append((what, job.data)), queue_size=10)

    def look(self):
        """Handle the messages that have come."""
        while self.heard:
            what, job = self.heard.pop(0)
            if what == 'begun':
                self.running.append(job)
            else:
                self.take_off(job)
                self.ended += 1

    def take_off(self, job):
        """Remove a job from the list."""
        self.running.remove(job)


class CorrectCoordinator(Coordinator):
    """The coordinator without the bug: the order of the two messages does not matter."""

    def take_off(self, job):
        """Remove a job from the list, or its beginning from the messages that are not handled yet."""
        if job in self.running:
            self.running.remove(job)
        elif ('begun', job) in self.heard:
            self.heard.remove(('begun', job))


def main():
    """Run until all jobs have ended."""
    rospy.init_node('coordinator')
    coordinator = CorrectCoordinator() if rospy.get_param('~correct') else Coordinator()
    while coordinator.ended < JOBS:
        rospy.sleep(0.1)
        coordinator.look()


if __name__ == '__main__':
    main()
