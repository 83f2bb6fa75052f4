"""time.sleep of an unmodified program: by the wall while simulated time stands, or simulated time."""
import sys
import time

import rospy

from move_base_abstract.lockstep.loops import STEP_NS
from move_base_abstract.lockstep.scheduler import TurnLost

from ...replacing.replaced import replace
from ..code.callers import own_frame
from ..code.labels import told
from ..ros_master.queries import settle

#: packages of ROS that sleep for their sockets, for the ROS master and as a courtesy, never for what another node does:
#: their sleeps are not the program's. (actionlib and tools like rostopic poll: theirs count as the program's.)
_ROS = frozenset(('rospy', 'rosgraph', 'roslib', 'genpy', 'genmsg'))
#: ours that looks for the time master before the program takes part: how often depends on the wall
_OWN = __name__.partition('.waiting.')[0] + '.exchange.'
_LONG_SLEEPS = 5.0  # s, wall, at one instant


def install(sleep, take_part, clocks):
    """Stand before time.sleep; return what sleeps so, for the code of a frame: ``by(seconds, frame)``.

    ``sleep`` says what it is to wait for: 'wall' or 'simulated'.

    ``take_part(what)`` is called where a program that is no node yet is to take part, because of ``what``; ``clocks``
    are those that the program sees.
    """
    replace('os.sched_yield', lambda sched_yield: lambda: _look(sched_yield))
    made = _Sleep(sleep, take_part, time.sleep, clocks)
    replace('time.sleep', lambda _wall_sleep: made)
    return made.by


def _look(sched_yield):
    """A thread lets others go first: it is a sleep of no length."""
    participant = told.participant
    if participant is None or not participant.scheduler.is_mine():
        sched_yield()
        return
    try:
        participant.scheduler.look(STEP_NS)
    except TurnLost:
        sched_yield()


class _Sleep:
    """time.sleep of the application's threads."""

    def __init__(self, kind, take_part, wall_sleep, clocks):
        self._is_simulated = kind == 'simulated'
        self._take_part = take_part
        self._wall_sleep = wall_sleep
        self._clocks = clocks
        self._at_ns = None
        self._slept = 0.0
        self._is_warned = set()

    def __call__(self, seconds, /):
        frame = sys._getframe(1)
        if seconds < 0 or _is_of_ros(frame):
            self._wall_sleep(seconds)
            return
        self.by(seconds, frame)

    def by(self, seconds, frame):
        """Sleep for the code of a frame [s]."""
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

    def _sleep_by_the_wall(self, seconds):
        self._wall_sleep(seconds)
        if told.is_ordered() or told.is_over():
            self._clocks.add_sleep(seconds)

    def _in_turn(self, participant, seconds, frame):
        """Sleep as who has the turn; return False if it remains to sleep by the wall."""
        if not seconds:
            participant.scheduler.look(STEP_NS)
            return True
        if not self._is_simulated:
            self._warn(frame)
            settle(participant.scheduler)
            self._give_in(participant, seconds)
        if self._is_simulated:
            participant.scheduler.wait(participant.now_ns + round(seconds * 1e9))
        return self._is_simulated

    def _warn(self, frame):
        """It is exact, but not what the program means: time stands."""
        frame = own_frame(frame)
        place = frame and (frame.f_code.co_filename, frame.f_lineno)
        if place and place not in self._is_warned:
            self._is_warned.add(place)
            rospy.logwarn('%s: time.sleep in %s, line %d: sleeps in wall time while simulated time stands still '
                          '(--sleep simulated turns this into simulated time)', rospy.get_name(), *place)

    def _give_in(self, participant, seconds):
        """Who sleeps again and again waits for something that needs simulated time: have it go on."""
        if participant.now_ns != self._at_ns:
            self._at_ns, self._slept = participant.now_ns, 0.0
        self._slept += seconds
        if self._slept > _LONG_SLEEPS:
            self._is_simulated = True
            text = 'time.sleep was called for more than {:g} s while simulated time stood at {:.9f} s; from here on ' \
                   'it takes simulated time, as with --sleep simulated'.format(_LONG_SLEEPS, participant.now_ns * 1e-9)
            rospy.logwarn('%s: %s', rospy.get_name(), text)
            participant.label(text)


def _is_of_ros(frame):
    """Whether ROS's own code or ours sleeps: rospy does, for 0 s, after each message that it sends, also of the log."""
    if frame.f_globals.get('__name__') == 'rospy.rostime':  # wallsleep, for whoever calls it
        frame = frame.f_back
    name = frame.f_globals.get('__name__') or ''
    return name.partition('.')[0] in _ROS or name.startswith(_OWN)
