"""The action MoveBase of one robot: it passes goals and cancels to the navigator, and publishes how goals end."""
from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any, Callable, Mapping, Optional, Tuple

from move_base_msgs.msg import MoveBaseActionFeedback, MoveBaseActionResult

from move_base_abstract.goals.events import Departed, Ended

from ..lockstep.exchange import playing
from ..messages.packing import SHIFTED, InFrame
from ..messages.unpacking import GoalIn
from .action_shell import ActionShell, ActionTypes

if TYPE_CHECKING:
    from move_base_abstract.common.geometry import Pose2D
    from move_base_abstract.engine.stream import Stream
    from move_base_abstract.goals.goal_pose import GoalPose
    from move_base_abstract.goals.ledger import GoalLedger, GoalRecord
    from move_base_abstract.goals.navigator import Navigator

    from .host import Host


_TYPES = ActionTypes(GoalIn, MoveBaseActionResult, MoveBaseActionFeedback)
_DEAF_SECONDS = 0.1  # wall; the pause of the feedback if no node listens to it
_NO_RESULT = b''  # of move_base_msgs/MoveBaseResult, which has no fields


class GoalServer:
    """The action MoveBase on the topics of an :class:`ActionShell`. It is the navigator's GoalClient.

    ``stream``: the robot's stream of events; ``values``: those of its settings.
    """

    def __init__(self, ns: str, node_name: str, host: Host, stream: Stream,
                 values: Mapping[str, Any]) -> None:
        self._clock = host.clock
        self._navigator: Any = None
        self._prefetch: Callable[[GoalPose], object]
        self._shell = ActionShell(ns, node_name, host, _TYPES, values['min_answer_delay'])
        self.publish_status, self.new_id = self._shell.publish_status, self._shell.new_id
        self.is_feedback_heard = host.timing.when_heard(self._shell.has_feedback_listeners)
        self._in_global_frame = InFrame(values['global_frame'])
        self._told = None  # (goal id, stamp [ns]) of the latest feedback
        self._feedback_throttle = host.throttle(values['max_feedback_rate'])
        stream.subscribe('clients', {Departed: self._departed, Ended: self._ended})

    def start(self, ledger: GoalLedger, navigator: Navigator, prefetch: Callable[[GoalPose], object]) -> None:
        """Take goals for ``navigator``, whose goals ``ledger`` (GoalLedger) keeps.

        ``prefetch(goal)`` is called before each goal, without the lock. It may block.
        """
        self._navigator = navigator
        self._prefetch = prefetch
        self._shell.present_feedback = self._present
        self._shell.open(ledger, lambda: navigator.feedback.frequency)
        self._shell.listen(self._on_goal, self._on_cancel)

    def close(self) -> None:
        """Take no more goals, and unregister all topics."""
        self._shell.close()

    def reset(self) -> None:
        """Forget when goals came, and publish the status, after all goals have been forgotten."""
        self._shell.forget_arrivals()
        self.publish_status()

    def _on_goal(self, message: GoalIn) -> None:
        self.take(message.name, message.stamp_ns, message.target)

    def take(self, goal_id: str, stamp_ns: int, goal: GoalPose) -> None:
        """Take a GoalPose as if it came on the topic, with its id ('' for none) and stamp [ns] (0 for none).

        It may block. The caller holds no lock.
        """
        arrived = time.monotonic()
        try:
            self._prefetch(goal)
        except Exception as error:  # the navigator gets the goal all the same, so that the goal has an end
            self._clock.simulation.report_fault(self._shell.ns, error)
        with self._clock.lock:
            now_ns = self._clock.now_ns()
            self._shell.arrived(goal_id, arrived)
            self._clock.note_stamp(self._shell.ns, goal.stamp_ns)
            self._navigator.receive(goal_id, stamp_ns, goal, now_ns)

    def _on_cancel(self, message: Any) -> None:
        with self._clock.lock:
            now_ns = self._clock.now_ns()
            self._navigator.cancel(message.id, message.stamp.to_nsec(), now_ns)

    def feedback(self, record: GoalRecord, pose: Pose2D, stamp_ns: int, is_last: bool) -> int:
        """Publish where the robot is, as often as the cap in wall time allows, and at the goal; see GoalClient."""
        if not self._shell.has_feedback_listeners():
            return self._clock.wall_to_ns(_DEAF_SECONDS)
        told: Any = (record.goal_id, stamp_ns)
        if self._feedback_throttle.ready() or (is_last and told != self._told):
            if not playing.is_recording():
                self._told = told
            self._shell.publish_feedback(*self._values(record, pose, stamp_ns))
        return self._clock.wall_to_ns(self._feedback_throttle.remaining())

    def _values(self, record: GoalRecord, pose: Pose2D, stamp_ns: int) -> Tuple[Any, ...]:
        slots = self._in_global_frame.pose_slots[1:]
        return (record, self._in_global_frame.pose_stamped(0, pose, stamp_ns), stamp_ns,
                slots if self._navigator.robot.reported.shift is None else (*slots, SHIFTED))

    def _present(self) -> Optional[Tuple[Any, ...]]:
        now_ns = self._clock.newcomers_ns()
        if now_ns is None:
            return None
        record, pose = self._navigator.feedback.present(now_ns)
        return None if record is None else self._values(record, pose, now_ns)

    def flush(self) -> None:
        """Send now all messages that are held back."""
        self._shell.flush()

    def _departed(self, _event: Departed) -> None:
        if not self._navigator.feedback.frequency:
            self._clock.hearers.falls_silent(self._navigator.robot, self._shell, 'feedback_freq')

    def _ended(self, event: Ended) -> None:
        self._shell.publish_result(event, _NO_RESULT, event.time_ns)
