"""The clock of a process on the scaled clock, or on the machine's clock, and the thread in which events run.

Threading contract: a thread that uses a simulation holds :attr:`RosClock.lock`. Events run in the thread that receives
``/clock``, without a hand-over to another thread.
"""
from __future__ import annotations

import threading
import time
from typing import Any, Callable, List

import rospy
from rosgraph_msgs.msg import Clock

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.engine.simulation import Simulation
from move_base_abstract.supervision.clock_source import ClockSource, Step

from ..process.clock_watch import watch_clock
from .fault_log import FaultLog
from .hearers import NoHearers
from .throttle import WallThrottle

_POLL_SECONDS = 0.01
_WAIT_POLL_SECONDS = 0.02
_REMINDER_SECONDS = 5.0
_WARNINGS_RATE = 0.2  # Hz, wall
_SPEED_WINDOW_SECONDS = 0.02


class RosClock:
    """Drives one :class:`Simulation` by ``/clock``, or by the machine's clock if ROS uses that."""

    def __init__(self) -> None:
        self.lock = threading.RLock()
        self.simulation: Any = None
        self.hearers = NoHearers()
        self._restart_followers: List[Callable[[int, int], object]] = []
        self._source = ClockSource()
        self._behind_throttle = WallThrottle(_WARNINGS_RATE)
        self._arrived = threading.Event()
        self._latest_ns = 0
        self._subscriber = None
        self._speeds = (1.0, 1.0)
        self._speed_mark = (0.0, 0)

    def start(self) -> bool:
        """Wait for the first ``/clock`` and start the simulation at that time. Return False if ROS shuts down first."""
        if rospy.get_param('/use_sim_time', False):
            self._subscriber = rospy.Subscriber('/clock', Clock, self._on_clock, queue_size=1, tcp_nodelay=True)
            if not self._wait_for_clock():
                return False
            watch_clock()
        else:
            self._latest_ns = rospy.Time.now().to_nsec()
            threading.Thread(target=self._follow_machine, name='machine_clock', daemon=True).start()
        with self.lock:
            self.simulation = Simulation(self._latest_ns, FaultLog())
        return True

    def _wait_for_clock(self) -> bool:
        warned = time.monotonic()
        while not self._arrived.wait(0.1):
            if rospy.is_shutdown():
                return False
            if time.monotonic() - warned > _REMINDER_SECONDS:
                warned = time.monotonic()
                rospy.logwarn('%s: use_sim_time is true but nothing has come on /clock yet: is a time master running, '
                              'or a simulator that publishes /clock?', rospy.get_name())
        return True

    def now_ns(self) -> int:
        """Run all events that are due, and return the present [ns]. The caller holds the lock."""
        if self._subscriber is None:
            self._latest_ns = max(self._latest_ns, rospy.Time.now().to_nsec())
        self.simulation.advance(max(self._latest_ns, self.simulation.now_ns))
        return self.simulation.now_ns

    def look_ns(self) -> int:
        """Do the same as :meth:`now_ns`."""
        return self.now_ns()

    def owe(self, _undone: Callable[[], str]) -> None:
        """Do nothing: the end of such a run does not depend on what is left to do. See LockstepClock."""

    def follow_restarts(self, follower: Callable[[int, int], object]) -> None:
        """Call ``follower(before_ns, now_ns)`` each time that ``/clock`` starts anew, in order and under the lock.

        The old time has ended at ``before_ns`` [ns], and the simulation goes on at ``now_ns`` [ns].
        """
        self._restart_followers.append(follower)

    def leave_restarts(self, follower: Callable[[int, int], object]) -> None:
        """Do not call ``follower`` any more."""
        self._restart_followers.remove(follower)

    def serve(self) -> None:
        """Do nothing: rospy's own threads call back from the start."""

    def keep_causal_rows(self) -> None:
        """Do nothing: there is no event log. See LockstepClock."""

    def record(self, _index: int) -> None:
        """Return None: only lockstep has an event log."""

    def newcomers_ns(self) -> None:
        """Return None: a new listener gets what was told last. See LockstepClock."""

    def note_stamp(self, _who: str, _stamp_ns: int) -> None:
        """Do nothing: no run on the scaled clock is called repeatable. See LockstepClock."""

    def wait_until(self, condition: Callable[[], Any], seconds: float, _what: str) -> None:
        """Wait until ``condition()`` holds, for at most ``seconds`` of wall time. The caller holds no lock."""
        deadline = time.monotonic() + seconds
        while not condition() and time.monotonic() < deadline and not rospy.is_shutdown():
            time.sleep(_WAIT_POLL_SECONDS)

    def wall_to_ns(self, seconds: float) -> int:
        """Return how far simulated time [ns] moves in ``seconds`` of wall time, at its present speed.

        The lower one of the last two measured speeds counts, because a sleep that is too long would miss an instant:
        after a stall of this process time seems to run fast for a moment.
        """
        return int(seconds * min(self._speeds) * NS_PER_S)

    def patience_ns(self, seconds: float) -> int:
        """Return how far simulated time [ns] moves in ``seconds`` of wall time, but at least as many of its own."""
        return max(self.wall_to_ns(seconds), int(seconds * NS_PER_S))

    def _measure_speed(self, time_ns: int) -> None:
        wall = time.monotonic()
        mark_wall, mark_ns = self._speed_mark
        if wall - mark_wall >= _SPEED_WINDOW_SECONDS:
            if mark_ns:
                self._speeds = (self._speeds[1], (time_ns - mark_ns) / NS_PER_S / (wall - mark_wall))
            self._speed_mark = (wall, time_ns)

    def _on_clock(self, message: Any) -> None:
        with self.lock:
            self._take(message.clock.to_nsec(), message._connection_header['callerid'])

    def _take(self, time_ns: int, source: str) -> None:
        before_ns = self._source.latest_ns
        step = self._source.judge(time_ns, source, time.monotonic())
        if step is Step.BEHIND and self._behind_throttle.ready():
            rospy.logwarn('%s: two clocks are running: it is %.3f s by %s; the %.3f s that %s publishes on /clock are '
                          'ignored. Stop one of them', rospy.get_name(), before_ns / NS_PER_S, self._source.leader,
                          time_ns / NS_PER_S, source)
        if step in (Step.BEHIND, Step.SAME):
            return
        self._latest_ns = time_ns
        if self.simulation is None:
            self._arrived.set()
        elif step is Step.ANEW:
            self._restart(time_ns, source)
        else:
            self._measure_speed(time_ns)
            self.simulation.advance(time_ns)

    def _restart(self, time_ns: int, source: str) -> None:
        before_ns = self.simulation.now_ns
        rospy.logwarn('%s: /clock went back from %.3f s to %.3f s: %s has started anew. Goals under way are aborted, '
                      'and robots go on from where they are', rospy.get_name(), before_ns / NS_PER_S,
                      time_ns / NS_PER_S, source)
        self._speed_mark = (0.0, 0)
        self.simulation.restart(time_ns)
        for follower in list(self._restart_followers):
            follower(before_ns, time_ns)

    def _follow_machine(self) -> None:
        while not rospy.is_shutdown():
            time.sleep(_POLL_SECONDS)
            with self.lock:
                if self.simulation is not None:
                    self.now_ns()
