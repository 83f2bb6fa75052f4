"""Events that come again and again, at exact multiples of a period; output among them may sleep."""
from __future__ import annotations

from typing import TYPE_CHECKING, Callable, Optional

if TYPE_CHECKING:
    from .event_queue import Event, EventQueue

#: the listeners of a :class:`Series` that is output; time goes on for it alone only if participants listen
NOBODY, ONLOOKERS, PARTICIPANTS = 0, 1, 2


class Series:
    """A periodic event: it is due at its start, and then every ``period_ns`` [ns], at exact multiples.

    ``action(due_ns, now_ns)`` is called at most once for each time that the clock shows: multiples that the clock has
    leapt over are left out, so that a fast clock does not flood the listeners. The k-th multiple stays at start + k *
    period exactly. If an action has nothing to do for a while, it may return for how long [ns]; the multiples in
    between are left out, too.

    ``is_output``: the action changes nothing that another event could see, so it can be done beforehand. Such a series
    has ``is_heard()``, which returns who listens: ``NOBODY``, ``ONLOOKERS`` or ``PARTICIPANTS``. While nobody does, the
    series sleeps, that is, it has no events. When it is woken (:meth:`Simulation.wake`), it goes on as if it had never
    slept. Its first event always happens.

    :raises ValueError: if the period is not > 0.
    """

    def __init__(self, queue: EventQueue, robot_index: int, period_ns: int, action: Callable[[int, int], Optional[int]],
                 is_output: bool = False, is_heard: Optional[Callable[[], int]] = None) -> None:
        if not period_ns > 0:
            raise ValueError('the period of a series must be > 0 ns, got {!r}'.format(period_ns))
        self._queue = queue
        self._robot_index = robot_index
        self.period_ns = period_ns
        self._action = action
        self._output = self if is_output else None
        self._event: Optional[Event] = None
        self._asleep_until_ns: Optional[int] = None
        self.is_heard = is_heard or _always
        self.place = queue.new_output_place() if is_output else None

    def start(self, first_ns: int) -> None:
        """Start anew, with the first call at ``first_ns`` [ns]."""
        self.stop()
        self._schedule(first_ns)
        self._queue.count_output(self._output is not None)

    def start_in_step(self, now_ns: int) -> None:
        """Start anew at ``now_ns`` [ns], with calls at whole multiples of the period."""
        self.start(-(-now_ns // self.period_ns) * self.period_ns)

    def stop(self) -> None:
        """Stop the series; stopping it twice is allowed."""
        if self._asleep_until_ns is not None:
            self._asleep_until_ns = None
            self._queue.forget_sleeper(self)
        if self._event is not None:
            self._event.cancel()
            self._event = None
            self._queue.count_output(-(self._output is not None))

    def tell(self, due_ns: int) -> None:
        """Do the action now that is due at ``due_ns`` [ns]."""
        self._action(due_ns, due_ns)

    def skip(self, due_ns: int) -> None:
        """Go on after ``due_ns`` [ns], up to which others have done what this series does."""
        if self._event is not None:
            self._event.cancel()
            self._go_on(due_ns + self.period_ns)

    def wake(self, now_ns: int) -> Optional[int]:
        """End the sleep: go on after ``now_ns`` [ns]. Return the last instant [ns] that was slept through, or None."""
        due_ns, self._asleep_until_ns = self._asleep_until_ns or 0, None
        self._queue.forget_sleeper(self)
        missed = (now_ns - due_ns) // self.period_ns + 1 if due_ns <= now_ns else 0
        self._queue.count_output(1)
        self._schedule(due_ns + missed * self.period_ns)
        return due_ns + (missed - 1) * self.period_ns if missed else None

    def shift(self, by_ns: int) -> None:
        """Move the next event of a series that is asleep by ``by_ns`` [ns]."""
        self._asleep_until_ns = (self._asleep_until_ns or 0) + by_ns

    def _go_on(self, due_ns: int) -> None:
        if self.is_heard():
            self._schedule(due_ns)
        else:
            self.fall_asleep(due_ns)

    def fall_asleep(self, due_ns: int) -> None:
        """Have no events until woken; ``due_ns`` [ns] is when the next one would be due."""
        self._event = None
        self._asleep_until_ns = due_ns
        self._queue.count_output(-1)
        self._queue.sleep(self)

    def _schedule(self, due_ns: int) -> None:
        self._event = self._queue.schedule(due_ns, self._robot_index, self._happen, self._output)

    def _happen(self, due_ns: int, now_ns: int) -> None:
        own = self._event
        pause_ns = 0
        try:
            pause_ns = self._action(due_ns, now_ns) or 0
        finally:
            if self._event is own:  # the action has neither stopped nor restarted the series
                self._go_on(due_ns + self.period_ns * ((now_ns + pause_ns - due_ns) // self.period_ns + 1))


def _always() -> int:
    return PARTICIPANTS
