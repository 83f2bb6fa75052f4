"""The action TimedTask of one robot: it passes messages to the core's TimedTaskRunner, and publishes the answers."""
import struct
import time

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.goals.ledger import GoalLedger
from move_base_abstract.goals.outcome import GoalState
from move_base_abstract.msg import TimedTaskActionFeedback, TimedTaskActionGoal, TimedTaskActionResult
from move_base_abstract.tasks.timed_task import TimedTaskRunner

from .. import lockstep
from .action_shell import ActionShell, ActionTypes

_TYPES = ActionTypes(TimedTaskActionGoal, TimedTaskActionResult, TimedTaskActionFeedback)


class TaskServer:
    """The action TimedTask on the topics of an :class:`ActionShell` at ``ns``.

    ``durations``: the DrawnDurations of the tasks; ``feedback_frequency`` [Hz, simulated]; ``min_answer_delay``
    [s, wall], as for ActionShell.
    """

    def __init__(self, ns, host, robot_index, durations, feedback_frequency, min_answer_delay):
        self.ns = ns
        self._clock = host.clock
        self._record = host.events.record(robot_index)
        self._throttle = host.throttle(50.0)
        with lockstep.sender(robot_index):
            self._shell = ActionShell(ns, ns, host, _TYPES, min_answer_delay)
            ledger = GoalLedger(self._shell.publish_status, self._publish_result, self._shell.new_id)
            with self._clock.lock:
                self._clock.now_ns()
                self._tasks = TimedTaskRunner(self._clock.simulation, robot_index, ledger, durations, self._begun,
                                              self._publish_feedback, feedback_frequency,
                                              host.timing.when_heard(self._shell.has_feedback_listeners))
            self._shell.open(ledger, lambda: feedback_frequency)
            self._shell.listen(self._on_goal, self._on_cancel)
        self._clock.follow_restarts(self._tasks.restart)
        host.add_robot()

    def shut_down(self, outcome):
        """End the task that is under way with an Outcome, and send its answer."""
        with self._clock.lock:
            self._tasks.shut_down(outcome, self._clock.now_ns())
        self._shell.flush()

    def _on_goal(self, message):
        with self._clock.lock:
            now_ns = self._clock.now_ns()
            self._shell.arrived(message.goal_id.id, time.monotonic())
            self._tasks.receive(message.goal_id.id, message.goal_id.stamp.to_nsec(), message.goal.duration.to_nsec(),
                                now_ns)

    def _on_cancel(self, message):
        with self._clock.lock:
            self._tasks.cancel(message.id, message.stamp.to_nsec(), self._clock.now_ns())

    def _begun(self, record, duration_ns, now_ns):
        self._trace(now_ns, 'task_began', record.goal_id, duration_ns)

    def _publish_feedback(self, record, elapsed_ns, duration_ns, now_ns):
        is_last = elapsed_ns == duration_ns
        if self._shell.has_feedback_listeners() and (self._throttle.ready() or is_last):
            feedback = pack_feedback(elapsed_ns, elapsed_ns / duration_ns if duration_ns else 1.0)
            self._shell.publish_feedback(record, feedback, now_ns)

    def _publish_result(self, record, stamp_ns):
        self._trace(stamp_ns, 'task_ended', record.goal_id, record.state.name)
        took_ns = 0 if record.state is GoalState.RECALLED else self._tasks.elapsed_ns(stamp_ns)
        self._shell.publish_result(record, pack_result(took_ns), stamp_ns)

    def _trace(self, time_ns, kind, *values):
        self._record((time_ns, self.ns.strip('/'), kind, *values))


def pack_result(took_ns):
    """Return the bytes of a TimedTaskResult: the time that the task took [ns]."""
    return struct.pack('<ii', took_ns // NS_PER_S, took_ns % NS_PER_S)


def pack_feedback(elapsed_ns, progress):
    """Return the bytes of a TimedTaskFeedback: the time worked on the task so far [ns], and the share that is done."""
    return struct.pack('<iif', elapsed_ns // NS_PER_S, elapsed_ns % NS_PER_S, progress)
