"""A look, by the wall clock, at a participant that works on one grant for long.

It tells the time master where it works: the stack of the turn's thread. If the thread waits for somebody outside of the
process, others go on beside it (:mod:`.outside`).
"""
from __future__ import annotations

import os
import select
import sys
import threading
import time
from typing import TYPE_CHECKING, Any

import move_base_abstract
from move_base_abstract.lockstep import wire

from ..waiting.outside import Outside

if TYPE_CHECKING:
    from .taking_part import Participant

_MOST_FRAMES = 12
_LOOKS_PER_LIMIT = 10
_LONGEST_GAP, _SHORT_GAP = 1.0, 0.1  # s, wall
_LOCKSTEP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
_OWN = tuple(os.path.dirname(os.path.abspath(path)) + os.sep
             for path in (move_base_abstract.__file__, _LOCKSTEP)) + ('<frozen',)
_START = 'threading.py'
_LAUNCHER = os.path.join(_LOCKSTEP, 'program.py')


def watch(participant: Participant, limit_ns: int) -> None:
    """Start a thread that tells the time master, once for each grant on which this process works longer than a limit.

    ``limit_ns`` [ns, wall] may be NEVER.
    """
    threading.Thread.start(threading.Thread(target=_watch, args=(participant, limit_ns * 1e-9), daemon=True,
                                            name='lockstep_silence'))


def _watch(participant: Participant, limit: float) -> None:
    round_number, since, told, outside = None, 0.0, None, Outside(participant.scheduler)
    while not participant.scheduler.is_closed:
        select.select([], [], [], min(_SHORT_GAP if outside.has_found else _LONGEST_GAP, limit / _LOOKS_PER_LIMIT))
        granted, now = participant.rounds.granted, time.monotonic()
        if granted != round_number or participant.is_looked_at:
            round_number, since = granted, now
        elif granted is not None:
            if granted != told and now - since >= limit:
                told = granted
                participant.connection.try_to_send(wire.busy(granted, stack(participant.scheduler.turn_ident)))
            outside.look(now)


def stack(ident: Any) -> Any:
    """Return a text with the functions of a thread, the innermost last, each with file and line.

    Functions of this package, and of Python's start of a thread, are left out if there are others.
    """
    frame = sys._current_frames().get(ident)
    places, programs = [], []
    while frame is not None:
        filename = frame.f_code.co_filename
        if filename == _LAUNCHER:
            break  # the launcher is no part of the program
        place = '{}, line {}, in {}'.format(filename, frame.f_lineno, frame.f_code.co_name)
        places.append(place)
        if not filename.startswith(_OWN) and os.path.basename(filename) != _START:
            programs.append(place)
        frame = frame.f_back
    return ' > '.join(reversed((programs or places)[:_MOST_FRAMES])) or 'no thread of its program'
