"""Where a participant is when its work on one grant takes long: the stack of the thread that has the turn."""
import os
import select
import sys
import threading
import time

import move_base_abstract
from move_base_abstract.lockstep.wire import NEVER

_MOST_FRAMES = 12
_LOOKS_PER_LIMIT = 10
_LONGEST_GAP = 1.0  # s, wall
_LOCKSTEP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
_OWN = tuple(os.path.dirname(os.path.abspath(path)) + os.sep
             for path in (move_base_abstract.__file__, _LOCKSTEP)) + ('<frozen',)
_START = 'threading.py'
_LAUNCHER = os.path.join(_LOCKSTEP, 'program.py')


def watch(participant, limit_ns):
    """Have the time master told, once for each grant, in a thread of its own; ``limit_ns`` [wall] may be NEVER."""
    if limit_ns < NEVER:
        threading.Thread.start(threading.Thread(target=_watch, args=(participant, limit_ns * 1e-9), daemon=True,
                                                name='lockstep_silence'))


def _watch(participant, limit):
    round_number, since, told = None, 0.0, None
    while not participant.scheduler.is_closed:
        select.select([], [], [], min(_LONGEST_GAP, limit / _LOOKS_PER_LIMIT))
        granted, now = participant.rounds.granted, time.monotonic()
        if granted != round_number:
            round_number, since = granted, now
        elif granted is not None and granted != told and now - since >= limit:
            told = granted
            participant.tell_busy(granted, stack(participant.scheduler.turn_ident))


def stack(ident):
    """Return the functions of a thread, the innermost last, with file and line; without our own and Python's start."""
    frame = sys._current_frames().get(ident)
    places, programs = [], []
    while frame is not None:
        filename = frame.f_code.co_filename
        if filename == _LAUNCHER:
            break  # who has begun the program is no part of it
        place = '{}, line {}, in {}'.format(filename, frame.f_lineno, frame.f_code.co_name)
        places.append(place)
        if not filename.startswith(_OWN) and os.path.basename(filename) != _START:
            programs.append(place)
        frame = frame.f_back
    return ' > '.join(reversed((programs or places)[:_MOST_FRAMES])) or 'no thread of its program'
