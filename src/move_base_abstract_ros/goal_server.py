"""The five topics of an action server, around the core's GoalLedger: one goal at a time, no timer and no thread."""
import itertools
import time

import rospy
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
from move_base_msgs.msg import MoveBaseActionFeedback, MoveBaseActionGoal, MoveBaseActionResult, MoveBaseFeedback

from move_base_abstract.goal_ledger import GoalLedger
from move_base_abstract.units import NS_PER_S, seconds_to_ns

from . import conversions
from .lazy_latch import LazyLatch
from .outbox import Outbox

# A client that misses the acceptance of its goal misses its active_cb only, so that a shorter wait will do.
_ACCEPTANCE_SHARE = 0.25


class GoalServer:
    """Speaks the actionlib protocol on ``<ns>/{goal,cancel,status,feedback,result}`` for the action MoveBase.

    ``min_answer_delay`` [s, wall] is the shortest time between the arrival of a goal and its final answer, and a
    quarter of it the shortest before any status that shows the goal; in lockstep there is none, since an answer comes
    in a later round. The :class:`Host` repeats the status. ``trace`` is the RobotTrace that is told of endings.
    """

    def __init__(self, ns, node_name, host, trace, min_answer_delay, status_list_timeout):
        self.ns = ns
        self._host = host
        self._clock = host.clock
        self._trace = trace
        self._min_answer_delay = 0.0 if host.clock.is_lockstep else min_answer_delay
        self._arrivals = {}
        self._acceptance_wall = 0.0
        self._outbox = Outbox()
        self._counter = itertools.count(1)
        self._node_name = node_name
        self._navigator = None
        self._prefetch = None
        size = host.options.pub_queue_size
        self._status = LazyLatch(ns + '/status', GoalStatusArray, size, tcp_nodelay=True)
        self._result = rospy.Publisher(ns + '/result', MoveBaseActionResult, queue_size=size, tcp_nodelay=True)
        self._feedback = rospy.Publisher(ns + '/feedback', MoveBaseActionFeedback, queue_size=size, tcp_nodelay=True)
        self.ledger = GoalLedger(self._publish_status, self._publish_result, self._new_id,
                                 seconds_to_ns(status_list_timeout))

    def start(self, navigator, prefetch):
        """Take goals for ``navigator``; ``prefetch(goal)`` is called without the lock before each and may block."""
        self._navigator = navigator
        self._prefetch = prefetch
        with self._clock.lock:
            self._clock.now_ns()
            self._publish_status()
        self._host.status_heartbeat.add(self._repeat_status)
        size = self._host.options.sub_queue_size
        self._subscribers = [
            rospy.Subscriber(self.ns + '/cancel', GoalID, self._on_cancel, queue_size=size, tcp_nodelay=True),
            rospy.Subscriber(self.ns + '/goal', MoveBaseActionGoal, self.take, queue_size=size, tcp_nodelay=True)]

    def close(self):
        """Take no more goals and leave the graph."""
        self._host.status_heartbeat.remove(self._repeat_status)
        for topic in (*self._subscribers, self._status, self._result, self._feedback):
            topic.unregister()

    def reset(self):
        """Forget all goals."""
        self.ledger.clear()
        self._arrivals.clear()
        self._publish_status()

    def take(self, message):
        """Take a goal (MoveBaseActionGoal) in, as from the topic. May block; no lock is held."""
        goal = conversions.from_target(message.goal.target_pose)
        arrived = time.monotonic()
        self._prefetch(goal)
        with self._clock.lock:
            now_ns = self._clock.now_ns()
            self._acceptance_wall = arrived + _ACCEPTANCE_SHARE * self._min_answer_delay
            if message.goal_id.id:
                self._arrivals.setdefault(message.goal_id.id, arrived)
            self._navigator.receive(message.goal_id.id, message.goal_id.stamp.to_nsec(), goal, now_ns)

    def _on_cancel(self, message):
        with self._clock.lock:
            now_ns = self._clock.now_ns()
            self._navigator.cancel(message.id, message.stamp.to_nsec(), now_ns)

    def publish_feedback(self, record, pose_stamped, stamp_ns):
        """Publish where the robot with the goal ``record`` is."""
        self._outbox.send(self._feedback, MoveBaseActionFeedback(
            conversions.to_header('', stamp_ns), _to_status(record), MoveBaseFeedback(pose_stamped)))

    def has_feedback_listeners(self):
        """Return whether anybody subscribes to the feedback."""
        return self._feedback.get_num_connections() > 0

    def flush(self):
        """Send what is held back, now."""
        self._outbox.flush()

    def _publish_status(self):
        now_ns = self._clock.simulation.now_ns
        if self._status.is_heard():
            self._outbox.send(self._status, self._make_status(now_ns), self._acceptance_wall)
        else:
            self._status.offer(lambda: self._make_status(now_ns))

    def _make_status(self, now_ns):
        with self._clock.lock:
            return GoalStatusArray(conversions.to_header('', now_ns),
                                   [_to_status(record) for record in self.ledger.records(now_ns)])

    def _repeat_status(self, _now_ns):
        if self._status.is_heard():
            self._publish_status()

    def _publish_result(self, record, stamp_ns):
        self._trace.ended(record, stamp_ns)
        message = MoveBaseActionResult(header=conversions.to_header('', stamp_ns), status=_to_status(record))
        arrived = self._arrivals.pop(record.goal_id, None)
        self._outbox.send(self._result, message, 0.0 if arrived is None else arrived + self._min_answer_delay)

    def _new_id(self, now_ns):
        return '{}-{}-{}.{:09d}'.format(self._node_name, next(self._counter), now_ns // NS_PER_S, now_ns % NS_PER_S)


def _to_status(record):
    return GoalStatus(GoalID(conversions.to_time(record.stamp_ns), record.goal_id), record.state.value, record.text)
