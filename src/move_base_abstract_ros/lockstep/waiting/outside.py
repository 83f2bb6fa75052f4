"""A thread that waits for somebody outside of the process, without a time-out, does not hold up time for ever.

While the thread that has the turn waits in the kernel (``accept``, ``recv``, ``os.read`` of a pipe, standard input,
``open`` of a FIFO, ``signal.pause``), simulated time stands still, so that an answer comes at the instant at which it
was asked for. After some seconds of wall time the others go on beside it, with a label. A wait for a process that the
program has started may take longer, and a wait for its end is never given up.
"""
from __future__ import annotations

import linecache
import os
import platform
import sys
import threading
from typing import TYPE_CHECKING, Any, Dict, Optional, Set, Tuple

from ..code.callers import is_of_python, own_frame
from ..code.labels import told
from . import kernel_waits

if TYPE_CHECKING:
    from move_base_abstract.lockstep.scheduler import Scheduler

_LONGEST, _LONGEST_WITH_CHILDREN, _AGAIN = 5.0, 60.0, 0.3  # s, wall
_WAITS = kernel_waits.__file__
_STANDARD_ERROR = 2  # the number of its descriptor
#: numbers of system calls in which a thread does not wait for somebody outside: wait4, waitid, futex, nanosleep,
#: clock_nanosleep, futex_waitv; and of those that write
_OTHERS: Dict[str, Tuple[Set[int], Set[int]]] = {
    'x86_64': ({61, 247, 202, 35, 230, 449}, {1, 20}), 'aarch64': ({260, 95, 98, 101, 115, 449}, {64, 66})}


class Outside:
    """Looks, by the wall clock, for such waits of the thread that has the turn."""

    def __init__(self, scheduler: Scheduler) -> None:
        self._scheduler = scheduler
        self._calls = _OTHERS.get(platform.machine())
        self._seen: Any = None
        self._since = 0.0
        self._places: Set[Tuple[str, int]] = set()

    @property
    def has_found(self) -> bool:
        """Whether there was such a wait, so that looks should be frequent."""
        return bool(self._places)

    def look(self, now: float) -> None:
        """Look; ``now`` is the present [s, wall]. Call this while the process works on one grant for long."""
        ident = self._scheduler.turn_ident
        seen = self._waits_of(ident)
        if seen != self._seen or seen is None:
            self._seen, self._since = seen, now
            return
        place = _place_of(ident, is_lock=seen[-1])
        longest = 0.0 if place is None else self._longest(place)
        if place is None or now - self._since < longest:
            return
        if not self._scheduler.let_go(ident, lambda: self._waits_of(ident) == seen):
            return
        self._seen = None
        if place not in self._places:
            self._places.add(place)
            told.tell_place(place, linecache.getline(*place).strip() or 'a call',
                            'waits for somebody outside for longer than {:g} s of the wall clock; simulated time goes '
                            'on beside it'.format(longest))

    def _longest(self, place: Tuple[str, int]) -> float:
        if place in self._places:
            return _AGAIN
        try:
            os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)
        except ChildProcessError:
            return _LONGEST
        return _LONGEST_WITH_CHILDREN

    def _waits_of(self, ident: int) -> Optional[Tuple[Any, ...]]:
        """Return the system call in which a thread waits, and what changes with each wait; None: it does not wait so.

        The last value says whether the wait is one for a lock, which some other process must hold.
        """
        numbers = {thread.ident: thread.native_id for thread in threading.enumerate()}
        numbers[threading.main_thread().ident] = os.getpid()
        folder = '/proc/self/task/{}/'.format(numbers.get(ident))
        try:
            with open(folder + 'syscall') as call, open(folder + 'status') as status:
                number, descriptor = (int(word, 0) for word in call.read().split()[:2])
                waits = [line for line in status if line.startswith('voluntary_')]
        except (OSError, ValueError):  # it runs
            return None
        if self._calls is None or number < 0 or number in self._calls[1] and descriptor <= _STANDARD_ERROR:
            return None
        return ident, number, waits, number in self._calls[0]


def _place_of(ident: int, is_lock: bool) -> Optional[Tuple[str, int]]:
    """Return (file, line) of the program's code that waits in the kernel; None: ROS, or this package does."""
    frame = at = sys._current_frames().get(ident)
    is_ours = False
    while at is not None and (at.f_code.co_filename == _WAITS or is_of_python(at.f_code.co_filename)):
        if at.f_code.co_filename == _WAITS:  # the program has called what it stands in for
            frame, is_ours = at.f_back, True
        at = at.f_back
    own = own_frame(frame) if is_ours or not is_lock else None
    while own is None and frame is not None and is_of_python(frame.f_code.co_filename) and not is_lock:
        own = frame if frame.f_code is threading.Thread.run.__code__ else None  # a thread of a function of a library
        frame = frame.f_back
    return own and (own.f_code.co_filename, own.f_lineno)
