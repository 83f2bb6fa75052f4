"""Tasks that take time where a robot stands, one at a time per robot: sampling, loading, charging."""
from __future__ import annotations

import random
from typing import TYPE_CHECKING, Any, Callable, Optional, Protocol

from ..common.units import NS_PER_S, check_reachable, seconds_to_ns
from ..engine.guard import attempt_each, fault_text, guarded
from ..goals.outcome import CANCELLED, CLOCK_RESTARTED, GoalState, Outcome, aborted

if TYPE_CHECKING:
    from ..engine.simulation import Simulation
    from ..goals.ledger import GoalLedger, GoalRecord

DONE = Outcome(GoalState.SUCCEEDED, 'Task done.')


class DrawnDurations:
    """Durations drawn evenly from ``mean`` -+ ``spread`` [s]; they depend only on the seed and the robot's index.

    :raises ValueError: if not 0 <= spread <= mean.
    """

    def __init__(self, mean: float, spread: float, seed: int, robot_index: int) -> None:
        if not 0.0 <= spread <= mean:
            raise ValueError('the spread must lie in 0..{:g} s, the duration; got {!r}'.format(mean, spread))
        self._mean_ns = seconds_to_ns(mean)
        self._spread_ns = seconds_to_ns(spread)
        self._generator = random.Random('{}/{}'.format(seed, robot_index))

    def draw_ns(self) -> int:
        """Return the next duration [ns]."""
        if not self._spread_ns:
            return self._mean_ns
        return self._mean_ns + self._generator.randint(-self._spread_ns, self._spread_ns)


class Durations(Protocol):
    """An object that draws durations: :class:`DrawnDurations`, or a user's own."""

    def draw_ns(self) -> int:
        """Return the next duration [ns]."""
        ...


class TimedTaskRunner:
    """The life of one robot's tasks, from the goal to the ending, which ``ledger`` (GoalLedger) publishes.

    ``durations`` draws the durations of goals that have none. ``on_begin(record, duration_ns, now_ns)`` is called when
    the work begins. ``on_progress(record, elapsed_ns, duration_ns, now_ns)`` is called ``progress_frequency``
    times per simulated second while the robot works and, unless that is 0, at the end. ``is_heard``: as in
    :class:`Series`. Not thread-safe, just as the simulation.
    """

    def __init__(self, simulation: Simulation, robot_index: int, ledger: GoalLedger,
                 durations: Optional[Durations], on_begin: Callable[[GoalRecord, int, int], object],
                 on_progress: Callable[[GoalRecord, int, int, int], object],
                 progress_frequency: float = 0.0, is_heard: Optional[Callable[[], int]] = None) -> None:
        self._simulation = simulation
        self._queue = simulation.queue
        self._robot_index = robot_index
        self._ledger = ledger
        self._durations = durations
        self._on_begin = on_begin
        self._on_progress = on_progress
        self._progress = simulation.series(robot_index, progress_frequency, self._tell_progress,
                                           only_tells=True, is_heard=is_heard)
        self._end = None  # the event at which the work ends
        self._began_ns = 0
        self._duration_ns = 0

    def elapsed_ns(self, now_ns: int) -> int:
        """Return the time that the robot has worked on the latest task [ns]."""
        return min(now_ns - self._began_ns, self._duration_ns)

    @guarded
    def receive(self, goal_id: str, stamp_ns: int, duration_ns: int, now_ns: int) -> None:
        """Take in a goal; it ends the task that is under way. ``duration_ns`` [ns], 0: draw a duration."""
        record = self._ledger.receive(goal_id, stamp_ns, now_ns)
        if record is None:
            return
        self._stop()
        self._begin(record, duration_ns or self._durations.draw_ns(), now_ns)  # type: ignore[union-attr]

    def _begin(self, record: GoalRecord, duration_ns: int, now_ns: int) -> None:
        """Work on the goal ``record`` for ``duration_ns`` [ns] from now on. If that is not possible, abort the goal."""
        self._began_ns = now_ns
        self._duration_ns = duration_ns
        fault = _duration_fault(duration_ns, now_ns)
        if fault:
            self._duration_ns = 0
            self._ledger.finish(aborted(fault), now_ns)
            return
        self._on_begin(record, duration_ns, now_ns)
        self._end = self._queue.schedule(now_ns + self._duration_ns, self._robot_index, self._done)
        if self._progress is not None:
            self._progress.start(now_ns)

    @guarded
    def cancel(self, goal_id: str, stamp_ns: int, now_ns: int) -> None:
        """Take in a cancel request, as GoalLedger.cancel does; a task that it concerns ends at once."""
        if self._ledger.cancel(goal_id, stamp_ns, now_ns):
            self._stop()
            self._ledger.finish(CANCELLED, now_ns)

    @guarded
    def shut_down(self, outcome: Outcome, now_ns: int) -> None:
        """End the task that is under way with ``outcome``."""
        self._stop()
        self._ledger.finish(outcome, now_ns)

    def restart(self, before_ns: int, now_ns: int) -> None:
        """Go on after a restart of the clock: it was at ``before_ns`` [ns] and is at ``now_ns`` [ns] now.

        The task that is under way is aborted.
        """
        self._began_ns += now_ns - before_ns
        self.shut_down(CLOCK_RESTARTED, now_ns)
        self._ledger.restart(now_ns)

    @guarded
    def _done(self, due_ns: int, _now_ns: int) -> None:
        self._end = None
        self._stop()
        if self._progress is not None:
            self._tell_progress(due_ns, due_ns)
        self._ledger.finish(DONE, due_ns)

    def break_off(self, error: Any) -> None:
        """End the task after the exception ``error``, with a text from that."""
        now_ns = self._simulation.now_ns
        attempt_each(self._simulation, 'the task of robot {}'.format(self._robot_index), error, (
            (self._stop,), (self._ledger.finish, aborted(fault_text(error)), now_ns)))

    def _stop(self) -> None:
        self._halt()

    def _halt(self) -> None:
        """Stop working."""
        if self._end is not None:
            self._end.cancel()
            self._end = None
        if self._progress is not None:
            self._progress.stop()

    def _tell_progress(self, due_ns: int, _now_ns: int) -> None:
        record: Any = self._ledger.active
        self._on_progress(record, due_ns - self._began_ns, self._duration_ns, due_ns)


def _duration_fault(duration_ns: int, now_ns: int) -> Optional[str]:
    """Return why a task that begins at ``now_ns`` [ns] cannot take ``duration_ns`` [ns], or None if it can."""
    if duration_ns < 0:
        return 'duration must be >= 0 s, got {:g} s'.format(duration_ns / NS_PER_S)
    try:
        check_reachable(now_ns + duration_ns, 'the task would end')
    except ValueError as error:
        return 'The task takes too long: {}'.format(error)
    return None
