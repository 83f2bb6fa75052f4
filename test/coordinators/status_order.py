#!/usr/bin/env python3
"""Keeps a list of jobs that a machine has begun, and takes them off it when they have ended. ~correct: its twin.

The bug: the machine says so on two topics, and nothing says that the first is heard first.
"""
import rospy
from std_msgs.msg import Int32

JOBS = 8


class Coordinator:
    """Of one machine."""

    def __init__(self):
        self.heard = []
        self.running = []
        self.ended = 0
        for name in ('begun', 'ended'):
            rospy.Subscriber(name, Int32, lambda job, what=name: self.heard.append((what, job.data)), queue_size=10)

    def look(self):
        """Take note of what was heard."""
        while self.heard:
            what, job = self.heard.pop(0)
            if what == 'begun':
                self.running.append(job)
            else:
                self.take_off(job)
                self.ended += 1

    def take_off(self, job):
        """Take a job off the list."""
        self.running.remove(job)


class CorrectCoordinator(Coordinator):
    """Does not mind who is first."""

    def take_off(self, job):
        """Take a job off the list, also one that has yet to come onto it."""
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
