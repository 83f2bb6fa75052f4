#!/usr/bin/env python3
"""Sends each robot the same chain of goals on any clock, and prints when each ended: sequence_client.py ROBOTS GOALS.

It prints a JSON list of [robot, number, time from the sending of the first goal to the end of this one [ns]], in the
order in which the results came. The ends are the stamps of the results, in simulated time.
"""

import json
import sys
import time

import rospy
from actionlib import ActionClient, CommState
from move_base_msgs.msg import MoveBaseAction

from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract_ros import lockstep
from move_base_abstract_ros.nodes.demo_run.mission import make_goal

TIMEOUT = 300.0  # s, wall; only ends a run that would never end


class Robot:
    """A robot that goes to and fro along x; some robots have legs of equal length, which end at the same time."""

    def __init__(self, index, goals, ended):
        self.index = index
        self.left = goals
        self._ended = ended
        self._handle = None
        self._client = ActionClient(f'/robot_{index}/move_base', MoveBaseAction)

    def is_ready(self):
        """Return whether the server is there."""
        return self._client.wait_for_server(rospy.Duration(nsecs=-1))

    def send(self):
        """Send the next goal."""
        self.left -= 1
        x = (5.0 + 5.0 * (self.index % 3)) * (self.left % 2)
        self._handle = self._client.send_goal(make_goal(Pose2D(x, float(self.index), 0.0)), self._on_transition)

    def _on_transition(self, handle):
        if handle.get_comm_state() == CommState.DONE:
            stamp = handle.comm_state_machine.latest_result.header.stamp
            self._ended.append([self.index, self.left, stamp.to_nsec()])
            if self.left:
                self.send()


def wait_until(participant, condition):
    """Wait until ``condition()`` is true: in simulated time for a participant, otherwise in wall time."""
    if participant is not None:
        participant.wait_until(condition, what='the robots')
        return
    deadline = time.monotonic() + TIMEOUT
    while not condition() and time.monotonic() < deadline:
        time.sleep(0.01)


def main():
    """Join if the run is in lockstep, send the goals, and print the list."""
    count, goals = int(sys.argv[1]), int(sys.argv[2])
    rospy.init_node('coordinator', disable_signals=True)
    participant = lockstep.join()
    ended = []
    robots = [Robot(index, goals, ended) for index in range(count)]
    wait_until(participant, lambda: all(robot.is_ready() for robot in robots))
    begin_ns = rospy.get_rostime().to_nsec()
    for robot in robots:
        robot.send()
    wait_until(participant, lambda: len(ended) == count * goals)
    print(json.dumps([[robot, number, time_ns - begin_ns] for robot, number, time_ns in ended]), flush=True)


if __name__ == '__main__':
    main()
