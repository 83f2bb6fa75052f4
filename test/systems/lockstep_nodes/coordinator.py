#!/usr/bin/python3
"""Sends goals to robots, with cancels and pre-emptions: the policy of test/cpp_nodes/shim_coordinator.cpp.

Parameters: ~robots, ~goals (in all), ~seed, ~patient (the end of a goal leads to the next goal only if the robot has no
other open goal), ~delay (the longest random pause [wall s] in callbacks, in sending and in connecting; the policy does
not depend on it).
"""
import random
import threading
import time

import rospy
from actionlib_msgs.msg import GoalID, GoalStatusArray
from move_base_msgs.msg import MoveBaseActionGoal, MoveBaseActionResult

from move_base_abstract_ros import lockstep

_MODULUS = 2 ** 64


class Generator:
    """A linear congruential generator that is the same in every language."""

    def __init__(self, seed):
        self._state = seed

    def draw(self):
        """Return 31 bits."""
        self._state = (self._state * 6364136223846793005 + 1442695040888963407) % _MODULUS
        return self._state >> 33


class Coordinator:
    """Sends one goal after the other to each robot; a tenth of the goals is cancelled, a tenth is replaced."""

    def __init__(self):
        self._count = rospy.get_param('~robots')
        self._goals = rospy.get_param('~goals')
        self._delay = rospy.get_param('~delay', 0.0)
        self._generator = Generator(rospy.get_param('~seed'))
        self._is_patient = rospy.get_param('~patient')
        self._sent = [0] * self._count
        self._open = [0] * self._count
        self._total = self._results = 0
        self._heard = set()
        self._publishers = []
        for i in range(self._count):
            self._lose_time()
            prefix = '/robot_{}/move_base/'.format(i)
            self._publishers.append((rospy.Publisher(prefix + 'goal', MoveBaseActionGoal, queue_size=10),
                                     rospy.Publisher(prefix + 'cancel', GoalID, queue_size=10)))
            rospy.Subscriber(prefix + 'result', MoveBaseActionResult, self._on_result, callback_args=i)
            rospy.Subscriber(prefix + 'status', GoalStatusArray, self._on_status, callback_args=i)

    def is_over(self):
        """Return whether all goals are sent and have ended."""
        return self._total >= self._goals and self._results >= self._total

    def _lose_time(self):
        if self._delay:
            time.sleep(random.SystemRandom().uniform(0.0, self._delay))

    def _on_status(self, _status, robot):
        if robot not in self._heard:
            self._heard.add(robot)
            if len(self._heard) == self._count:
                for i in range(self._count):
                    if self._total < self._goals:
                        self._next_goal(i)

    def _on_result(self, _result, robot):
        self._lose_time()
        self._results += 1
        self._open[robot] -= 1
        if self._total < self._goals and not (self._is_patient and self._open[robot]):
            self._next_goal(robot)

    def _send(self, robot):
        self._lose_time()
        self._total += 1
        self._sent[robot] += 1
        self._open[robot] += 1
        goal_id = 'robot_{}-{}'.format(robot, self._sent[robot])
        goal = MoveBaseActionGoal()
        goal.goal_id.id = goal_id
        pose = goal.goal.target_pose
        pose.header.frame_id = 'map'
        pose.pose.position.x = (self._generator.draw() % 9) * 5.0 - 20.0  # few places: robots arrive together
        pose.pose.orientation.w = 1.0
        self._publishers[robot][0].publish(goal)
        return goal_id

    def _next_goal(self, robot):
        goal_id = self._send(robot)
        case = self._generator.draw() % 10
        if case > 1:
            return
        pause_ns = (self._generator.draw() % 50) * 100000000
        if case == 0:
            action = lambda: self._publishers[robot][1].publish(GoalID(id=goal_id))  # noqa: E731
        else:
            action = lambda: self._total < self._goals and self._send(robot)  # noqa: E731
        self._later(pause_ns, action)

    @staticmethod
    def _later(pause_ns, action):
        """Call ``action`` after the pause; a rospy.Timer computes with a rate [Hz], and may be off by 1 ns."""
        def run():
            participant = lockstep.participant()
            participant.scheduler.wait(participant.now_ns + pause_ns)
            action()
        threading.Thread(target=run, daemon=True).start()


def main():
    """Run until all goals have ended."""
    rospy.init_node('coordinator')
    participant = lockstep.join()
    coordinator = Coordinator()
    participant.wait_until(coordinator.is_over, what='the goals')


if __name__ == '__main__':
    main()
