"""The fixture ``lockstep``, by which a test drives its run."""
import os
import time
from math import cos, sin
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Tuple, Union

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal

from move_base_abstract.common import processes
from move_base_abstract.common.arguments import as_float, check_kind
from move_base_abstract.common.errors import SimulatorError
from move_base_abstract.lockstep.run_options import RunOptions
from move_base_abstract.properties import Broken, Judgement, Run, judgement_on
from move_base_abstract.runs import event_log
from move_base_abstract.runs.ends import End
from move_base_abstract_ros import lockstep
from move_base_abstract_ros.replacing import rospy_start

from .settings import settings_of
from .system import TEST, System

IDENTICAL = 'assert_identical'  # a file of this name says that the test must be run once more


class LogEvent(NamedTuple):
    """An event. ``robot`` is a robot, a node or a topic; ``values`` depend on the kind (docs/time_master.md)."""

    time_ns: int
    robot: str
    kind: str
    values: List[Any]

    @property
    def time(self) -> float:
        """The instant of the event [s, simulated]."""
        return self.time_ns * 1e-9


class RunLog:
    """The log of a run that is over. ``end`` is its end record, {} if it has none."""

    def __init__(self, path: str) -> None:
        """Read the file.

        :raises EventLogError: if it is not an event log.
        """
        self.path = path
        with event_log.opened(path) as log:
            self.events = [LogEvent(*row) for row in log.rows()]
        self.end: Dict[str, Any] = log.end or {}

    def of(self, kind: Optional[str] = None, robot: Optional[str] = None) -> List[LogEvent]:
        """Return the events of this kind, of this robot, or of both; all events if neither is given."""
        return [one for one in self.events if kind in (None, one.kind) and robot in (None, one.robot)]

    @property
    def labels(self) -> List[str]:
        """The reasons why the run is not called repeatable, or is called degraded."""
        return event_log.labels_of(self.end) if self.end else ['it has no end']


class Goal:
    """A goal that was sent. ``state`` is None until it has ended, then a name of actionlib_msgs/GoalStatus.

    ``ended_at`` is the simulated time of its end [s], or None.
    """

    def __init__(self, system: 'Lockstep', robot: str) -> None:
        self.robot = robot
        self.state: Optional[str] = None
        self.ended_at: Optional[float] = None  # s
        self._system = system
        self._handle: Any = None

    @property
    def is_done(self) -> bool:
        """Whether the goal has ended."""
        return self.state is not None

    def wait(self, limit: float = 3600.0) -> str:
        """Let time go on until the goal has ended, and return its state.

        :raises AssertionError: if it has not ended after ``limit`` [s, simulated].
        """
        self._system.run_until(lambda: self.is_done, limit, "the goal of '{}' has ended".format(self.robot))
        return str(self.state)

    def cancel(self) -> None:
        """Ask the robot to cancel the goal."""
        self._handle.cancel()

    def _changed(self, handle: Any) -> None:
        if handle.get_comm_state() == actionlib.CommState.DONE and self.state is None:
            self.state = GoalStatus.to_string(handle.get_goal_status())
            self.ended_at = self._system.time


class Lockstep:
    """A run that a test drives, as the participant ``/test``. Simulated time stands still while the test computes.

    A test may also do whatever a node may do: subscribe, publish, call services, sleep in ROS time.
    """

    def __init__(self, folder: str, base: str, chaos_seed: Optional[int] = None) -> None:
        """Prepare a run, which :meth:`start` starts.

        :param folder: the folder for all files of the run.
        :param base: the folder to which the paths in settings are relative.
        :param chaos_seed: the seed of the order of equal events, or None.
        """
        self.folder = folder
        self.chaos_seed = chaos_seed
        #: the environment before the run
        self.environment = dict(os.environ)
        self._base = base
        self._system: Optional[System] = None
        self._settings: Any = None
        self._joined: Any = None
        self._clients: Dict[str, Any] = {}
        self._allowed: List[str] = []
        self._over: Optional[Run] = None
        self._judged: Optional[Judgement] = None
        #: the properties that are broken and not allowed, when the run is over
        self.told_broken: List[Broken] = []
        #: {file in the folder: its size [bytes] when the test was over, before the run's end adds lines}
        self.sizes: Dict[str, int] = {}

    def start(self, **given: Any) -> None:
        """Start the system. The keywords are the fields of Settings.

        If the test's marker has such keywords, the fixture has called this already.

        :raises SimulatorError: if it cannot be started, or was started before.
        """
        if self._system is not None:
            raise SimulatorError('lockstep: one test has one run, and it has been started')
        self._settings = settings_of(given, self._base, self.chaos_seed)
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
        """The present simulated time [s]."""
        return float(rospy.get_time())

    def run_for(self, seconds: float) -> None:
        """Let ``seconds`` of simulated time pass."""
        rospy.sleep(as_float(seconds, 'seconds'))

    def run_until(self, condition: Union[float, Callable[[], object]], limit: float = 3600.0, what: str = '',
                  every: float = 1.0) -> None:
        """Let time go on until an instant [s, simulated], or until ``condition()`` is true.

        The condition is checked when the test has received something (a message, a result), and every ``every``
        simulated seconds. ``what`` names it in the error.

        :raises AssertionError: if the condition is not true after ``limit`` [s, simulated].
        """
        if not callable(condition):
            self.run_for(max(0.0, as_float(condition, 'condition') - self.time))
            return
        end, every = self.time + as_float(limit, 'limit'), as_float(every, 'every')
        while not self._joined.wait_until(condition, max(0.0, min(every, end - self.time)), what or 'the condition'):
            if self.time >= end:
                raise AssertionError('{} is not true {:g} s later, at {:.9f} s'.format(
                    what or 'the condition', limit, self.time))

    def send_goal(self, robot: str, x: float, y: float, yaw: float = 0.0, frame: str = 'map') -> Goal:
        """Send a goal to a robot: ``x`` and ``y`` [m], ``yaw`` [rad], in ``frame``. Return its Goal without waiting.

        :raises AssertionError: if no node serves the robot's move_base within 60 s of simulated time.
        """
        check_kind(robot, str, 'robot')
        check_kind(frame, str, 'frame')
        x, y, yaw = as_float(x, 'x'), as_float(y, 'y'), as_float(yaw, 'yaw')
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
        """Allow the run to break these properties; each is a property's name, or the text of a statement."""
        for name in properties:
            check_kind(name, str, 'properties')
        self._allowed += properties

    def assert_identical(self) -> None:
        """Make the test fail unless a second run of the whole test has the same event log, to the byte.

        pytest makes the second run after this one, in a process of its own.
        """
        with open(os.path.join(self.folder, IDENTICAL), 'w', encoding='utf-8'):
            pass

    def finish(self) -> List[Broken]:
        """End the run if it is not over, and return the properties that it has broken.

        The fixture calls this at the end of the test.
        """
        if self._system is None:
            return []
        if self._judged is None:
            with os.scandir(self.folder) as files:
                self.sizes = {one.name: one.stat().st_size for one in files}
            if self._joined is not None:
                self._joined.leave('the test is over')
            begin, found = time.monotonic(), self._system.end()
            self._over = Run(self._system.log, found, self._settings.properties)
            self._judged = _judged(self._over, time.monotonic() - begin)
        return list(self._judged.broken)

    @property
    def not_allowed(self) -> List[Broken]:
        """The properties that the run has broken, without those that :meth:`allow` names. This ends the run."""
        found = self.finish()
        if found and self._over is not None and self._allowed:  # what was told once may break another property, too
            found = list(judgement_on(self._over._replace(allowed=self._allowed)).broken)
        return [one for one in found if one.text not in self._allowed]

    @property
    def has_run(self) -> bool:
        """Whether a run was started, and is over."""
        return self._over is not None

    @property
    def ends(self) -> List[End]:
        """How the processes of the run that is over ended."""
        return list(self._over.processes) if self._over is not None else []

    @property
    def options(self) -> RunOptions:
        """The options of the run that was started."""
        found: RunOptions = self._settings
        return found

    @property
    def nodes_of_user(self) -> List[str]:
        """The names of the nodes whose programs are not of this package."""
        return self._system.nodes_of_user if self._system is not None else []

    @property
    def files(self) -> List[str]:
        """The paths of the launch files and programs of the run."""
        return self._system.files if self._system is not None else []

    def never_held(self) -> List[Tuple[str, str]]:
        """End the run, and return (node, text) of each ``sometimes`` that has not held in it."""
        self.finish()
        return self._judged.never_held() if self._judged is not None else []

    @property
    def log(self) -> RunLog:
        """The run's event log as objects. This ends the run.

        :raises SimulatorError: if no run was started.
        """
        self.finish()
        if self._system is None:
            raise SimulatorError('lockstep: nothing was started, so there is no log')
        return RunLog(self._system.log)


def _judged(run: Run, seconds: float) -> Judgement:
    if not os.path.exists(run.log):
        raise SimulatorError('{}: is not there {:.1f} s after the end of the test: the run did not end'.format(
            run.log, seconds))
    return judgement_on(run)
