"""The action MoveBase of one robot: what its messages mean to the navigator, and its endings as messages."""
import time

from move_base_msgs.msg import (
    MoveBaseActionFeedback,
    MoveBaseActionGoal,
    MoveBaseActionResult,
    MoveBaseFeedback,
    MoveBaseResult,
)

from . import conversions
from .action_shell import ActionShell, ActionTypes

_TYPES = ActionTypes(MoveBaseActionGoal, MoveBaseActionResult, MoveBaseActionFeedback)


class GoalServer:
    """The action MoveBase on the topics of an :class:`ActionShell`. ``trace`` (RobotTrace) is told of endings.

    Has what a GoalLedger asks for.
    """

    def __init__(self, ns, node_name, host, trace, min_answer_delay):
        self._clock = host.clock
        self._trace = trace
        self._navigator = None
        self._prefetch = None
        self._shell = ActionShell(ns, node_name, host, _TYPES, min_answer_delay)
        self.publish_status, self.new_id = self._shell.publish_status, self._shell.new_id

    def start(self, ledger, navigator, prefetch):
        """Take goals for ``navigator``, whose book is ``ledger``; ``prefetch(goal)`` is called before each.

        It is called without the lock and may block.
        """
        self._navigator = navigator
        self._prefetch = prefetch
        self._shell.open(ledger)
        self._shell.listen(self.take, self._on_cancel)

    def close(self):
        """Take no more goals and leave the graph."""
        self._shell.close()

    def reset(self):
        """Tell that all goals are forgotten."""
        self._shell.forget_arrivals()
        self.publish_status()

    def take(self, message):
        """Take a goal (MoveBaseActionGoal) in, as from the topic. May block; no lock is held."""
        goal = conversions.from_target(message.goal.target_pose)
        arrived = time.monotonic()
        self._prefetch(goal)
        with self._clock.lock:
            now_ns = self._clock.now_ns()
            self._shell.arrived(message.goal_id.id, arrived)
            self._navigator.receive(message.goal_id.id, message.goal_id.stamp.to_nsec(), goal, now_ns)

    def _on_cancel(self, message):
        with self._clock.lock:
            now_ns = self._clock.now_ns()
            self._navigator.cancel(message.id, message.stamp.to_nsec(), now_ns)

    def publish_feedback(self, record, pose_stamped, stamp_ns):
        """Publish where the robot with the goal ``record`` is."""
        self._shell.publish_feedback(record, MoveBaseFeedback(pose_stamped), stamp_ns)

    def has_feedback_listeners(self):
        """Return whether anybody subscribes to the feedback."""
        return self._shell.has_feedback_listeners()

    def flush(self):
        """Send what is held back, now."""
        self._shell.flush()

    def publish_result(self, record, stamp_ns):
        """Publish that the goal ``record`` ended at ``stamp_ns`` [ns]."""
        self._trace.ended(record, stamp_ns)
        self._shell.publish_result(record, MoveBaseResult(), stamp_ns)
