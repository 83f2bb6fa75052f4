"""The action MoveBase of one robot: what its messages mean to the navigator, and its endings as messages."""
import time

from move_base_msgs.msg import MoveBaseActionFeedback, MoveBaseActionResult

from ..messages.unpacking import GoalIn
from .action_shell import ActionShell, ActionTypes

_TYPES = ActionTypes(GoalIn, MoveBaseActionResult, MoveBaseActionFeedback)
_NO_RESULT = b''  # of move_base_msgs/MoveBaseResult, which has no fields


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
        self.has_feedback_listeners = self._shell.has_feedback_listeners
        self.hearers = self._shell.hearers

    def start(self, ledger, navigator, prefetch):
        """Take goals for ``navigator``, whose book is ``ledger``; ``prefetch(goal)`` is called before each.

        It is called without the lock and may block.
        """
        self._navigator = navigator
        self._prefetch = prefetch
        self._shell.open(ledger, lambda: navigator.feedback_frequency)
        self._shell.listen(self._on_goal, self._on_cancel)

    def close(self):
        """Take no more goals and leave the graph."""
        self._shell.close()

    def reset(self):
        """Tell that all goals are forgotten."""
        self._shell.forget_arrivals()
        self.publish_status()

    def _on_goal(self, message):
        self.take(message.name, message.stamp_ns, message.target)

    def take(self, goal_id, stamp_ns, goal):
        """Take a GoalPose in, as from the topic, with id ('': none) and stamp [ns] (0: none).

        May block; no lock is held.
        """
        arrived = time.monotonic()
        try:
            self._prefetch(goal)
        except Exception as error:  # without it the goal is judged as it is, and so ends
            self._clock.simulation.report_fault(self._shell.ns, error)
        with self._clock.lock:
            now_ns = self._clock.now_ns()
            self._shell.arrived(goal_id, arrived)
            self._navigator.receive(goal_id, stamp_ns, goal, now_ns)

    def _on_cancel(self, message):
        with self._clock.lock:
            now_ns = self._clock.now_ns()
            self._navigator.cancel(message.id, message.stamp.to_nsec(), now_ns)

    def publish_feedback(self, record, pose_stamped, stamp_ns):
        """Publish where the robot with the goal ``record`` is; ``pose_stamped`` is bytes."""
        self._shell.publish_feedback(record, pose_stamped, stamp_ns)

    def flush(self):
        """Send what is held back, now."""
        self._shell.flush()

    def publish_result(self, record, stamp_ns):
        """Publish that the goal ``record`` ended at ``stamp_ns`` [ns]."""
        self._trace.ended(record, stamp_ns)
        self._shell.publish_result(record, _NO_RESULT, stamp_ns)
