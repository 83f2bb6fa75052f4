#!/usr/bin/env python3
"""A coordinator in lockstep that sends each robot its next goal when a goal has ended, and counts the goals.

    lockstep_client.py stock|lean ROBOTS EVENTS [STATIONS.json SHARE]

One event is the end of a goal and the sending of the robot's next goal. It prints a JSON line with the events and the
simulated seconds per second of wall time. `stock` is actionlib.ActionClient, `lean` is this package's client. Goals lie
along x, or are drawn from the list of [x, y] in STATIONS.json. The first SHARE of the events (0.1) is not measured.
"""

import json
import random
import sys
import time

import rospy
from actionlib import ActionClient, CommState
from move_base_msgs.msg import MoveBaseAction

from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract_ros import lockstep
from move_base_abstract_ros.goal_client import GoalClient
from move_base_abstract_ros.nodes.demo_run.mission import make_goal

WARM_UP = 0.1  # share of the events that is not measured, by default


class Robot:
    """Goes to and fro along x, 20 to 100 m each time, or from station to station."""

    def __init__(self, name, index, run, stations=()):
        self._stations = stations
        self.name = name
        self._random = random.Random(index)
        self._run = run
        self._x, self._y = 0.0, 2.0 * index

    def next_place(self):
        """Return the pose of the next goal."""
        if self._stations:
            return Pose2D(*self._random.choice(self._stations), 0.0)
        length = self._random.uniform(20.0, 100.0)
        self._x += length if self._x <= 0.0 else -length
        return Pose2D(self._x, self._y, 0.0)


class StockRobot(Robot):
    """A robot that gets its goals from actionlib's client."""

    def __init__(self, *args):
        super().__init__(*args)
        self._client = ActionClient(f'/{self.name}/move_base', MoveBaseAction)
        self._handle = None

    def is_ready(self):
        """Return whether the server is there."""
        return self._client.wait_for_server(rospy.Duration(nsecs=-1))

    def send(self):
        """Send the next goal."""
        self._handle = self._client.send_goal(make_goal(self.next_place()), self._on_transition)

    def _on_transition(self, handle):
        if handle.get_comm_state() == CommState.DONE:
            self._run.ended(self)


class LeanRobot(Robot):
    """A robot that gets its goals from this package's client."""

    def __init__(self, *args):
        super().__init__(*args)
        self._client = GoalClient(self.name, lambda *_ended: self._run.ended(self))

    def is_ready(self):
        """Return whether the server is there."""
        return self._client.is_connected()

    def send(self):
        """Send the next goal."""
        place = self.next_place()
        self._client.send(place.x, place.y, place.yaw)


class Run:
    """Counts events, and times those that are measured."""

    def __init__(self, events, warm_up=WARM_UP):
        self._events = events
        self._warm_up = int(warm_up * events)
        self.count = 0
        self.began = self.over = None

    def ended(self, robot):
        """Count the end of a robot's goal, and send its next goal unless all events are counted."""
        self.count += 1
        if self.count == self._warm_up:
            self.began = time.perf_counter(), rospy.get_time()
        if self.count >= self._events:
            self.over = self.over or (time.perf_counter(), rospy.get_time())
        else:
            robot.send()

    def summary(self):
        """Return the figures."""
        wall_s, simulated_s = (end - begin for begin, end in zip(self.began, self.over))
        events = self._events - self._warm_up
        return {'events': events, 'wall_s': wall_s, 'events_per_s': events / wall_s, 'speed_up': simulated_s / wall_s}


def main():
    """Join the run, send goals, and print the figures."""
    kind, count, events = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    rospy.init_node('coordinator', disable_signals=True)
    participant = lockstep.join()
    run, stations = Run(events), ()
    if len(sys.argv) > 4:
        with open(sys.argv[4], encoding='utf-8') as stream:
            stations = json.load(stream)
        run = Run(events, float(sys.argv[5]))
    make = StockRobot if kind == 'stock' else LeanRobot
    robots = [make(f'robot_{i}', i, run, stations) for i in range(count)]
    participant.wait_until(lambda: all(robot.is_ready() for robot in robots), what='the robots')
    for robot in robots:
        robot.send()
    participant.wait_until(lambda: run.over, what='the end of the last goal')
    print(json.dumps(run.summary()), flush=True)


if __name__ == '__main__':
    main()
