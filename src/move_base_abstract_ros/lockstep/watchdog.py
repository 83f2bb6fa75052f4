"""Tells what a program does that lockstep cannot follow: once for each place, with file and line.

time.sleep and reads of the wall clock, sockets and other processes. Only what the program's own code does is told, not
what ROS or Python's library do.
"""
import sys
import sysconfig
import time

import rospy

from move_base_abstract.lockstep.scheduler import TurnLost

_state = {'participant': None, 'told': set()}
_LIBRARIES = tuple({sysconfig.get_path('stdlib'), '/usr/lib/python3', '<frozen'})
_OWN = __file__.rsplit('/', 2)[0]
_EVENTS = {
    'socket.connect': 'opens a connection of its own: what comes over it is not part of lockstep',
    'subprocess.Popen': 'starts another process, which does not take part in lockstep by itself',
    'os.system': 'starts another process, which does not take part in lockstep by itself',
    'os.fork': 'forks: the child does not take part in lockstep',
}
_CLOCKS = ('time', 'time_ns', 'monotonic', 'monotonic_ns', 'perf_counter', 'perf_counter_ns')


def install(sleep):
    """Begin to watch; ``sleep`` says what time.sleep is to wait for: 'wall' or 'simulated'."""
    wall_sleep = time.sleep

    def sleep_and_tell(seconds):
        participant = _state['participant']
        if participant is None or not participant.scheduler.is_mine():
            wall_sleep(seconds)
            return
        if sleep == 'wall':
            _tell('time.sleep', 'sleeps in wall time while simulated time stands still (--sleep simulated turns this '
                  'into simulated time)')
            wall_sleep(seconds)
            return
        try:
            participant.scheduler.wait(participant.now_ns + int(max(0.0, seconds) * 1e9))
        except TurnLost:
            wall_sleep(min(0.1, seconds))

    time.sleep = sleep_and_tell
    for name in _CLOCKS:
        setattr(time, name, _reading(getattr(time, name), 'time.' + name))
    sys.addaudithook(_audit)


def follow(participant):
    """The program takes part from now on."""
    _state['participant'] = participant


def _reading(clock, name):
    def read():
        if _state['participant'] is not None:
            _tell(name, 'reads the wall clock; what it does with that differs from run to run')
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
        while frame is not None and _is_library(frame.f_code.co_filename):
            if 'rospy' in frame.f_code.co_filename or 'rosgraph' in frame.f_code.co_filename:
                return
            frame = frame.f_back
    if frame is None or _is_library(frame.f_code.co_filename):
        return
    place = (what, frame.f_code.co_filename, frame.f_lineno)
    if place not in _state['told']:
        _state['told'].add(place)
        rospy.logwarn('%s: %s in %s, line %d: %s', rospy.get_name(), what, place[1], place[2], why)


def _is_library(filename):
    return filename.startswith(_LIBRARIES) or filename.startswith(_OWN)
