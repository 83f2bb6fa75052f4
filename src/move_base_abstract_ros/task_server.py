"""The action TimedTask of one robot: the five topics of an action server around the core's TimedTaskRunner."""
import itertools
import time

import genpy
import rospy
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray

from move_base_abstract.goal_ledger import GoalLedger
from move_base_abstract.msg import (
    TimedTaskActionFeedback,
    TimedTaskActionGoal,
    TimedTaskActionResult,
    TimedTaskFeedback,
    TimedTaskResult,
)
from move_base_abstract.outcome import NODE_KILLED, GoalState
from move_base_abstract.robot_trace import TraceEntry
from move_base_abstract.timed_task import TimedTaskRunner
from move_base_abstract.units import NS_PER_S

from . import conversions, lockstep
from .lazy_latch import LazyLatch
from .outbox import Outbox


class TaskServer:
    """Speaks the actionlib protocol on ``<ns>/{goal,cancel,status,feedback,result}`` for the action TimedTask.

    ``min_answer_delay`` [s, wall] is the shortest time between a goal's arrival and its final answer, as of GoalServer.
    """

    def __init__(self, ns, host, robot_index, durations, feedback_frequency, min_answer_delay):
        self.ns = ns
        self._clock = host.clock
        self._record = self._clock.record(robot_index)
        self._min_answer_delay = 0.0 if self._clock.is_lockstep else min_answer_delay
        self._arrivals = {}
        self._outbox = Outbox()
        self._counter = itertools.count(1)
        self._throttle = host.throttle(50.0)
        with lockstep.sender(robot_index):
            self._advertise(host.options.pub_queue_size)
            ledger = GoalLedger(self._publish_status, self._publish_result, self._new_id)
            self._ledger = ledger
            with self._clock.lock:
                self._clock.now_ns()
                self._tasks = TimedTaskRunner(self._clock.simulation, robot_index, ledger, durations, self._begun,
                                              self._publish_feedback, feedback_frequency)
                self._publish_status()
            host.status_heartbeat.add(self._repeat_status)
            self._subscribe(host.options.sub_queue_size)
        self._clock.on_restart.append(self._tasks.restart)
        host.robot_count += 1

    def _advertise(self, size):
        self._status = LazyLatch(self.ns + '/status', GoalStatusArray, size, tcp_nodelay=True)
        self._result = rospy.Publisher(self.ns + '/result', TimedTaskActionResult, queue_size=size, tcp_nodelay=True)
        self._feedback = rospy.Publisher(self.ns + '/feedback', TimedTaskActionFeedback, queue_size=size,
                                         tcp_nodelay=True)

    def _subscribe(self, size):
        self._subscribers = [
            rospy.Subscriber(self.ns + '/cancel', GoalID, self._on_cancel, queue_size=size, tcp_nodelay=True),
            rospy.Subscriber(self.ns + '/goal', TimedTaskActionGoal, self._on_goal, queue_size=size, tcp_nodelay=True)]

    def shut_down(self):
        """End the task that is under way as a killed server does, and let the answer leave."""
        with self._clock.lock:
            self._tasks.shut_down(NODE_KILLED, self._clock.now_ns())
        self._outbox.flush()

    def _on_goal(self, message):
        with self._clock.lock:
            now_ns = self._clock.now_ns()
            if message.goal_id.id:
                self._arrivals.setdefault(message.goal_id.id, time.monotonic())
            self._tasks.receive(message.goal_id.id, message.goal_id.stamp.to_nsec(), message.goal.duration.to_nsec(),
                                now_ns)

    def _on_cancel(self, message):
        with self._clock.lock:
            self._tasks.cancel(message.id, message.stamp.to_nsec(), self._clock.now_ns())

    def _begun(self, record, duration_ns, now_ns):
        self._trace(now_ns, 'task_began', record.goal_id, duration_ns)

    def _publish_feedback(self, record, elapsed_ns, duration_ns, now_ns):
        is_last = elapsed_ns == duration_ns
        if self._feedback.get_num_connections() and (self._throttle.ready() or is_last):
            feedback = TimedTaskFeedback(_to_duration(elapsed_ns), elapsed_ns / duration_ns if duration_ns else 1.0)
            self._outbox.send(self._feedback, TimedTaskActionFeedback(conversions.to_header('', now_ns),
                                                                      _to_status(record), feedback))

    def _publish_result(self, record, stamp_ns):
        self._trace(stamp_ns, 'task_ended', record.goal_id, record.state.name)
        took_ns = 0 if record.state is GoalState.RECALLED else self._tasks.elapsed_ns(stamp_ns)
        message = TimedTaskActionResult(conversions.to_header('', stamp_ns), _to_status(record),
                                        TimedTaskResult(_to_duration(took_ns)))
        arrived = self._arrivals.pop(record.goal_id, None)
        self._outbox.send(self._result, message, 0.0 if arrived is None else arrived + self._min_answer_delay)

    def _publish_status(self):
        now_ns = self._clock.simulation.now_ns
        if self._status.is_heard():
            self._outbox.send(self._status, self._make_status(now_ns))
        else:
            self._status.offer(lambda: self._make_status(now_ns))

    def _make_status(self, now_ns):
        with self._clock.lock:
            return GoalStatusArray(conversions.to_header('', now_ns),
                                   [_to_status(record) for record in self._ledger.records(now_ns)])

    def _repeat_status(self, _now_ns):
        if self._status.is_heard():
            self._publish_status()

    def _trace(self, time_ns, kind, *values):
        if self._record is not None:
            self._record(TraceEntry(time_ns, self.ns.strip('/'), kind, values))

    def _new_id(self, now_ns):
        return '{}-{}-{}.{:09d}'.format(self.ns, next(self._counter), now_ns // NS_PER_S, now_ns % NS_PER_S)


def _to_duration(duration_ns):
    return genpy.Duration(duration_ns // NS_PER_S, duration_ns % NS_PER_S)


def _to_status(record):
    return GoalStatus(GoalID(conversions.to_time(record.stamp_ns), record.goal_id), record.state.value, record.text)
