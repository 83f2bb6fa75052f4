"""The clock of a process that takes part in lockstep: time comes with the grants, and moves from event to event.

Threading contract: as for :class:`ros_clock.RosClock`. Callbacks and events run one at a time, with the participant's
turn. A thread without the turn may only look at the time (:meth:`LockstepClock.look_ns`), under the lock.
"""
from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any, Callable, Iterable, Optional, Tuple

from move_base_abstract.common.units import NS_PER_S, seconds_to_ns
from move_base_abstract.engine.simulation import Simulation
from move_base_abstract.lockstep.task import TurnLost

from ..lockstep.exchange import playing
from ..messages import outlets
from .fault_log import FaultLog
from .hearers import Hearers

if TYPE_CHECKING:
    from move_base_abstract.engine.series import Series

_DAY_NS = 86400 * NS_PER_S


class LockstepClock:
    """Drives one :class:`Simulation` by the time master's grants. It is the participant's source of events.

    ``join()``: a function that takes part in the run, and returns the Participant when the run has begun.
    ``tells_newcomers``: whether :meth:`newcomers_ns` returns an instant.
    """

    def __init__(self, join: Callable[[], Any], tells_newcomers: bool = True) -> None:
        self.lock = threading.RLock()
        self.simulation: Any = None
        self.participant: Any = None
        self._join = join
        self._tells_newcomers = tells_newcomers
        self._has_onlookers = self._ever_had_onlookers = False
        self.hearers: Any = None
        self._undone: Callable[[], str] = str
        self._has_causal_rows = False

    def start(self) -> bool:
        """Take part. Return True when the run has begun, or False if it ends before that."""
        try:
            self.participant = self._join()
        except TurnLost:
            return False  # the reason has been logged, and the node ends
        self.hearers = Hearers(self.participant)
        with self.lock:
            self.simulation = Simulation(self.participant.now_ns, FaultLog())
        self.participant.constant('/tf_static')
        self.participant.set_source(self)
        return True

    def owe(self, undone: Callable[[], str]) -> None:
        """Have a run in which nothing is left to happen be a deadlock, and not idle, if ``undone()`` is a text.

        The text says what is not done, for the reason of the run's end.
        """
        self._undone = undone

    def undone(self) -> str:
        """Return what is not done, '': nothing. For the participant."""
        return self._undone()

    def follow_restarts(self, _follower: Callable[[int, int], object]) -> None:
        """Do nothing: the clock of a run in lockstep never starts anew. See RosClock."""

    def leave_restarts(self, _follower: Callable[[int, int], object]) -> None:
        """Do nothing, see :meth:`follow_restarts`."""

    def serve(self) -> None:
        """Let callbacks and events go on from now on, without the calling thread, which has set everything up."""
        self.participant.serve()

    def now_ns(self) -> int:
        """Run the events that are due at the present instant, and return this instant [ns].

        So events of the robots come before requests of the same instant, as in the fleet in plain Python, but what is
        decided about several robots comes after them. The caller holds the lock and has the turn.
        """
        if not playing.is_recording():
            self.simulation.advance(self.participant.now_ns, decides=False)
        return self.simulation.now_ns

    def look_ns(self) -> int:
        """Return the time [ns] up to which all events have run, and run none. The caller holds the lock."""
        return self.simulation.now_ns

    def newcomers_ns(self) -> Optional[int]:
        """Return the instant [ns] of the values that a new listener is told; None: those that were told last.

        Onlookers come at any moment, in threads without the turn. They get what was told last.
        """
        tells = self._tells_newcomers and self.simulation is not None and self.participant.scheduler.acts()
        return self.simulation.now_ns if tells else None

    def wall_to_ns(self, _seconds: float) -> int:
        """Return 0: in lockstep nothing waits for the wall clock."""
        return 0

    def patience_ns(self, seconds: float) -> int:
        """Return ``seconds`` of simulated time [ns]: what others send comes at its instant, however slow they are."""
        return seconds_to_ns(seconds)

    def note_stamp(self, who: str, stamp_ns: int) -> None:
        """Label the run if the stamp of a goal for ``who``, ``stamp_ns`` [ns], is of the wall clock."""
        if stamp_ns - self.simulation.now_ns > _DAY_NS and abs(stamp_ns - time.time_ns()) < _DAY_NS:
            self.participant.label('the stamp of a goal for {} is of the wall clock'.format(who))

    def wait_until(self, condition: Callable[[], Any], seconds: float, what: str) -> None:
        """Wait until ``condition()`` holds, for at most ``seconds`` of simulated time. The caller has the turn.

        ``what``: the thing that is waited for, in words.
        """
        self.participant.wait_until(condition, seconds, what)

    def listeners_changed(self) -> None:
        """Note that a node stops listening, or that fewer messages have an effect on it than before."""
        if self.simulation is not None and self.participant.scheduler.acts():
            self.hearers.rates_changed()

    def listener_came(self) -> None:
        """Note that a node begins to listen to robots: a participant, during our turn, or an onlooker at any time."""
        if self.simulation is None:
            return
        if self.participant.scheduler.acts():
            with self.lock:
                self.simulation.advance(self.participant.now_ns)
                self._wake()
        else:
            self._has_onlookers = self._ever_had_onlookers = True  # an onlooker gets messages from the next turn on

    def _wake(self) -> None:
        self.hearers.rates_changed()
        with outlets.nobody_hears():
            self.simulation.wake()

    def keep_causal_rows(self) -> None:
        """Keep rows of one instant in the order in which they happen: one robot leaves before another one enters.

        Otherwise they are in the order of the robots, which is possible with several processes, too.
        """
        self._has_causal_rows = True

    def record(self, index: int) -> Callable[[Tuple[Any, ...]], None]:
        """Return a function that writes rows of the robot with ``index`` into the run's event log."""
        log = self.participant.log
        return lambda row: log(row[1], row[2], row[3:], 0 if self._has_causal_rows else index)

    # --- methods that the participant calls -------------------------------------------------------------------------

    def next_due_ns(self) -> Optional[int]:
        """Return the instant [ns] of the next event that is due, or None."""
        return self.simulation.queue.next_due_ns()

    def is_background(self) -> bool:
        """Return whether all due events are for onlookers or come by themselves: time does not go on only for these."""
        queue = self.simulation.queue
        return (self._ever_had_onlookers or queue.ever_waits) and queue.is_for_onlookers()

    def played(self, until_ns: int, last: Iterable[Tuple[int, Series]]) -> None:
        """Go on at ``until_ns`` [ns]. Do quietly what each Series of ``last`` did last, with its instant [ns]."""
        with self.lock, outlets.nobody_hears():
            for due_ns, series in last:
                series.skip(due_ns)
                self.simulation.tell(due_ns, series)
            self.simulation.now_ns = until_ns

    def run(self, now_ns: int) -> None:
        """Run all events that are due up to ``now_ns`` [ns]."""
        with self.lock:
            self.simulation.advance(now_ns)
            if self._has_onlookers:
                self._has_onlookers = False
                self._wake()
