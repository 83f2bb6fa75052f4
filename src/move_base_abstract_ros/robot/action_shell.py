"""The five topics of an action server, around the core's GoalLedger: one goal at a time, no timer and no thread."""
from __future__ import annotations

import itertools
import time
from typing import TYPE_CHECKING, Any, Callable, Dict, List, NamedTuple, Union

import rospy
from actionlib_msgs.msg import GoalID, GoalStatusArray

from move_base_abstract.common.units import NS_PER_S

from .. import lockstep
from ..lockstep.exchange import playing
from ..messages import packing
from ..messages.outbox import Outbox
from ..messages.outlets import LatchedOutlet, Outlet, Packed

if TYPE_CHECKING:
    from move_base_abstract.config.rates import Rate
    from move_base_abstract.goals.events import Ended
    from move_base_abstract.goals.ledger import GoalLedger, GoalRecord
    from move_base_abstract.goals.task_events import TaskEnded

    from ..messages.outlets import Publish
    from ..messages.packing import Pack, Slots
    from .host import Host


# A client that misses the acceptance of its goal misses only its active_cb, so a shorter wait is enough.
_ACCEPTANCE_SHARE = 0.25
_HASTY_SECONDS = 0.2  # wall
_KEPT_ARRIVALS = 1000


class ActionTypes(NamedTuple):
    """The message types of an action's three topics; ``goal_in`` is the class in which goals are received."""

    goal_in: Any
    result: Any
    feedback: Any


class ActionShell:
    """Speaks the actionlib protocol on ``<ns>/{goal,cancel,status,feedback,result}`` for one action of ``types``.

    ``id_prefix``: the beginning of the ids that it gives to goals without one. ``min_answer_delay`` [s, wall]: the
    shortest time between the arrival of a goal and its final answer. A quarter of it is the shortest time before any
    status that shows the goal. In lockstep there is no such delay. The :class:`Host` repeats the status.

    It has the methods that a GoalLedger needs: ``publish_status()`` and ``new_id(now_ns)``.
    """

    def __init__(self, ns: str, id_prefix: str, host: Host, types: ActionTypes, min_answer_delay: float) -> None:
        self.ns = ns
        self._id_prefix = id_prefix
        self._host = host
        self._clock = host.clock
        self._types = types
        self._min_answer_delay = host.timing.answer_delay(min_answer_delay)
        self._ledger: Any = None
        self._arrivals: Dict[str, float] = {}  # {goal id: s, time.monotonic}
        self._acceptance_wall = 0.0
        self._outbox = Outbox()
        self._has_told_end = False
        self._counter = itertools.count(1)
        self._packed = None, b''
        self._subscribers: Any = ()
        self._told: List[Rate] = []
        size = host.options.pub_queue_size
        self._status = LatchedOutlet(ns + '/status', GoalStatusArray, self._pack_status, size, tcp_nodelay=True)
        self._result = Outlet(ns + '/result', types.result, size, tcp_nodelay=True)
        self._feedback = Outlet(ns + '/feedback', types.feedback, size, tcp_nodelay=True, greet=self._greet)
        #: returns the values of :meth:`publish_feedback` for a new listener of feedback, or None
        self.present_feedback: Callable[[], Any] = lambda: None
        self.has_feedback_listeners = self._feedback.is_heard
        #: returns the nodes that listen to feedback, as Outlet.hearers does
        self.hearers = self._feedback.hearers

    def open(self, ledger: GoalLedger, feedback_frequency: Callable[[], float]) -> None:
        """Publish the status of the goals of ``ledger`` (GoalLedger) from now on.

        ``feedback_frequency()`` returns the rate of the feedback [Hz, simulated].
        """
        self._ledger = ledger
        with self._clock.lock:
            self._clock.now_ns()
            self.publish_status()
        self._host.status_heartbeat.add(self._repeat_status, self._status.is_heard_again)
        with self._clock.lock:
            self._told = [
                self._host.rates.add('feedback', feedback_frequency, self._feedback.hearers),
                self._host.rates.add('status', lambda: self._host.options.status_frequency,
                                     self._status.hearers_of_repetition)]

    def listen(self, on_goal: Callable[[Any], object], on_cancel: Callable[[Any], object]) -> None:
        """Call ``on_goal(message)``, of the class ``types.goal_in``, and ``on_cancel(GoalID)`` from now on."""
        size = self._host.options.sub_queue_size
        self._subscribers = (
            rospy.Subscriber(self.ns + '/cancel', GoalID, on_cancel, queue_size=size, tcp_nodelay=True),
            rospy.Subscriber(self.ns + '/goal', self._types.goal_in, on_goal, queue_size=size, tcp_nodelay=True))

    def close(self) -> None:
        """Take no more goals, and unregister all topics."""
        self._host.status_heartbeat.remove(self._repeat_status)
        for told in self._told:
            self._host.rates.remove(told)
        for topic in (*self._subscribers, self._status, self._result, self._feedback):
            topic.unregister()

    def forget_arrivals(self) -> None:
        """Forget when goals came: they will get no answer."""
        self._arrivals.clear()

    def arrived(self, goal_id: str, wall: float) -> None:
        """Note that a goal with this id (or '') came at ``wall`` [s, time.monotonic]. The caller holds the lock."""
        if self._min_answer_delay:
            self._acceptance_wall = wall + _ACCEPTANCE_SHARE * self._min_answer_delay
            if goal_id:
                self._arrivals.setdefault(goal_id, wall)
                if len(self._arrivals) > _KEPT_ARRIVALS:  # the oldest ones are of ids that were answered long ago
                    del self._arrivals[next(iter(self._arrivals))]

    def publish_feedback(self, record: GoalRecord, feedback: bytes, stamp_ns: int, slots: Slots = None) -> None:
        """Publish ``feedback`` (the action's own part, bytes) on the goal ``record``, stamped ``stamp_ns`` [ns].

        ``slots``: those of ``feedback``, as in :class:`.packing.Template`.
        """
        self._outbox.send(self._feedback, self._pack_feedback(record, feedback, stamp_ns, slots))

    def _pack_feedback(self, record: GoalRecord, feedback: bytes, stamp_ns: int, slots: Slots = None) -> Pack:
        before = self._pack(record)
        told = before + feedback
        return packing.Template(lambda seq: packing.header(seq, stamp_ns) + told,
                                packing.behind_header(len(before), slots))

    def _greet(self, peer_publish: Publish) -> None:
        present = self.present_feedback()
        if present is not None:
            peer_publish(Packed(self._pack_feedback(*present)))

    def publish_result(self, record: Union[Ended, TaskEnded], result: bytes, stamp_ns: int) -> None:
        """Publish that the goal ``record`` (GoalRecord, Ended or TaskEnded) ended at ``stamp_ns`` [ns].

        ``result``: the action's own part of the message, as bytes.
        """
        arrived = self._arrivals.pop(record.goal_id, None)
        told = self._pack(record) + result
        not_before = 0.0 if arrived is None else arrived + self._min_answer_delay
        if self._min_answer_delay and self._status.is_heard():
            # A client sends its next goal when it hears the result. If it cancels that at once, and then hears a status
            # from before it, the goal is LOST to it. So the status that shows the end goes first, and well before the
            # result, unless the goal is so old that its client does not send one goal after the other.
            self.publish_status()
            self._has_told_end = True
            now = time.monotonic()
            if now < not_before + _HASTY_SECONDS:
                not_before = max(not_before, now + _ACCEPTANCE_SHARE * self._min_answer_delay)
        self._outbox.send(self._result, lambda seq: packing.header(seq, stamp_ns) + told, not_before)

    def publish_status(self) -> None:
        """Publish the status of all goals, and latch it for later listeners. If the ledger is silent, do nothing."""
        if self._ledger.is_silent:
            return
        if self._has_told_end:
            self._has_told_end = False  # this is the status that publish_result() has sent
            return
        now_ns = self._clock.simulation.now_ns
        if self._min_answer_delay and self._status.is_heard():
            self._outbox.send(self._status, self._pack_status(now_ns), self._acceptance_wall)
        else:
            self._status.show(now_ns)

    def flush(self) -> None:
        """Send now all messages that are held back."""
        self._outbox.flush()

    def new_id(self, now_ns: int) -> str:
        """Return an id for a goal that came without one at ``now_ns`` [ns]."""
        return '{}-{}-{}.{:09d}'.format(self._id_prefix, next(self._counter), now_ns // NS_PER_S, now_ns % NS_PER_S)

    def _pack_status(self, now_ns: int) -> Pack:
        with self._clock.lock:
            told = [self._pack(record) for record in self._ledger.records(now_ns)]
            playing.holds_before(self._ledger.holds_before_ns(now_ns))
        return packing.Template(lambda seq: packing.statuses(seq, told, now_ns), packing.HEADER_SLOTS)

    def _pack(self, record: Union[Ended, TaskEnded, GoalRecord]) -> bytes:
        """Return the bytes of the GoalStatus of ``record``. The latest are kept, since they are often sent again."""
        said: Any = record.goal_id, record.stamp_ns, record.state, record.text
        if said != self._packed[0]:
            self._packed = said, packing.status(said[0], said[1], record.state.value, said[3])
        return self._packed[1]

    def _repeat_status(self, _now_ns: int) -> None:
        if self._outbox.is_waiting():
            return  # the status is under way, and would be the one from before the next goal
        with lockstep.repetition():
            self.publish_status()
