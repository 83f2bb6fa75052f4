"""Robots on their way to the start of the mission: a robot that gives up is sent again, but not for ever."""
import queue
import unittest
from types import SimpleNamespace

import rospy

from soil_mapping.ros import mission_run
from soil_mapping.ros.mission_run import MissionFailed, MissionRun

LAUNCH_FILE = '<launch/>'

STARTS = ((3.0, 4.0), (5.0, 6.0))


class Robot:
    """A robot that gives up ``failures`` times; ``calls`` has all requests to it."""

    def __init__(self, index, events, failures):
        self.index, self.namespace = index, f'/robot_{index}'
        self._events, self._failures = events, failures
        self.calls = []

    def is_at(self, x, y):
        return False

    def drive(self, x, y):
        self.calls.append((x, y))
        handle = SimpleNamespace(reached=len(self.calls) > self._failures, get_goal_status_text=lambda: 'blocked')
        self._events.put((self.index, handle))

    def end_of_goal(self, handle):
        return handle.reached

    def place_after(self, handle):
        self.calls.append('reached')

    def place(self):
        pass


class Start(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node('soil_start_test')
        mission_run.START_PAUSE_S = 0.001

    def go(self, *failures):
        events = queue.Queue()
        robots = [Robot(index, events, count) for index, count in enumerate(failures)]
        MissionRun(SimpleNamespace(start_places=STARTS), robots, events).go_to_start()
        return [robot.calls for robot in robots]

    def test_a_robot_that_gives_up_is_sent_again(self):
        self.assertEqual(self.go(2, 0), [[STARTS[0]] * 3 + ['reached'], [STARTS[1], 'reached']])

    def test_a_robot_that_never_gets_there_ends_the_mission_with_its_reason(self):
        with self.assertRaises(MissionFailed) as caught:
            self.go(0, 1000)
        self.assertIn("/robot_1 did not get to its start at (5.00, 6.00) m: 'blocked' (tried 5 times)",
                      str(caught.exception))
