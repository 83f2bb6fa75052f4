"""Tasks that take a while where a robot stands, one at a time for each robot: sampling, loading, charging."""
import random

from ..common.units import NS_PER_S, check_reachable, seconds_to_ns
from ..engine.guard import attempt_each, fault_text, guarded
from ..goals.outcome import CANCELLED, CLOCK_RESTARTED, GoalState, Outcome, aborted

DONE = Outcome(GoalState.SUCCEEDED, 'Task done.')


class DrawnDurations:
    """Durations drawn evenly from ``mean`` -+ ``spread`` [s], by a generator of the seed and the robot's index alone.

    :raises ValueError: if not 0 <= spread <= mean.
    """

    def __init__(self, mean, spread, seed, robot_index):
        if not 0.0 <= spread <= mean:
            raise ValueError('the spread must lie in 0..{:g} s, the duration; got {!r}'.format(mean, spread))
        self._mean_ns = seconds_to_ns(mean)
        self._spread_ns = seconds_to_ns(spread)
        self._generator = random.Random('{}/{}'.format(seed, robot_index))

    def draw_ns(self):
        """Return the next duration [ns]."""
        if not self._spread_ns:
            return self._mean_ns
        return self._mean_ns + self._generator.randint(-self._spread_ns, self._spread_ns)


class TimedTaskRunner:
    """The life of one robot's tasks, from the goal to the ending, which ``ledger`` (GoalLedger) publishes.

    ``durations`` has ``draw_ns()``, for goals that do not say how long. ``on_begin(record, duration_ns, now_ns)`` and
    ``on_progress(record, elapsed_ns, duration_ns, now_ns)`` are told of the task that is worked on, the second one
    ``progress_frequency`` times a simulated second and, unless that is 0, at the end; ``is_heard``: as of
    :class:`Series`. Not thread-safe: as the simulation.
    """

    def __init__(self, simulation, robot_index, ledger, durations, on_begin, on_progress, progress_frequency=0.0,
                 is_heard=None):
        self._simulation = simulation
        self._queue = simulation.queue
        self._robot_index = robot_index
        self._ledger = ledger
        self._durations = durations
        self._on_begin = on_begin
        self._on_progress = on_progress
        self._progress = simulation.series(robot_index, progress_frequency, self._tell_progress,
                                           only_tells=True, is_heard=is_heard)
        self._end = None  # the event
        self._began_ns = 0
        self._duration_ns = 0

    def elapsed_ns(self, now_ns):
        """Return for how long the latest task has been worked on [ns]."""
        return min(now_ns - self._began_ns, self._duration_ns)

    @guarded
    def receive(self, goal_id, stamp_ns, duration_ns, now_ns):
        """Take a goal in; the task that was under way is ended by it. ``duration_ns`` 0: draw one."""
        record = self._ledger.receive(goal_id, stamp_ns, now_ns)
        if record is None:
            return
        self._stop()
        self._begin(record, duration_ns or self._durations.draw_ns(), now_ns)

    def _begin(self, record, duration_ns, now_ns):
        """Work on the goal ``record`` for ``duration_ns`` [ns] from now on, if that is possible."""
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
    def cancel(self, goal_id, stamp_ns, now_ns):
        """Take a cancel request in, as of GoalLedger.cancel; the task ends at once."""
        if self._ledger.cancel(goal_id, stamp_ns, now_ns):
            self._stop()
            self._ledger.finish(CANCELLED, now_ns)

    @guarded
    def shut_down(self, outcome, now_ns):
        """End the task that is under way with an Outcome."""
        self._stop()
        self._ledger.finish(outcome, now_ns)

    def restart(self, before_ns, now_ns):
        """Go on at ``now_ns`` [ns] of a clock that has started anew, the old one having come to ``before_ns`` [ns].

        The task that is under way is aborted.
        """
        self._began_ns += now_ns - before_ns
        self.shut_down(CLOCK_RESTARTED, now_ns)
        self._ledger.restart(now_ns)

    @guarded
    def _done(self, due_ns, _now_ns):
        self._end = None
        self._stop()
        if self._progress is not None:
            self._tell_progress(due_ns, due_ns)
        self._ledger.finish(DONE, due_ns)

    def break_off(self, error):
        """Whatever the task was about has ended in the exception ``error``: it ends with its text."""
        now_ns = self._simulation.now_ns
        attempt_each(self._simulation, 'the task of robot {}'.format(self._robot_index), error, (
            (self._stop,), (self._ledger.finish, aborted(fault_text(error)), now_ns)))

    def _stop(self):
        if self._end is not None:
            self._end.cancel()
            self._end = None
        if self._progress is not None:
            self._progress.stop()

    def _tell_progress(self, due_ns, _now_ns):
        self._on_progress(self._ledger.active, due_ns - self._began_ns, self._duration_ns, due_ns)


def _duration_fault(duration_ns, now_ns):
    """Return why no task that begins at ``now_ns`` [ns] can take ``duration_ns`` [ns], or None."""
    if duration_ns < 0:
        return 'duration must be >= 0 s, got {:g} s'.format(duration_ns / NS_PER_S)
    try:
        check_reachable(now_ns + duration_ns, 'the task would end')
    except ValueError as error:
        return 'The task takes too long: {}'.format(error)
    return None
