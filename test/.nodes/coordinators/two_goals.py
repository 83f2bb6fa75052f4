#!/usr/bin/env python3
"""Gives jobs to an agent that reports when it is idle and when it is ready for a job. ~correct: without the bug.

The bug: a new job goes to an idle agent at once, and then a waiting job goes to it when it is ready.
"""
import rospy
from std_msgs.msg import Empty, Int32, String


class Coordinator:
    """The coordinator of one agent."""

    def __init__(self):
        self.jobs = [1, 2]
        self.is_idle = False
        self.work = rospy.Publisher('work', Int32, queue_size=10)
        rospy.Subscriber('state', String, self.on_state)
        rospy.Subscriber('ready', Empty, self.on_ready)
        rospy.Subscriber('jobs', Int32, self.on_job)

    def on_state(self, message):
        """Note whether the agent is idle."""
        self.is_idle = message.data == 'idle'

    def on_job(self, message):
        """Send a new job if the agent is idle; otherwise keep it."""
        if self.is_idle:
            self.send(message.data)
        else:
            self.jobs.append(message.data)

    def on_ready(self, _message):
        """Send the next job."""
        if self.jobs:
            self.send(self.jobs.pop(0))

    def send(self, job):
        """Send a job."""
        self.is_idle = False
        self.work.publish(job)


class CorrectCoordinator(Coordinator):
    """The coordinator without the bug: it sends exactly one job each time the agent is ready."""

    def __init__(self):
        self.is_ready = False
        super().__init__()

    def on_job(self, message):
        """Queue the new job, and send a job if the agent is ready."""
        self.jobs.append(message.data)
        if self.is_ready:
            self.on_ready(message)

    def on_ready(self, _message):
        """Send the next job, or note that the agent is ready."""
        self.is_ready = not self.jobs
        if self.jobs:
            self.send(self.jobs.pop(0))


def main():
    """Run until the agent ends the run."""
    rospy.init_node('coordinator')
    _coordinator = CorrectCoordinator() if rospy.get_param('~correct') else Coordinator()
    rospy.spin()


if __name__ == '__main__':
    main()
