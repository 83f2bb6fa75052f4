"""The book-keeping of an action server with one goal at a time, without ROS.

The rules are those of actionlib's action server and simple action server, as clients of move_base know them: one
active goal, the newest wins, cancels by id, by time or of all. What differs is said where it does.
"""
from collections import OrderedDict
from dataclasses import dataclass
from typing import Optional

from .outcome import REPLACED, TEXT_ACCEPTED, TEXT_ANOTHER_GOAL, TEXT_BEFORE_LAST_CANCEL, GoalState, Outcome

_REMEMBERED_CANCELS = 1000


@dataclass
class GoalRecord:
    """One goal: its id, the stamp of the id [ns], its state and text, and since when it has ended [ns] or None."""

    goal_id: str
    stamp_ns: int
    state: GoalState = GoalState.PENDING
    text: str = ''
    ended_ns: Optional[int] = None


class GoalLedger:
    """Decides what happens to goals and cancel requests.

    ``publish_status()`` is called after each transition, ``publish_result(record, stamp_ns)`` after each ending, before
    the status that shows it. ``new_id(now_ns)`` names goals that come without an id. A goal that has ended stays on
    the list for ``keep_ns`` [ns], the last accepted one until the next has come.
    """

    def __init__(self, publish_status, publish_result, new_id, keep_ns=5_000_000_000):
        self._publish_status = publish_status
        self._publish_result = publish_result
        self._new_id = new_id
        self._keep_ns = keep_ns
        self._records = []
        self._current = None
        #: the record of the goal that is being worked on, or None
        self.active = None
        self._last_cancel_ns = 0
        # A cancel may overtake its goal on another socket. Upstream forgets it after some seconds of ROS time, which
        # at a high speed is no time at all; here it is remembered by number, not by age.
        self._early_cancels = OrderedDict()
        #: whether it says nothing for now
        self.is_silent = False
        self._untold = []

    def records(self, now_ns):
        """Return the records that the status topic shows at ``now_ns`` [ns], oldest first."""
        current, since_ns = self._current, now_ns - self._keep_ns
        return [record for record in self._records
                if record is current or record.ended_ns is None or record.ended_ns >= since_ns]

    def receive(self, goal_id, stamp_ns, now_ns):
        """Take a goal in and return its record if it is to be worked on now, else None.

        The goal that was active is ended by this. ``stamp_ns`` [ns] 0 and an empty ``goal_id`` mean: not given.
        """
        records, current, since_ns = [], self._current, now_ns - self._keep_ns
        for record in self._records:
            if record is current or record.ended_ns is None or record.ended_ns >= since_ns:  # as of records()
                if goal_id and record.goal_id == goal_id:
                    self._take_again(record, now_ns)
                    return None
                records.append(record)
        self._records = records
        record = GoalRecord(goal_id or self._new_id(now_ns), stamp_ns or now_ns)
        records.append(record)
        if record.goal_id in self._early_cancels:
            del self._early_cancels[record.goal_id]
            self._end(record, Outcome(GoalState.RECALLED), now_ns)
            return None
        if stamp_ns and stamp_ns <= self._last_cancel_ns:
            self._end(record, Outcome(GoalState.RECALLED, TEXT_BEFORE_LAST_CANCEL), now_ns)
            return None
        if self._current is not None and record.stamp_ns < self._current.stamp_ns:
            self._end(record, Outcome(GoalState.RECALLED, TEXT_ANOTHER_GOAL), now_ns)
            return None
        self._accept(record, now_ns)
        return record

    def _take_again(self, record, now_ns):
        """The list holds the goal already; one that was cancelled before it came is recalled."""
        if record.state is GoalState.RECALLING:
            self._early_cancels.pop(record.goal_id, None)
            self._end(record, Outcome(GoalState.RECALLED), now_ns)
        elif record.ended_ns is not None:
            record.ended_ns = now_ns

    def _accept(self, record, now_ns):
        try:
            if self.active is not None:
                self._end(self.active, REPLACED, now_ns)
        finally:  # a goal that is neither active nor at its end would be lost
            if self._current is not None and self._current.ended_ns is not None:
                self._current.ended_ns = now_ns
            self._current = self.active = record
            record.state, record.text = GoalState.ACTIVE, TEXT_ACCEPTED
        self._publish_status()

    def finish(self, outcome, stamp_ns):
        """End the active goal with ``outcome`` at ``stamp_ns`` [ns]. Without an active goal this does nothing."""
        if self.active is not None:
            self._end(self.active, outcome, stamp_ns)

    def _end(self, record, outcome, stamp_ns):
        record.state, record.text, record.ended_ns = outcome.state, outcome.text, stamp_ns
        if record is self.active:
            self.active = None
        if self.is_silent:
            self._untold.append(record)
            return
        try:
            self._publish_result(record, stamp_ns)
        finally:
            self._publish_status()

    def cancel(self, goal_id, stamp_ns, now_ns):
        """Take a cancel request in; return whether it is for the active goal, which then shows as PREEMPTING.

        No id and no stamp: all goals. An id: that goal. A stamp [ns]: also all whose stamp is not later. An id that is
        not on the list is remembered for a goal that has yet to come, and listed as RECALLING.
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
                self._publish_status()
                hits_active = True
        if goal_id and not found:
            self._remember_cancel(goal_id, stamp_ns, now_ns)
        self._last_cancel_ns = max(self._last_cancel_ns, stamp_ns)
        return hits_active

    def go_silent(self):
        """Publish nothing until :meth:`answer_again`."""
        self.is_silent = True

    def answer_again(self, now_ns):
        """Publish at ``now_ns`` [ns] what has ended while it was silent, and go on as ever."""
        if not self.is_silent:
            return
        self.is_silent = False
        untold, self._untold = self._untold, []
        for record in untold:
            record.ended_ns = now_ns
            self._publish_result(record, now_ns)
        self._publish_status()

    def clear(self):
        """Forget all goals and cancels, ended or not, without a word to anybody."""
        self._records = []
        self._current = self.active = None
        self._last_cancel_ns = 0
        self._early_cancels.clear()

    def restart(self, now_ns):
        """Go on with a clock that has started anew at ``now_ns`` [ns]; no goal is active.

        What has ended stays on the list as if it had ended now. New goals are compared with no stamp of the old clock.
        """
        for record in self._records:
            record.ended_ns = now_ns
        self._current = self.active = None
        self._last_cancel_ns = 0

    def _remember_cancel(self, goal_id, stamp_ns, now_ns):
        self._early_cancels[goal_id] = None
        while len(self._early_cancels) > _REMEMBERED_CANCELS:
            self._early_cancels.popitem(last=False)
        self._records.append(GoalRecord(goal_id, stamp_ns, GoalState.RECALLING, ended_ns=now_ns))
