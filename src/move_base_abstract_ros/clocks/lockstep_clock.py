"""The present of a process that takes part in lockstep: time comes with the grants, and moves from event to event.

Threading contract: as of :class:`ros_clock.RosClock`. Callbacks and events come one at a time, with the participant's
turn; a thread without the turn may only look (:meth:`LockstepClock.look_ns`), under the lock.
"""
import threading

from move_base_abstract.engine.simulation import Simulation
from move_base_abstract.lockstep.scheduler import TurnLost

from ..lockstep.exchange import rollback
from ..messages import outlets
from .fault_log import FaultLog
from .hearers import Hearers


class LockstepClock:
    """Drives one :class:`Simulation` by the time master's grants. It is the participant's source of events.

    ``join()`` takes part and returns the Participant when the clock has started.
    """

    def __init__(self, join):
        self.lock = threading.RLock()
        self.simulation = None
        self.participant = None
        self._join = join
        self._has_onlookers = self._ever_had_onlookers = False
        self.hearers = None
        self._has_causal_rows = False

    def start(self):
        """Take part; return True when the clock has started, False if the run ends before."""
        try:
            self.participant = self._join()
        except TurnLost:
            return False  # why has been told, and the node ends
        self.hearers = Hearers(self.participant)
        with self.lock:
            self.simulation = Simulation(self.participant.now_ns, FaultLog())
        self.participant.constant('/tf_static')
        self.participant.set_source(self)
        return True

    def follow_restarts(self, _follower):
        """As of RosClock; a run in lockstep has one clock, so that nobody is ever called."""

    def leave_restarts(self, _follower):
        """As of RosClock."""

    def serve(self):
        """Let callbacks and events go on without the calling thread, which has set everything up."""
        self.participant.serve()

    def now_ns(self):
        """Let happen what is due at the present instant and return that [ns]. The caller holds lock and turn.

        So what the robots do by themselves comes before what they are told at the same instant, as in the plain
        Python fleet.
        """
        if not rollback.is_recording():
            self.simulation.advance(self.participant.now_ns)
        return self.simulation.now_ns

    def look_ns(self):
        """Return the time up to which all has happened [ns], and let nothing happen. The caller holds the lock."""
        return self.simulation.now_ns

    def wall_to_ns(self, _seconds):
        """Return 0: nothing waits for the wall clock."""
        return 0

    def wait_until(self, condition, seconds, what):
        """Wait until ``condition()`` holds, for at most ``seconds``: simulated ones. The caller has the turn."""
        self.participant.wait_until(condition, seconds, what)

    def listeners_changed(self):
        """Somebody listens no more, or hears less of it than before."""
        if self.simulation is not None and self.participant.scheduler.acts():
            self.hearers.rates_changed()

    def listener_came(self):
        """Somebody begins to listen to what robots tell: a participant, in this one's turn, or anybody else."""
        if self.simulation is None:
            return
        if self.participant.scheduler.acts():
            with self.lock:
                self.simulation.advance(self.participant.now_ns)
                self._wake()
        else:
            self._has_onlookers = self._ever_had_onlookers = True  # it takes no part: it is told from the next turn on

    def _wake(self):
        self.hearers.rates_changed()
        with outlets.nobody_hears():
            self.simulation.wake()

    def keep_causal_rows(self):
        """Have rows of one instant in the order in which they happen, in which a robot leaves before another enters.

        Else they are in that of the robots, in which those of several processes can be, too.
        """
        self._has_causal_rows = True

    def record(self, index):
        """Return what takes the rows of a trace, of the robot with ``index``: the run's event log."""
        log = self.participant.log
        return lambda row: log(row[1], row[2], row[3:], 0 if self._has_causal_rows else index)

    # --- what the participant calls ---------------------------------------------------------------------------------

    def next_due_ns(self):
        """Return when the next event is due [ns], or None."""
        return self.simulation.queue.next_due_ns()

    def is_background(self):
        """Return whether all that is due is for onlookers, or comes of itself: time does not go on for it alone."""
        queue = self.simulation.queue
        return (self._ever_had_onlookers or queue.ever_waits) and queue.is_for_onlookers()

    def foresee(self, before_ns, most):
        """As :meth:`EventQueue.foresee`."""
        with self.lock:
            return self.simulation.queue.foresee(before_ns, most)

    def tell(self, due_ns, series):
        """Do beforehand what is foreseen for ``due_ns`` [ns]."""
        with self.lock:
            self.simulation.tell(due_ns, series)

    def skip(self, until_ns):
        """Take what was foreseen up to ``until_ns`` [ns] as having happened."""
        with self.lock:
            self.simulation.skip(until_ns)

    def run(self, now_ns):
        """Let everything happen that is due up to ``now_ns`` [ns]."""
        with self.lock:
            self.simulation.advance(now_ns)
            if self._has_onlookers:
                self._has_onlookers = False
                self._wake()
