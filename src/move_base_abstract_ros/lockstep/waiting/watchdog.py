"""time.sleep of an unmodified program sleeps in wall time while simulated time stands still, or in simulated time.

So do waits in the kernel that have a time-out (:mod:`kernel_waits`): in vain they are sleeps.
"""
from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, Any, Callable, List, Set

import rospy

from move_base_abstract.lockstep.loops import STEP_NS
from move_base_abstract.lockstep.task import TurnLost

from ...replacing.replaced import replace
from ..code.callers import own_frame
from ..code.labels import told
from ..machine.clocks import sleep_ns
from ..ros_master.queries import settle
from .waits import until_shutdown

if TYPE_CHECKING:
    from ..participation.taking_part import Participant

#: packages of ROS that sleep for sockets, for the ROS master and out of courtesy, but never until another node acts.
#: Their sleeps are not the program's. (actionlib and tools like rostopic poll; their sleeps count as the program's.)
_ROS = frozenset(('rospy', 'rosgraph', 'roslib', 'genpy', 'genmsg'))
#: our modules that look for the time master before the program takes part; how often depends on the wall clock
_OWN = __name__.partition('.waiting.')[0] + '.exchange.'
_LONG_SLEEPS = 5.0  # s, wall, at one instant


def install(sleep: str, take_part: Callable[..., Any], clocks: Any) -> Sleep:
    """Replace time.sleep; return the sleep, by which other code sleeps and waits in this way.

    :param sleep: the time that a sleep takes: 'wall' or 'simulated'.
    :param take_part: function ``take_part(what)`` by which a program that is not a node yet takes part, before the
        call ``what``.
    :param clocks: the clocks that the program sees.
    """
    replace('os.sched_yield', lambda sched_yield: lambda: _look(sched_yield))
    made = Sleep(sleep, take_part, time.sleep, clocks)
    replace('time.sleep', lambda _wall_sleep: made)
    return made


def _look(sched_yield: Any) -> None:
    """Let other threads go first, as in a sleep of 0 s."""
    participant = told.participant
    if participant is None or not participant.scheduler.is_mine() or not participant.scheduler.look(STEP_NS):
        sched_yield()


class Sleep:
    """Replaces time.sleep, for the application's threads."""

    def __init__(self, kind: str, take_part: Callable[..., Any], wall_sleep: Callable[..., Any], clocks: Any) -> None:
        self._is_simulated = kind == 'simulated'
        self._take_part = take_part
        self._wall_sleep = wall_sleep
        self._clocks = clocks
        self._at_ns = None
        self._slept = 0.0
        self._is_warned: Set[Any] = set()

    def __call__(self, seconds: float, /) -> None:
        """Sleep as time.sleep does."""
        frame = sys._getframe(1)
        if seconds < 0 or _is_of_ros(frame):
            self._wall_sleep(seconds)
            return
        self.by(seconds, frame)

    def by(self, seconds: float, frame: Any) -> None:
        """Sleep for ``seconds``, for the code of a frame."""
        if told.participant is None and self._is_simulated:
            self._take_part('time.sleep')
        participant = told.participant
        if participant is None or not participant.scheduler.is_mine():
            self._sleep_by_the_wall(seconds)
            return
        try:
            if not self._in_turn(participant, seconds, frame):
                self._sleep_by_the_wall(seconds)
        except TurnLost:
            until_shutdown()  # not shorter: how often a loop goes round after the run is no matter of chance

    def _sleep_by_the_wall(self, seconds: float) -> None:
        self._wall_sleep(seconds)
        if told.is_ordered() or told.is_over():
            self._clocks.add_sleep(seconds)

    def _in_turn(self, participant: Participant, seconds: float, frame: Any) -> bool:
        """Sleep in the thread that has the turn; return False if the caller must still sleep in wall time."""
        if not seconds:
            return participant.scheduler.look(STEP_NS)
        if not self._is_simulated:
            self._warn(frame)
            settle(participant.scheduler)
            self._give_in(participant, seconds, 'time.sleep', frame)
        if self._is_simulated:
            participant.scheduler.wait(participant.now_ns + sleep_ns(seconds))
        return self._is_simulated

    def wait(self, ask: Callable[[float], Any], seconds: float, frame: Any, what: str) -> Any:
        """Return what ``ask(seconds)`` does: a wait in the kernel, ``what``, for the code of a frame.

        If its result is false, it was in vain, and counts as a sleep. Where sleeps take simulated time, so does it.
        """
        participant = told.participant
        if participant is None or not participant.scheduler.is_mine():
            return ask(seconds)
        found = None
        try:
            settle(participant.scheduler)
            if not self._is_simulated:
                by_the_wall = min(seconds, _LONG_SLEEPS)
                found = ask(by_the_wall)
                if not found:
                    self._clocks.add_sleep(by_the_wall)
                    self._give_in(participant, seconds, what, frame)
                    seconds -= by_the_wall
            if not found and seconds > 0 and self._is_simulated:
                found = self._wait_in_turn(participant.scheduler, ask, seconds)
        except TurnLost:
            until_shutdown()
            found = ask(0.0)
        return found

    @staticmethod
    def _wait_in_turn(scheduler: Any, ask: Callable[[float], Any], seconds: float) -> Any:
        """Ask whenever something has happened in this process, until ``seconds`` of simulated time are over."""
        found: List[Any] = [None]

        def is_there() -> bool:
            found[0] = ask(0)
            return bool(found[0])
        scheduler.wait_until(is_there, scheduler.now_ns + sleep_ns(seconds))
        return found[0]

    def _warn(self, frame: Any) -> None:
        """Warn, once for each place, that simulated time stands still in a sleep, which the program may not mean."""
        frame = own_frame(frame)
        place = frame and (frame.f_code.co_filename, frame.f_lineno)
        if place and place not in self._is_warned:
            self._is_warned.add(place)
            rospy.logwarn('%s: time.sleep in %s, line %d: sleeps in wall time while simulated time stands still '
                          '(--sleep simulated turns this into simulated time)', rospy.get_name(), *place)

    def _give_in(self, participant: Any, seconds: float, what: str, frame: Any) -> None:
        """Let sleeps take simulated time if the program sleeps for long at one instant: it seems to wait for that."""
        if participant.now_ns != self._at_ns:
            self._at_ns, self._slept = participant.now_ns, 0.0
        self._slept += seconds
        if self._slept > _LONG_SLEEPS:
            self._is_simulated = True
            own = own_frame(frame)
            told.tell_text('{}{} was called for more than {:g} s while simulated time stood at {:.9f} s; from here on '
                           'it takes simulated time, as with --sleep simulated'.format(
                               what, own and ' in {}, line {},'.format(own.f_code.co_filename, own.f_lineno) or '',
                               _LONG_SLEEPS, participant.now_ns * 1e-9))


def _is_of_ros(frame: Any) -> bool:
    """Return whether ROS's own code or ours sleeps. rospy does, for 0 s, after each message that it sends."""
    if frame.f_globals.get('__name__') == 'rospy.rostime':  # its wallsleep, which others call
        frame = frame.f_back
    name = frame.f_globals.get('__name__') or ''
    return name.partition('.')[0] in _ROS or name.startswith(_OWN)
