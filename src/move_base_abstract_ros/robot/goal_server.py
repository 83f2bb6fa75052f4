"""The action MoveBase of one robot: what its messages mean to the navigator, and its endings as messages."""
import time

from move_base_msgs.msg import MoveBaseActionFeedback, MoveBaseActionResult

from move_base_abstract.goals.events import Departed, Ended

from ..lockstep.exchange import rollback
from ..messages.packing import InFrame
from ..messages.unpacking import GoalIn
from .action_shell import ActionShell, ActionTypes

_TYPES = ActionTypes(GoalIn, MoveBaseActionResult, MoveBaseActionFeedback)
_DEAF_SECONDS = 0.1  # wall; how long a robot to whose feedback nobody listens is silent
_NO_RESULT = b''  # of move_base_msgs/MoveBaseResult, which has no fields


class GoalServer:
    """The action MoveBase on the topics of an :class:`ActionShell`; ``stream``: the robot's, ``values``: its settings'.

    It is the navigator's GoalClient.
    """

    def __init__(self, ns, node_name, host, stream, values):
        self._clock = host.clock
        self._navigator = None
        self._prefetch = None
        self._shell = ActionShell(ns, node_name, host, _TYPES, values['min_answer_delay'])
        self.publish_status, self.new_id = self._shell.publish_status, self._shell.new_id
        self.is_feedback_heard = host.timing.when_heard(self._shell.has_feedback_listeners)
        self._in_global_frame = InFrame(values['global_frame'])
        self._told = None  # (goal id, stamp [ns]) of the latest feedback
        self._feedback_throttle = host.throttle(values['max_feedback_rate'])
        stream.subscribe('clients', {Departed: self._departed, Ended: self._ended})

    def start(self, ledger, navigator, prefetch):
        """Take goals for ``navigator``, whose book is ``ledger``; ``prefetch(goal)`` is called before each.

        It is called without the lock and may block.
        """
        self._navigator = navigator
        self._prefetch = prefetch
        self._shell.open(ledger, lambda: navigator.feedback.frequency)
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

    def feedback(self, record, pose, stamp_ns, is_last):
        """Tell where the robot is, as often as the cap in wall time allows, and at the goal; as of GoalClient."""
        if not self._shell.has_feedback_listeners():
            return self._clock.wall_to_ns(_DEAF_SECONDS)
        told = (record.goal_id, stamp_ns)
        if self._feedback_throttle.ready() or (is_last and told != self._told):
            rollback.changes(self, '_told')
            self._told = told
            self._shell.publish_feedback(record, self._in_global_frame.pose_stamped(0, pose, stamp_ns), stamp_ns)
        return self._clock.wall_to_ns(self._feedback_throttle.remaining())

    def flush(self):
        """Send what is held back, now."""
        self._shell.flush()

    def _departed(self, _event):
        if not self._navigator.feedback.frequency:
            self._clock.hearers.falls_silent(self._navigator.robot, self._shell, 'feedback_freq')

    def _ended(self, event):
        self._shell.publish_result(event, _NO_RESULT, event.time_ns)
