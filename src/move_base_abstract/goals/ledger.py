"""The book-keeping of an action server with one goal at a time, without ROS.

The rules are those of actionlib's action server and simple action server, as clients of move_base know them: one goal
is active, the newest goal wins, and a cancel names an id, a time or all goals. A comment says where a rule differs.
"""
from __future__ import annotations

import typing
from collections import OrderedDict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, List, Optional

from ..common.units import LAST_NS
from .events import WRITTEN, Ended, GoalTaken, new
from .outcome import REPLACED, TEXT_ACCEPTED, TEXT_ANOTHER_GOAL, TEXT_BEFORE_LAST_CANCEL, GoalState, Outcome
from .task_events import TaskEnded

if TYPE_CHECKING:
    from ..engine.stream import Stream
    from .client import Client

_REMEMBERED_CANCELS = 1000


_PENDING, _ACTIVE = GoalState.PENDING, GoalState.ACTIVE  # to look a member of an Enum up is slow


@dataclass
class GoalRecord:
    """One goal: its id, the stamp of the id [ns], its state and text, and the instant [ns] of its end, or None."""

    __slots__ = ('goal_id', 'stamp_ns', 'state', 'text', 'ended_ns')

    goal_id: str
    stamp_ns: int
    state: GoalState
    text: str
    ended_ns: Optional[int]


_new_record = GoalRecord.__new__  # called without the constructor, which would take twice as long


class GoalLedger:
    """Decides what happens to goals and cancel requests.

    ``stream`` (Stream of the robot's events) gets GoalTaken for each goal that is taken in, before anything else that
    comes of it, and Ended after each ending, before ``client`` (Client) publishes the status that shows it. With
    ``of_tasks`` it gets TaskEnded alone. A goal that has ended stays on the list for ``keep_ns`` [ns]; the last
    accepted goal stays until the next one comes.
    """

    __slots__ = ('_robot_name', '_hearers', '_publish_status', '_new_id', '_keep_ns', '_taken', '_ended',
                 '_kind_of_end', '_records', '_current', 'active', '_last_cancel_ns', '_early_cancels', 'is_silent',
                 '_untold')

    def __init__(self, robot_name: str, stream: Stream, client: Client, keep_ns: int = 5_000_000_000,
                 of_tasks: bool = False) -> None:
        self._robot_name = robot_name
        self._hearers = stream.hearers
        self._publish_status, self._new_id = client.publish_status, client.new_id
        self._keep_ns = keep_ns
        self._taken: Any
        self._ended: Any
        self._taken, self._ended = (None, TaskEnded) if of_tasks else (GoalTaken, Ended)
        self._kind_of_end = WRITTEN[self._ended][0].kind
        self._records: List[GoalRecord] = []
        self._current: Optional[GoalRecord] = None
        #: the record of the goal that is being worked on, or None
        self.active: Optional[GoalRecord] = None
        self._last_cancel_ns = 0
        # A cancel may overtake its goal on another socket. actionlib forgets such a cancel after some seconds of ROS
        # time, which is very short at a high speed. Here the last 1000 are remembered, whatever their age.
        self._early_cancels: typing.OrderedDict[str, None] = OrderedDict()
        #: whether nothing is published until :meth:`answer_again`
        self.is_silent = False
        self._untold: List[GoalRecord] = []

    def records(self, now_ns: int) -> List[GoalRecord]:
        """Return the records that the status topic shows at ``now_ns`` [ns], oldest first."""
        current, since_ns = self._current, now_ns - self._keep_ns
        return [record for record in self._records
                if record is current or record.ended_ns is None or record.ended_ns >= since_ns]

    def holds_before_ns(self, now_ns: int) -> int:
        """Return the instant [ns] before which :meth:`records` stays as at ``now_ns`` [ns] if nothing happens."""
        ends = [record.ended_ns for record in self.records(now_ns)
                if record is not self._current and record.ended_ns is not None]
        return min(ends) + self._keep_ns + 1 if ends else LAST_NS

    def receive(self, goal_id: str, stamp_ns: int, now_ns: int) -> Optional[GoalRecord]:
        """Take a goal in; return its record if it is accepted, which ends the goal that was active; None otherwise.

        A ``stamp_ns`` [ns] of 0 and an empty ``goal_id`` mean that it is not given.
        """
        records, current, since_ns = [], self._current, now_ns - self._keep_ns
        for record in self._records:
            if record is current or record.ended_ns is None or record.ended_ns >= since_ns:  # as in records()
                if goal_id and record.goal_id == goal_id:
                    self._take_again(record, now_ns)
                    return None
                records.append(record)
        self._records = records
        record = _new_record(GoalRecord)
        record.goal_id, record.stamp_ns = goal_id or self._new_id(now_ns), stamp_ns or now_ns
        record.state, record.text, record.ended_ns = _PENDING, '', None
        records.append(record)
        self._tell_taken(record, now_ns)
        if self._early_cancels and record.goal_id in self._early_cancels:
            del self._early_cancels[record.goal_id]
            self.finish(Outcome(GoalState.RECALLED), now_ns, record)
            return None
        if stamp_ns and stamp_ns <= self._last_cancel_ns:
            self.finish(Outcome(GoalState.RECALLED, TEXT_BEFORE_LAST_CANCEL), now_ns, record)
            return None
        if current is not None and record.stamp_ns < current.stamp_ns:
            self.finish(Outcome(GoalState.RECALLED, TEXT_ANOTHER_GOAL), now_ns, record)
            return None
        self._accept(record, now_ns)
        return record

    def _take_again(self, record: GoalRecord, now_ns: int) -> None:
        """Take in a goal whose id is on the list already; if it was cancelled before it came, it is recalled."""
        if record.state is GoalState.RECALLING:
            self._early_cancels.pop(record.goal_id, None)
            self._tell_taken(record, now_ns)
            self.finish(Outcome(GoalState.RECALLED), now_ns, record)
        elif record.ended_ns is not None:
            record.ended_ns = now_ns

    def _accept(self, record: GoalRecord, now_ns: int) -> None:
        try:
            if self.active is not None:
                self.finish(REPLACED, now_ns)
        finally:  # also after an error, since a goal that is neither active nor ended would be lost
            current = self._current
            if current is not None and current.ended_ns is not None:
                current.ended_ns = now_ns
            self._current = self.active = record
            record.state, record.text = _ACTIVE, TEXT_ACCEPTED
        if self._publish_status is not None:
            self._publish_status()

    def finish(self, outcome: Outcome, stamp_ns: int, record: Optional[GoalRecord] = None) -> None:
        """End the goal of ``record`` with ``outcome`` at ``stamp_ns`` [ns]; None: the active goal, if there is one."""
        if record is None:
            record = self.active
            if record is None:
                return
        record.state, record.text, record.ended_ns = outcome.state, outcome.text, stamp_ns
        if record is self.active:
            self.active = None
        if self.is_silent:
            self._untold.append(record)
            return
        try:
            self._tell_end(record, stamp_ns)
        finally:
            if self._publish_status is not None:
                self._publish_status()

    def _tell_taken(self, record: GoalRecord, now_ns: int) -> None:
        hear = self._hearers.get(self._taken)
        if hear is not None:
            hear(new(GoalTaken, (now_ns, self._robot_name, 'goal', record.goal_id)))

    def _tell_end(self, record: GoalRecord, stamp_ns: int) -> None:
        hear = self._hearers.get(self._ended)
        if hear is not None:
            state = record.state
            hear(new(self._ended, (stamp_ns, self._robot_name, self._kind_of_end, record.goal_id, state._name_,
                                   record.text, record.stamp_ns, state)))

    def cancel(self, goal_id: str, stamp_ns: int, now_ns: int) -> bool:
        """Take a cancel request in; return whether it cancels the active goal, which then becomes PREEMPTING.

        Without id and stamp it cancels all goals; with an id, that goal; with a stamp [ns], also all goals whose stamp
        is not later. An id that is not on the list is listed as RECALLING and remembered for a goal yet to come.
        """
        hits_active = False
        found = False
        self._records = self.records(now_ns)
        for record in list(self._records):
            matches_id = goal_id == record.goal_id
            everything = not goal_id and not stamp_ns
            found = found or matches_id
            if not (everything or matches_id or (stamp_ns and record.stamp_ns <= stamp_ns)):
                continue
            if record is self.active and record.state is GoalState.ACTIVE:
                record.state = GoalState.PREEMPTING
                if self._publish_status is not None:
                    self._publish_status()
                hits_active = True
        if goal_id and not found:
            self._remember_cancel(goal_id, stamp_ns, now_ns)
        self._last_cancel_ns = max(self._last_cancel_ns, stamp_ns)
        return hits_active

    def answer_again(self, now_ns: int) -> None:
        """End the silence: publish at ``now_ns`` [ns] the results of the goals that have ended meanwhile."""
        if not self.is_silent:
            return
        self.is_silent = False
        untold, self._untold = self._untold, []
        for record in untold:
            record.ended_ns = now_ns
            self._tell_end(record, now_ns)
        if self._publish_status is not None:
            self._publish_status()

    def clear(self) -> None:
        """Forget all goals and cancels, ended or not; publish nothing."""
        self._records = []
        self._current = self.active = None
        self._last_cancel_ns = 0
        self._early_cancels.clear()

    def restart(self, now_ns: int) -> None:
        """Go on with a clock that has started anew at ``now_ns`` [ns]; no goal is active then.

        Goals that have ended stay on the list as if they had ended now. The stamps of new goals are not compared with
        stamps of the old clock.
        """
        for record in self._records:
            record.ended_ns = now_ns
        self._current = self.active = None
        self._last_cancel_ns = 0

    def _remember_cancel(self, goal_id: str, stamp_ns: int, now_ns: int) -> None:
        self._early_cancels[goal_id] = None
        while len(self._early_cancels) > _REMEMBERED_CANCELS:
            self._early_cancels.popitem(last=False)
        self._records.append(GoalRecord(goal_id, stamp_ns, GoalState.RECALLING, '', now_ns))
