#!/usr/bin/env python3
"""Offers each task to one of two workers, and to the other if it does not answer in 0.18 s. ~correct: without the bug.

The bug: if the first worker has begun and only its answer is late, both workers do the task.
"""
import rospy
from std_msgs.msg import Int32

from move_base_abstract_ros import lockstep

TASKS = 6
PATIENCE = 0.18  # s


class Coordinator:
    """The coordinator of two workers."""

    def __init__(self):
        self.done = []
        self.accepted = set()
        self.offers = [rospy.Publisher('worker_{}/task'.format(number), Int32, queue_size=10) for number in (1, 2)]
        for number in (1, 2):
            rospy.Subscriber('worker_{}/accepted'.format(number), Int32, lambda task: self.accepted.add(task.data))
            rospy.Subscriber('worker_{}/done'.format(number), Int32, lambda task: self.done.append(task.data))

    def assign(self, task):
        """Offer a task until it is accepted."""
        worker = task % 2
        while task not in self.accepted:
            self.offers[worker].publish(task)
            rospy.sleep(PATIENCE)
            worker = self.retry(worker)

    @staticmethod
    def retry(worker):
        """Return the number of the worker that is asked next."""
        return 1 - worker


class CorrectCoordinator(Coordinator):
    """The coordinator without the bug: it asks the same worker again, which knows the task by its number."""

    @staticmethod
    def retry(worker):
        """Return the number of the worker that is asked next."""
        return worker


def main():
    """Run until all tasks are done."""
    rospy.init_node('coordinator')
    lockstep.join()
    coordinator = CorrectCoordinator() if rospy.get_param('~correct') else Coordinator()
    rospy.sleep(1.0)
    for task in range(TASKS):
        coordinator.assign(task)
        while task not in coordinator.done:
            rospy.sleep(1.0)
    rospy.sleep(10.0)
    if sorted(coordinator.done) != list(range(TASKS)):
        raise RuntimeError('tasks were done that often: {}'.format(sorted(coordinator.done)))


if __name__ == '__main__':
    main()
