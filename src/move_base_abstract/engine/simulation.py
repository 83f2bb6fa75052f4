"""One simulation: its event queue, and its present, the time up to which everything has happened."""
from __future__ import annotations

from typing import Callable, Optional

from ..common.errors import TimeError
from ..common.units import LAST_NS
from .event_queue import EventQueue
from .guard import log_fault
from .series import Series


class Simulation:
    """Keeps the time of some robots and runs their events. It is not thread-safe: the caller holds one lock."""

    def __init__(self, now_ns: int = 0, on_fault: Callable[[str, BaseException], object] = log_fault) -> None:
        """``on_fault(who, error)`` is called for unexpected errors that ended a goal."""
        self.queue = EventQueue(now_ns)
        self._on_fault = on_fault
        #: the simulated time [ns]: that of the event that is happening, otherwise that up to which all has happened
        self.now_ns = now_ns

    def report_fault(self, who: str, error: BaseException) -> None:
        """Report the exception ``error`` as an error of ``who`` (a text)."""
        self._on_fault(who, error)

    def advance(self, now_ns: int, decides: bool = True) -> None:
        """Run everything that is due up to ``now_ns`` [ns], in order.

        Unless ``decides``, what is decided at the end of that instant is left, because more is to come before.

        :raises TimeError: if ``now_ns`` lies before the present; time never goes back.
        """
        if now_ns < self.now_ns:
            raise TimeError('time must not go back: it is {} ns, got {} ns'.format(self.now_ns, now_ns))
        self.queue.run_until(now_ns, self, decides=decides)
        self.now_ns = now_ns

    def run(self, until_ns: Optional[int] = None) -> None:
        """Advance to each instant at which anything is due, up to ``until_ns`` [ns], and then to ``until_ns`` itself.

        None: as long as there is an event for which time goes on.

        :raises TimeError: if ``until_ns`` lies before the present.
        """
        self.queue.run_until(until_ns, self, instant_by_instant=True)
        if until_ns is not None:
            self.advance(until_ns)

    def restart(self, now_ns: int) -> None:
        """Set the present to ``now_ns`` [ns], possibly an earlier time, and shift all events by the same amount.

        This is for a clock that has started anew. Objects that keep times of the old clock must correct them.
        """
        self.queue.shift(now_ns - self.now_ns)
        self.now_ns = now_ns

    def next_due_ns(self) -> Optional[int]:
        """Return when the next event is due [ns], or None if there is none."""
        return self.now_ns if self.queue.is_ending else self.queue.next_due_ns()

    def tell(self, due_ns: int, series: Series) -> None:
        """Do what ``series`` does at ``due_ns`` [ns]; :attr:`now_ns` is set to that time meanwhile."""
        present_ns, self.now_ns = self.now_ns, due_ns
        try:
            series.tell(due_ns)
        finally:
            self.now_ns = present_ns

    def wake(self) -> None:
        """Wake the series that sleep and are heard now, because somebody has begun to listen; they go on after now.

        The last action that each has slept through is done now, with the time at which it was due, so that all is as if
        the series had not slept. Nobody heard it then, so the caller must keep its messages from the new listeners.
        """
        for series in self.queue.sleepers():
            missed_ns = series.wake(self.now_ns)
            if missed_ns is not None:
                self.tell(missed_ns, series)

    def series(self, robot_index: int, frequency: float, action: Callable[[int, int], Optional[int]],
               is_output: bool = False, is_heard: Optional[Callable[[], int]] = None) -> Optional[Series]:
        """Return a new :class:`Series` of ``frequency`` [Hz, simulated], not started; None if the frequency is 0."""
        if frequency <= 0.0:
            return None
        period_ns = max(1, round(min(LAST_NS, 1e9 / frequency)))  # a series with a tiny frequency comes once
        return Series(self.queue, robot_index, period_ns, action, is_output, is_heard)
