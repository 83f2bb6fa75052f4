"""The present of a process that takes part in lockstep: time comes with the grants, and moves from event to event.

Threading contract: as of :class:`ros_clock.RosClock`. Callbacks and events come one at a time, with the participant's
turn; a thread without the turn may only look (:meth:`LockstepClock.look_ns`), under the lock.
"""
import threading

from move_base_abstract.simulation import Simulation

from . import beforehand


class LockstepClock:
    """Drives one :class:`Simulation` by the time master's grants. It is the participant's source of events.

    ``join()`` takes part and returns the Participant when the clock has started.
    """

    def __init__(self, join):
        self.lock = threading.RLock()
        self.simulation = None
        self.participant = None
        self._join = join

    def start(self):
        """Take part; returns when the clock has started."""
        self.participant = self._join()
        with self.lock:
            self.simulation = Simulation(self.participant.now_ns)
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
        if not beforehand.is_now():
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

    def record(self, index):
        """Return what takes the :class:`TraceEntry` of the robot with ``index``: the run's event log."""
        def log(entry):
            self.participant.log(entry.robot, entry.kind, entry.values, sub=index)
        return log

    # --- what the participant calls ---------------------------------------------------------------------------------

    def next_due_ns(self):
        """Return when the next event is due [ns], or None."""
        return self.simulation.next_due_ns()

    def foresee(self, before_ns, most):
        """As :meth:`EventQueue.foresee`."""
        with self.lock:
            return self.simulation.foresee(before_ns, most)

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
