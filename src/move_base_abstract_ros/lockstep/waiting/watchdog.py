"""time.sleep of an unmodified program sleeps in wall time while simulated time stands still, or in simulated time."""
from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, Any, Callable, Set

import rospy

from move_base_abstract.lockstep.loops import STEP_NS
from move_base_abstract.lockstep.task import TurnLost

from ...replacing.replaced import replace
from ..code.callers import own_frame
from ..code.labels import told
from ..ros_master.queries import settle

if TYPE_CHECKING:
    from ..participation.taking_part import Participant

#: packages of ROS that sleep for sockets, for the ROS master and out of courtesy, but never until another node acts.
#: Their sleeps are not the program's. (actionlib and tools like rostopic poll; their sleeps count as the program's.)
_ROS = frozenset(('rospy', 'rosgraph', 'roslib', 'genpy', 'genmsg'))
#: our modules that look for the time master before the program takes part; how often depends on the wall clock
_OWN = __name__.partition('.waiting.')[0] + '.exchange.'
_LONG_SLEEPS = 5.0  # s, wall, at one instant


def install(sleep: str, take_part: Callable[..., Any], clocks: Any) -> Callable[..., Any]:
    """Replace time.sleep; return a function ``by(seconds, frame)`` that sleeps in this way for the code of a frame.

    :param sleep: the time that a sleep takes: 'wall' or 'simulated'.
    :param take_part: function ``take_part(what)`` by which a program that is not a node yet takes part, before the
        call ``what``.
    :param clocks: the clocks that the program sees.
    """
    replace('os.sched_yield', lambda sched_yield: lambda: _look(sched_yield))
    made = _Sleep(sleep, take_part, time.sleep, clocks)
    replace('time.sleep', lambda _wall_sleep: made)
    return made.by


def _look(sched_yield: Any) -> None:
    """Let other threads go first, as in a sleep of 0 s."""
    participant = told.participant
    if participant is None or not participant.scheduler.is_mine() or not participant.scheduler.look(STEP_NS):
        sched_yield()


class _Sleep:
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
            self._sleep_by_the_wall(min(0.1, seconds))

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
            self._give_in(participant, seconds)
        if self._is_simulated:
            participant.scheduler.wait(participant.now_ns + round(seconds * 1e9))
        return self._is_simulated

    def _warn(self, frame: Any) -> None:
        """Warn, once for each place, that simulated time stands still in a sleep, which the program may not mean."""
        frame = own_frame(frame)
        place = frame and (frame.f_code.co_filename, frame.f_lineno)
        if place and place not in self._is_warned:
            self._is_warned.add(place)
            rospy.logwarn('%s: time.sleep in %s, line %d: sleeps in wall time while simulated time stands still '
                          '(--sleep simulated turns this into simulated time)', rospy.get_name(), *place)

    def _give_in(self, participant: Any, seconds: float) -> None:
        """Let sleeps take simulated time if the program sleeps for long at one instant: it seems to wait for that."""
        if participant.now_ns != self._at_ns:
            self._at_ns, self._slept = participant.now_ns, 0.0
        self._slept += seconds
        if self._slept > _LONG_SLEEPS:
            self._is_simulated = True
            told.tell_text('time.sleep was called for more than {:g} s while simulated time stood at {:.9f} s; from '
                           'here on it takes simulated time, as with --sleep simulated'.format(
                               _LONG_SLEEPS, participant.now_ns * 1e-9))


def _is_of_ros(frame: Any) -> bool:
    """Return whether ROS's own code or ours sleeps. rospy does, for 0 s, after each message that it sends."""
    if frame.f_globals.get('__name__') == 'rospy.rostime':  # its wallsleep, which others call
        frame = frame.f_back
    name = frame.f_globals.get('__name__') or ''
    return name.partition('.')[0] in _ROS or name.startswith(_OWN)
