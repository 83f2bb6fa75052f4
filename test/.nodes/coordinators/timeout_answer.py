#!/usr/bin/env python3
"""Asks a lift for a floor, and asks again if no answer has come after 1 s. ~correct: without the bug.

The bug: if the question was asked twice, the second answer is taken for the answer to the next question.
"""
import rospy
from std_msgs.msg import Int32MultiArray


class Coordinator:
    """The coordinator of one lift."""

    def __init__(self):
        self.answers = []
        self.asked = 0
        self.questions = rospy.Publisher('questions', Int32MultiArray, queue_size=10)
        rospy.Subscriber('answers', Int32MultiArray, lambda answer: self.answers.append(list(answer.data)))

    def ask(self, floor):
        """Ask for a floor; return the answer of the lift, [number of the question, floor]."""
        self.asked += 1
        while True:
            self.questions.publish(Int32MultiArray(data=[self.asked, floor]))
            until = rospy.get_time() + 1.0
            while rospy.get_time() < until:
                if self.is_answered():
                    return self.answers.pop(0)
                rospy.sleep(0.1)

    def is_answered(self):
        """Return whether an answer is there."""
        return bool(self.answers)


class CorrectCoordinator(Coordinator):
    """The coordinator without the bug: it drops answers to earlier questions."""

    def is_answered(self):
        """Return whether an answer is there."""
        self.answers = [answer for answer in self.answers if answer[0] == self.asked]
        return bool(self.answers)


def main():
    """Run until all questions are answered."""
    rospy.init_node('coordinator')
    coordinator = CorrectCoordinator() if rospy.get_param('~correct') else Coordinator()
    rospy.sleep(1.0)
    for floor in range(1, 6):
        said = coordinator.ask(floor)[1]
        if said != floor:
            raise RuntimeError('the lift is asked for floor {}, its answer is {}'.format(floor, said))
        rospy.sleep(5.0)


if __name__ == '__main__':
    main()
