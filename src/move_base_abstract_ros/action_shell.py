"""The five topics of an action server, around the core's GoalLedger: one goal at a time, no timer and no thread."""
import itertools
from typing import Any, NamedTuple

import rospy
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray

from move_base_abstract.units import NS_PER_S

from . import conversions
from .lazy_latch import LazyLatch
from .outbox import Outbox

# A client that misses the acceptance of its goal misses its active_cb only, so that a shorter wait will do.
_ACCEPTANCE_SHARE = 0.25


class ActionTypes(NamedTuple):
    """The message types of an action's three topics."""

    goal: Any
    result: Any
    feedback: Any


class ActionShell:
    """Speaks the actionlib protocol on ``<ns>/{goal,cancel,status,feedback,result}`` for one action of ``types``.

    ``id_prefix`` is what the ids begin with that goals without one get. ``min_answer_delay`` [s, wall] is the shortest
    time between the arrival of a goal and its final answer, and a quarter of it the shortest before any status that
    shows the goal, as far as the host's timing wants such a delay. The :class:`Host` repeats the status.

    Has what a GoalLedger asks for: ``publish_status()`` and ``new_id(now_ns)``.
    """

    def __init__(self, ns, id_prefix, host, types, min_answer_delay):
        self.ns = ns
        self._id_prefix = id_prefix
        self._host = host
        self._clock = host.clock
        self._types = types
        self._min_answer_delay = host.timing.answer_delay(min_answer_delay)
        self._ledger = None
        self._arrivals = {}
        self._acceptance_wall = 0.0
        self._outbox = Outbox()
        self._counter = itertools.count(1)
        self._subscribers = ()
        size = host.options.pub_queue_size
        self._status = LazyLatch(ns + '/status', GoalStatusArray, size, tcp_nodelay=True)
        self._result = rospy.Publisher(ns + '/result', types.result, queue_size=size, tcp_nodelay=True)
        self._feedback = rospy.Publisher(ns + '/feedback', types.feedback, queue_size=size, tcp_nodelay=True)

    def open(self, ledger):
        """Show the goals of ``ledger`` (GoalLedger); the clock's time is the present."""
        self._ledger = ledger
        with self._clock.lock:
            self._clock.now_ns()
            self.publish_status()
        self._host.status_heartbeat.add(self._repeat_status)

    def listen(self, on_goal, on_cancel):
        """Hand messages over from now on: ``on_goal(message)``, of the goal's type, and ``on_cancel(GoalID)``."""
        size = self._host.options.sub_queue_size
        self._subscribers = (
            rospy.Subscriber(self.ns + '/cancel', GoalID, on_cancel, queue_size=size, tcp_nodelay=True),
            rospy.Subscriber(self.ns + '/goal', self._types.goal, on_goal, queue_size=size, tcp_nodelay=True))

    def close(self):
        """Take no more goals and leave the graph."""
        self._host.status_heartbeat.remove(self._repeat_status)
        for topic in (*self._subscribers, self._status, self._result, self._feedback):
            topic.unregister()

    def forget_arrivals(self):
        """Forget when goals came; they will not be answered."""
        self._arrivals.clear()

    def arrived(self, goal_id, wall):
        """Note that a goal with this id ('': none) came at ``wall`` [s, time.monotonic]; the caller holds the lock."""
        self._acceptance_wall = wall + _ACCEPTANCE_SHARE * self._min_answer_delay
        if goal_id:
            self._arrivals.setdefault(goal_id, wall)

    def has_feedback_listeners(self):
        """Return whether anybody subscribes to the feedback."""
        return self._feedback.get_num_connections() > 0

    def publish_feedback(self, record, feedback, stamp_ns):
        """Publish ``feedback``, of the action's own type, on the goal ``record`` at ``stamp_ns`` [ns]."""
        self._outbox.send(self._feedback, self._types.feedback(
            conversions.to_header('', stamp_ns), to_status(record), feedback))

    def publish_result(self, record, result, stamp_ns):
        """Publish that the goal ``record`` ended at ``stamp_ns`` [ns] with ``result``, of the action's own type."""
        arrived = self._arrivals.pop(record.goal_id, None)
        self._outbox.send(self._result, self._types.result(
            conversions.to_header('', stamp_ns), to_status(record), result),
            0.0 if arrived is None else arrived + self._min_answer_delay)

    def publish_status(self):
        """Publish which goals there are; who comes later gets it, too."""
        now_ns = self._clock.simulation.now_ns
        if self._status.is_heard():
            self._outbox.send(self._status, self._make_status(now_ns), self._acceptance_wall)
        else:
            self._status.offer(lambda: self._make_status(now_ns))

    def flush(self):
        """Send what is held back, now."""
        self._outbox.flush()

    def new_id(self, now_ns):
        """Return an id for a goal that came without one at ``now_ns`` [ns]."""
        return '{}-{}-{}.{:09d}'.format(self._id_prefix, next(self._counter), now_ns // NS_PER_S, now_ns % NS_PER_S)

    def _make_status(self, now_ns):
        with self._clock.lock:
            return GoalStatusArray(conversions.to_header('', now_ns),
                                   [to_status(record) for record in self._ledger.records(now_ns)])

    def _repeat_status(self, _now_ns):
        if self._status.is_heard():
            self.publish_status()


def to_status(record):
    """Return the actionlib_msgs/GoalStatus of a GoalRecord."""
    return GoalStatus(GoalID(conversions.to_time(record.stamp_ns), record.goal_id), record.state.value, record.text)
