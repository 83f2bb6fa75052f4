"""What a test has in its hands: the fixture ``lockstep``."""
import os
import time
from math import cos, sin
from typing import Any, Callable, Dict, List, Optional, Tuple, Union

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal

from move_base_abstract.common import processes
from move_base_abstract.common.errors import SimulatorError
from move_base_abstract.properties import Broken, Judgement, Run, judgement_on
from move_base_abstract_ros import lockstep
from move_base_abstract_ros.replacing import rospy_start

from .launch_text import TEST
from .run_log import RunLog
from .settings import settings_of
from .system import System

IDENTICAL = 'assert_identical'  # a file that says that the run is to be made once more


class Goal:
    """A goal that was sent. ``state``: None until it has ended, then a name of actionlib_msgs/GoalStatus."""

    def __init__(self, system: 'Lockstep', robot: str) -> None:
        self.robot = robot
        self.state: Optional[str] = None
        self.ended_at: Optional[float] = None  # s
        self._system = system
        self._handle: Any = None

    @property
    def is_done(self) -> bool:
        """Whether it has ended."""
        return self.state is not None

    def wait(self, limit: float = 3600.0) -> str:
        """Let time go on until it has ended; return how. :raises AssertionError: after ``limit`` [s]."""
        self._system.run_until(lambda: self.is_done, limit, "the goal of '{}' has ended".format(self.robot))
        return str(self.state)

    def cancel(self) -> None:
        """Ask for its end."""
        self._handle.cancel()

    def _changed(self, handle: Any) -> None:
        if handle.get_comm_state() == actionlib.CommState.DONE and self.state is None:
            self.state = GoalStatus.to_string(handle.get_goal_status())
            self.ended_at = self._system.time


class Lockstep:
    """A run that a test drives, as the participant ``/test``. Simulated time stands while the test computes.

    Besides what is here a test may do whatever a node may: subscribe, publish, call services, sleep in ROS time.
    """

    def __init__(self, folder: str, base: str, chaos_seed: Optional[int] = None) -> None:
        """folder: for what runs write, each in one of its own; base: what paths are relative to."""
        self.folder = folder
        self.chaos_seed = chaos_seed
        self._base = base
        self._system: Optional[System] = None
        self._settings: Any = None
        self._joined: Any = None
        self._clients: Dict[str, Any] = {}
        self._allowed: List[str] = []
        self._judged: Optional[Judgement] = None

    def start(self, **given: Any) -> None:
        """Start the system; the fixture has done it where the test's marker says what. See Settings.

        :raises SimulatorError: if it cannot be started.
        """
        if self._system is not None:
            raise SimulatorError('lockstep: one test has one run, and it has been started')
        self._settings = settings_of(given, self._base)
        if self.chaos_seed is not None:
            asked = self._settings.time_master  # seed 0 is the stated order, in which nothing is late
            kept = {name: value for name, value in asked.items() if self.chaos_seed or not name.startswith('chaos_')}
            self._settings.time_master = {**kept, 'chaos_seed': self.chaos_seed}
        try:
            self._system = System(self._settings, self.folder)
            rospy_start.prepare()
            with self._system.watched():
                rospy.init_node(TEST.strip('/'), argv=[], disable_signals=True, disable_rosout=True)
                self._joined = lockstep.join()
        except BaseException:
            self._system = None
            processes.end_all_children()
            raise

    @property
    def time(self) -> float:
        """The present [s, simulated]."""
        return float(rospy.get_time())

    def run_for(self, seconds: float) -> None:
        """Let so much simulated time pass [s]."""
        rospy.sleep(seconds)

    def run_until(self, condition: Union[float, Callable[[], object]], limit: float = 3600.0, what: str = '',
                  every: float = 1.0) -> None:
        """Let time go on until an instant [s], or until ``condition()`` is true.

        That is looked at when something has come to the test (a message, a result), and ``every`` so many seconds.

        :raises AssertionError: when it is not after ``limit`` [s, simulated].
        """
        if not callable(condition):
            self.run_for(max(0.0, condition - self.time))
            return
        end = self.time + limit
        while not self._joined.wait_until(condition, max(0.0, min(every, end - self.time)), what or 'the condition'):
            if self.time >= end:
                raise AssertionError('{} is not true {:g} s later, at {:.9f} s'.format(
                    what or 'the condition', limit, self.time))

    def send_goal(self, robot: str, x: float, y: float, yaw: float = 0.0, frame: str = 'map') -> Goal:
        """Send a goal [m, rad] to a robot, and return it; it is under way then. See Goal."""
        if robot not in self._clients:
            client = self._clients[robot] = actionlib.ActionClient('/{}/move_base'.format(robot), MoveBaseAction)
            if not client.wait_for_server(rospy.Duration(60.0)):
                raise AssertionError("there is no robot '{}': no node serves /{}/move_base".format(robot, robot))
        target, goal = MoveBaseGoal(), Goal(self, robot)
        target.target_pose.header.frame_id = frame
        target.target_pose.header.stamp = rospy.Time.now()
        pose = target.target_pose.pose
        pose.position.x, pose.position.y = x, y
        pose.orientation.z, pose.orientation.w = sin(yaw / 2), cos(yaw / 2)
        goal._handle = self._clients[robot].send_goal(target, goal._changed)
        return goal

    def allow(self, *properties: str) -> None:
        """Have it be no failure if the run breaks these properties: their names, or the text of a statement."""
        self._allowed += properties

    def assert_identical(self) -> None:
        """Have the test fail unless one more run of all of it has the same event log, to the byte.

        That one is made by pytest after this one, in a process of its own.
        """
        with open(os.path.join(self.folder, IDENTICAL), 'w', encoding='utf-8'):
            pass

    def finish(self) -> List[Broken]:
        """End the run, if it has not been: return what it has broken. The fixture does it at the end of the test."""
        if self._system is None:
            return []
        if self._judged is None:
            if self._joined is not None:
                self._joined.leave('the test is over')
            begin, found = time.monotonic(), self._system.end()
            self._judged = _judged(self._system.log, found, time.monotonic() - begin)
        return list(self._judged.chosen(self._settings.properties))

    @property
    def not_allowed(self) -> List[Broken]:
        """What the run that is over has broken and :meth:`allow` has not named."""
        return [one for one in self.finish() if one.property not in self._allowed and one.text not in self._allowed]

    def never_held(self) -> List[Tuple[str, str]]:
        """Return (node, text) of each ``sometimes`` that has not held in this run, which is ended."""
        self.finish()
        return self._judged.never_held() if self._judged is not None else []

    @property
    def log(self) -> RunLog:
        """The run's event log as objects; the run is ended for it."""
        self.finish()
        if self._system is None:
            raise SimulatorError('lockstep: nothing was started, so there is no log')
        return RunLog(self._system.log)


def _judged(log: str, found: Any, seconds: float) -> Judgement:
    if not os.path.exists(log):
        raise SimulatorError('{}: is not there {:.1f} s after the end of the test: the run did not end'.format(
            log, seconds))
    return judgement_on(Run(log, found))
