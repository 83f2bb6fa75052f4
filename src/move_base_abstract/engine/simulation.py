"""The present of a simulation: one event queue, and the time up to which everything has happened."""
from ..common.errors import TimeError
from ..common.units import LAST_NS
from .event_queue import EventQueue, Series
from .guard import log_fault


class Simulation:
    """Keeps the time of some robots and runs their events. Not thread-safe: the caller holds one lock."""

    def __init__(self, now_ns=0, on_fault=log_fault):
        """``on_fault(who, error)`` is told of errors that nobody expected, and that ended a goal."""
        self.queue = EventQueue()
        self._on_fault = on_fault
        #: the simulated time [ns]: that of the event that is happening, else that up to which all has happened
        self.now_ns = now_ns

    def report_fault(self, who, error):
        """Have it noted that the exception ``error`` came up in what ``who`` (a text) does."""
        self._on_fault(who, error)

    def advance(self, now_ns):
        """Let everything due up to ``now_ns`` [ns] happen, in order.

        :raises TimeError: if ``now_ns`` lies before the present; time never goes back.
        """
        if now_ns < self.now_ns:
            raise TimeError('time must not go back: it is {} ns, got {} ns'.format(self.now_ns, now_ns))
        self.queue.run_until(now_ns, self)
        self.now_ns = now_ns

    def run(self, until_ns=None):
        """As :meth:`advance` to each instant at which anything is due, up to ``until_ns`` [ns] and in the end to that.

        None: as long as time goes on for anything.

        :raises TimeError: as of :meth:`advance`.
        """
        self.queue.run_until(until_ns, self, instant_by_instant=True)
        if until_ns is not None:
            self.advance(until_ns)

    def restart(self, now_ns):
        """Go on at ``now_ns`` [ns], also an earlier time; what was due comes as much later as before.

        For a clock that has started anew. Who keeps a time of the old one has to be told of it.
        """
        self.queue.shift(now_ns - self.now_ns)
        self.now_ns = now_ns

    def next_due_ns(self):
        """Return when the next event is due [ns], or None."""
        return self.queue.next_due_ns()

    def foresee(self, before_ns, most):
        """As :meth:`EventQueue.foresee`."""
        return self.queue.foresee(before_ns, most)

    def tell(self, due_ns, series):
        """Do beforehand what is foreseen for ``due_ns`` [ns], at which :attr:`now_ns` stands meanwhile."""
        present_ns, self.now_ns = self.now_ns, due_ns
        try:
            for one in series:
                one.tell(due_ns)
        finally:
            self.now_ns = present_ns

    def wake(self):
        """Somebody listens: let the series that slept and are heard now go on, after the present.

        What they have told nobody last is done now, at its instant, so that all is as if they had not slept; whatever
        is sent by it was meant for nobody.
        """
        for series in self.queue.sleepers():
            missed_ns = series.wake(self.now_ns)
            if missed_ns is not None:
                self.tell(missed_ns, [series])

    def skip(self, until_ns):
        """Go on at ``until_ns`` [ns]: what was foreseen up to then has happened."""
        self.queue.skip(until_ns)
        self.now_ns = until_ns

    def series(self, robot_index, frequency, action, only_tells=False, is_heard=None):
        """Return a :class:`Series` of ``frequency`` [Hz, simulated], not started; None if the frequency is 0."""
        if frequency <= 0.0:
            return None
        period_ns = max(1, round(min(LAST_NS, 1e9 / frequency)))  # a tiny one comes once
        return Series(self.queue, robot_index, period_ns, action, only_tells, is_heard)
