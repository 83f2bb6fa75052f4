"""The action PlaceTask of one robot: it passes messages to the core's PlaceTaskRunner, and publishes the answers."""
from __future__ import annotations

import struct
import time
from typing import TYPE_CHECKING, Any, Callable, Optional

from geometry_msgs.msg import Pose

from move_base_abstract.common.shown import shown_text
from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.engine.guard import fault_text
from move_base_abstract.goals.outcome import GoalState
from move_base_abstract.goals.task_events import TaskEnded, TaskWaits
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.msg import PlaceTaskActionFeedback, PlaceTaskActionGoal, PlaceTaskActionResult
from move_base_abstract.tasks.arrivals import Task
from move_base_abstract.tasks.place_tasks import PlaceTaskRunner

from ..messages import conversions
from .action_shell import ActionShell, ActionTypes

if TYPE_CHECKING:
    from move_base_abstract.engine.stream import Stream
    from move_base_abstract.goals.ledger import GoalRecord
    from move_base_abstract.goals.outcome import Outcome
    from move_base_abstract.motion.robot import Robot
    from move_base_abstract.tasks.room import Rooms

    from .host import Host


#: name of the action below a robot's namespace
ACTION = 'work'
_NO_TASK = Task('', 0, '', Pose2D())
_NO_POSE = Pose()  # of a task at no place: where the robot stands
_TYPES = ActionTypes(PlaceTaskActionGoal, PlaceTaskActionResult, PlaceTaskActionFeedback)


class WorkServer:
    """The action PlaceTask on the topics of an :class:`ActionShell` at ``ns``. It is the TaskClient of the tasks.

    ``stream``: the robot's stream of events. ``robot``: the Robot; if it is None, its place is not checked.
    ``has_failed()``: whether the robot cannot work now, as for PlaceTaskRunner.
    """

    def __init__(self, ns: str, robot_name: str, robot_index: int, host: Host, rooms: Rooms,
                 settings: Any, stream: Stream, robot: Optional[Robot] = None,
                 has_failed: Callable[[], bool] = lambda: False) -> None:
        """``settings``: seed, frame (of poses), feedback_freq [Hz, simulated], min_answer_delay [s, wall]."""
        self._clock = host.clock
        self._frame = settings['frame']
        self._robot = robot
        self._throttle = host.throttle(50.0)
        self._shell = ActionShell(ns, ns, host, _TYPES, settings['min_answer_delay'])
        self.is_progress_heard = host.timing.when_heard(self._shell.has_feedback_listeners)
        self.publish_status, self.new_id = self._shell.publish_status, self._shell.new_id
        with self._clock.lock:
            self._clock.now_ns()
            self.tasks = PlaceTaskRunner(rooms, robot_index, robot_name, settings['seed'], stream, self, robot,
                                         settings['feedback_freq'], has_failed)
            stream.subscribe('clients', {TaskWaits: self._waits, TaskEnded: self._ended})
        self._shell.open(self.tasks.ledger, lambda: settings['feedback_freq'])
        self._shell.listen(self._on_goal, self._on_cancel)
        self._clock.follow_restarts(self.tasks.restart)

    def shut_down(self, outcome: Outcome) -> None:
        """End the task that is under way with an Outcome, and send its answer."""
        with self._clock.lock:
            self.tasks.shut_down(outcome, self._clock.now_ns())
        self._shell.flush()

    def close(self, outcome: Outcome) -> None:
        """Take no more tasks, end the one that is under way, and unregister all topics."""
        self.shut_down(outcome)
        with self._clock.lock:
            self._shell.close()
            self._clock.leave_restarts(self.tasks.restart)

    def _waits(self, event: TaskWaits) -> None:
        record = self.tasks.ledger.active
        if record is not None and self._shell.has_feedback_listeners():
            self._shell.publish_feedback(record, pack_feedback(True, 0, 0.0), event.time_ns)

    def progress(self, record: GoalRecord, elapsed_ns: int, duration_ns: int, now_ns: int) -> None:
        """Publish how much is done, as often as the cap in wall time allows, and at the end; see TaskClient."""
        is_last = elapsed_ns == duration_ns
        if self._shell.has_feedback_listeners() and (self._throttle.ready() or is_last):
            self._shell.publish_feedback(record, pack_feedback(False, elapsed_ns, elapsed_ns / duration_ns), now_ns)

    def _on_goal(self, message: Any) -> None:
        with self._clock.lock:
            now_ns = self._clock.now_ns()
            self._shell.arrived(message.goal_id.id, time.monotonic())
            try:
                task, fault = self._task_of(message.goal.task, now_ns)
            except Exception as error:
                self._clock.simulation.report_fault(self._shell.ns, error)
                task, fault = _NO_TASK, fault_text(error)
            self.tasks.take(message.goal_id.id, message.goal_id.stamp.to_nsec(), task, now_ns, fault)

    def _task_of(self, message: Any, now_ns: int) -> Any:
        """Return (Task of a message, what is wrong with it or None)."""
        frame = message.header.frame_id.lstrip('/')
        fault, pose = None, Pose2D()
        if message.place:
            pass
        elif message.pose == _NO_POSE:
            pose = pose if self._robot is None else self._robot.pose_at(now_ns)
        elif frame not in ('', self._frame):
            fault = 'frame: got {}; allowed: {}'.format(shown_text(frame), self._frame)
        else:
            try:
                pose = conversions.from_pose(message.pose)
            except ValueError as error:
                fault = 'pose: {}'.format(error)
        return Task(message.id, 0, message.place, pose, message.duration.to_nsec(), message.power, message.energy,
                    message.priority), fault

    def _on_cancel(self, message: Any) -> None:
        with self._clock.lock:
            self.tasks.cancel(message.id, message.stamp.to_nsec(), self._clock.now_ns())

    def _ended(self, event: TaskEnded) -> None:
        now_ns, tasks = event.time_ns, self.tasks
        is_new = event.state is GoalState.RECALLED
        waited_ns, worked_ns = (0, 0) if is_new else (tasks.waited_ns(now_ns), tasks.elapsed_ns(now_ns))
        self._shell.publish_result(event, pack_result(waited_ns, worked_ns), now_ns)


def pack_result(waited_ns: int, worked_ns: int) -> bytes:
    """Return the bytes of a PlaceTaskResult: how long the task waited, and how long it was worked on [ns]."""
    return struct.pack('<iiii', waited_ns // NS_PER_S, waited_ns % NS_PER_S, worked_ns // NS_PER_S,
                       worked_ns % NS_PER_S)


def pack_feedback(is_waiting: bool, elapsed_ns: int, progress: float) -> bytes:
    """Return the bytes of a PlaceTaskFeedback.

    ``is_waiting``: whether the task waits; ``elapsed_ns``: the time worked on it so far [ns]; ``progress``: the share
    that is done, 0 to 1.
    """
    return struct.pack('<?iif', is_waiting, elapsed_ns // NS_PER_S, elapsed_ns % NS_PER_S, progress)
