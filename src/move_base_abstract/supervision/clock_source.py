"""Which clock counts: distinguishes a clock that has restarted from two clocks that disturb each other."""
from __future__ import annotations

from enum import Enum
from typing import Optional


class Step(Enum):
    """The meaning of a message of a clock: time goes on, stays, is that of another clock (BEHIND), or restarts."""

    ON = 'on'
    SAME = 'same'
    BEHIND = 'behind'
    ANEW = 'anew'


class ClockSource:
    """Judges messages that contain a time and the name of its source.

    If time goes back, the clock has restarted if the message is from the source of the latest time, or if that source
    has been silent for more than ``patience`` [s, wall]. Otherwise two clocks are running, and the one that is behind
    does not count. Wall times are arguments [s, of one clock that never goes back].
    """

    def __init__(self, patience: float = 3.0) -> None:
        self._patience = patience
        #: the time that counts [ns], and its source, or None
        self.latest_ns = 0
        self.leader: Optional[str] = None
        self._heard = 0.0

    def judge(self, time_ns: int, source: str, wall: float) -> Step:
        """Return the :class:`Step` of the message ``time_ns`` [ns] from ``source``, which came at ``wall`` [s]."""
        if time_ns == self.latest_ns:
            if source == self.leader:
                self._heard = wall
            return Step.SAME
        step = Step.ON
        if time_ns < self.latest_ns:
            if source != self.leader and wall - self._heard <= self._patience:
                return Step.BEHIND
            step = Step.ANEW
        self.latest_ns, self.leader, self._heard = time_ns, source, wall
        return step
