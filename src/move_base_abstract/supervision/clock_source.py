"""Whose time counts: distinguishing a restarted clock from two clocks that disturb each other."""
from __future__ import annotations

from enum import Enum
from typing import Optional


class Step(Enum):
    """What one message of a clock means: time moves on, it does not, it is of another clock, it starts anew."""

    ON = 'on'
    SAME = 'same'
    BEHIND = 'behind'
    ANEW = 'anew'


class ClockSource:
    """Judges messages that each tell a time and who says so.

    Time that goes back has started anew if the one says so who told the latest time, or if that one has been silent
    for more than ``patience`` [s, wall]. Else two clocks are running, and the one that is behind does not count.
    Wall times are arguments [s, of one clock that never goes back].
    """

    def __init__(self, patience: float = 3.0) -> None:
        self._patience = patience
        self._latest_ns = 0
        self._leader: Optional[str] = None
        self._heard = 0.0

    @property
    def latest_ns(self) -> int:
        """The time that counts [ns]."""
        return self._latest_ns

    @property
    def leader(self) -> Optional[str]:
        """Who told the time that counts, or None."""
        return self._leader

    def judge(self, time_ns: int, source: str, wall: float) -> Step:
        """Return the :class:`Step` that the message ``time_ns`` [ns] of ``source`` is, which came at ``wall``."""
        if time_ns == self._latest_ns:
            if source == self._leader:
                self._heard = wall
            return Step.SAME
        step = Step.ON
        if time_ns < self._latest_ns:
            if source != self._leader and wall - self._heard <= self._patience:
                return Step.BEHIND
            step = Step.ANEW
        self._latest_ns, self._leader, self._heard = time_ns, source, wall
        return step
