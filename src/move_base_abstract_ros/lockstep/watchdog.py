"""Tells what a program does that lockstep cannot follow: once for each place, with file and line.

time.sleep and reads of the wall clock, sockets and other processes, generators of random numbers that the machine
seeds. Only what the program's own code does is told, not what ROS or Python's library do.
"""
import sys

import rospy

from move_base_abstract.lockstep.scheduler import TurnLost

from ..replaced import replace
from . import source
from .looks import STEP_NS
from .own_code import is_library
from .queries import settle

_state = {'participant': None, 'told': set(), 'is_watching_sources': False}
_OTHER_PROCESS = 'starts another process, which does not take part in lockstep by itself'
_OTHER_CONNECTION = 'opens a connection of its own: what comes over it is not part of lockstep'
_EVENTS = {
    'socket.connect': _OTHER_CONNECTION,
    'socket.bind': _OTHER_CONNECTION,
    'subprocess.Popen': _OTHER_PROCESS,
    'os.system': _OTHER_PROCESS,
    'os.posix_spawn': _OTHER_PROCESS,
    'os.fork': 'forks: the child does not take part in lockstep',
}
_CLOCKS = ('time.time', 'time.time_ns', 'time.monotonic', 'time.monotonic_ns', 'time.perf_counter',
           'time.perf_counter_ns', 'uuid.uuid1')
_READS = 'reads the wall clock; what it does with that differs from run to run'
#: packages of ROS that sleep for their sockets, for the ROS master and as a courtesy, never for what another node does:
#: their sleeps are not the program's. (actionlib and tools like rostopic poll: theirs count as the program's.)
_ROS = frozenset(('rospy', 'rosgraph', 'roslib', 'genpy', 'genmsg'))
_LONG_SLEEPS = 5.0  # s, wall, at one instant


def install(sleep, take_part):
    """Begin to watch. ``sleep`` says what time.sleep is to wait for: 'wall' or 'simulated'.

    ``take_part(what)`` is called where a program that is no node yet is to take part, because of ``what``.
    """
    replace('time.sleep', lambda wall_sleep: _Sleep(sleep, take_part, wall_sleep))
    for name in _CLOCKS:
        replace(name, lambda clock, name=name: _reading(clock, name))
    sys.addaudithook(_audit)


def follow(participant):
    """The program takes part from now on."""
    _state['participant'] = participant


def watch_sources():
    """The program is a node: tell what its sources have that cannot be noticed while they run. Once."""
    _state['is_watching_sources'] = True
    for what, filename, line in source.check(_files()):
        _tell_place(what, filename, line)


def is_watching_sources():
    """Return whether that has been done."""
    return _state['is_watching_sources']


def _files():
    """Return the files of the program: of the modules that it has brought along, and where it is now."""
    names = {getattr(module, '__file__', None) or '' for module in list(sys.modules.values())}
    frame = sys._getframe(1)
    while frame is not None:
        names.add(frame.f_code.co_filename)
        frame = frame.f_back
    return sorted(name for name in names if name and not name.endswith('.so') and not is_library(name))


class _Sleep:
    """time.sleep of the application's threads."""

    def __init__(self, kind, take_part, wall_sleep):
        self._is_simulated = kind == 'simulated'
        self._take_part = take_part
        self._wall_sleep = wall_sleep
        self._at_ns = None
        self._slept = 0.0

    def __call__(self, seconds, /):
        is_of_ros = seconds < 0 or _is_of_ros(sys._getframe(1))
        if _state['participant'] is None and self._is_simulated and not is_of_ros:
            self._take_part('time.sleep')
        participant = _state['participant']
        is_mine = participant is not None and participant.scheduler.is_mine()
        if not is_mine or is_of_ros:
            self._wall_sleep(seconds)
            return
        try:
            if not seconds:
                participant.scheduler.look(STEP_NS)
                return
            if not self._is_simulated:
                _tell('time.sleep', 'sleeps in wall time while simulated time stands still (--sleep simulated turns '
                      'this into simulated time)')
                settle(participant.scheduler)
                self._give_in(participant, seconds)
            if self._is_simulated:
                participant.scheduler.wait(participant.now_ns + round(seconds * 1e9))
                return
        except TurnLost:
            seconds = min(0.1, seconds)
        self._wall_sleep(seconds)

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
            participant.label('{}: {}'.format(rospy.get_name(), text))


def _is_of_ros(frame):
    """Whether ROS's own code sleeps: rospy does, for 0 s, after each message that it sends, also of the log."""
    if frame.f_globals.get('__name__') == 'rospy.rostime':  # wallsleep, for whoever calls it
        frame = frame.f_back
    return (frame.f_globals.get('__name__') or '').partition('.')[0] in _ROS


def _reading(clock, name):
    def read():
        if _state['participant'] is not None:
            _tell(name, _READS)
        return clock()
    return read


def _audit(event, _arguments):
    if event in _EVENTS and _state['participant'] is not None:
        _tell(event, _EVENTS[event])


def _tell(what, why):
    """Warn once for each place, if the program's own code is the one that did it."""
    participant = _state['participant']
    if participant is None or not participant.scheduler.is_mine():
        return
    frame = sys._getframe(2)
    if what in _EVENTS:
        while frame is not None and is_library(frame.f_code.co_filename):
            if 'rospy' in frame.f_code.co_filename or 'rosgraph' in frame.f_code.co_filename:
                return
            frame = frame.f_back
    if frame is None or is_library(frame.f_code.co_filename):
        return
    _tell_place('{}: {}'.format(what, why), frame.f_code.co_filename, frame.f_lineno)


def _tell_place(what, filename, line):
    name, _, why = what.partition(': ')
    if (name, filename, line) not in _state['told']:
        _state['told'].add((name, filename, line))
        rospy.logwarn('%s: %s in %s, line %d: %s', rospy.get_name(), name, filename, line, why)
