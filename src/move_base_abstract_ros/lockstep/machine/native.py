"""The time and the chance that C libraries see which the program loads.

A preloaded library (src/python_shim) stands in front of libc for them: for extension modules, and for what these, numba
and ctypes call. This module is its Python side. It tells the library the time and which threads take turns, sleeps for
it, and reports at the end of a turn what the library has noticed. The numbers that both sides read and write lie in the
library's memory.
"""
from __future__ import annotations

import _thread
import atexit
import ctypes
import os
import sys
from typing import TYPE_CHECKING, Any, Optional

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.lockstep import machine_view as view, wire
from move_base_abstract.lockstep.scheduler import Scheduler
from move_base_abstract.lockstep.task import TurnLost

from ..code.labels import told
from ..code.own_code import is_library
from ..programs import native_library

if TYPE_CHECKING:
    from ..participation.taking_part import Participant

#: numbers of the library, in the order of src/python_shim/run.h
_NOW, _SLEPT, _DATE, _UPTIME, _PROCESSOR, _EPOCH, _IS_FOLLOWED, _MAY_CALL, _NOTICES, _PATIENCE, _TROUBLE, \
    _CELLS = range(12)
_BEFORE, _AS_NODE = 1, 2  # epochs: before the program takes part, and from then on
_STRAY_CLOCK, _STRAY_CHANCE, _COMPUTES, _TIMES, _USAGE, _LOAD, _SYSTEM, _WAKES, _PROCESS, _NUMBER, _DEVICE, _ENTROPY, \
    _WORKERS = range(13)
#: the texts of the library's notices, in the order of src/python_shim/notices.h
WORDS = (
    'a library reads a clock in a thread that lockstep does not order',
    'a library draws a random number in a thread that lockstep does not order',
    'a library looks at a clock, and has computed for {:g} s between two of its waits: from here on the clocks that it '
    'sees go on as it computes (limits that count steps, not time, repeat; {} is the time in seconds)',
    'times() says how long the processor has worked',
    'getrusage() says how long the processor has worked',
    'getloadavg() says how busy the machine is',
    'sysinfo() says how busy the machine is',
    'a library has the kernel wake the program by the wall clock',
    'a library starts a process that is not a participant: its answers depend on the machine',
    'getpid() is another number in another run',
    'a library opens a device, or a file in which the system describes itself: what it reads differs from run to run',
    "random bytes of a device cannot be replaced, and are the machine's",
    'a library starts threads for its sums or loops (TBB, OpenMP, BLAS), which take no turns')
#: notices that count only for the program's own libraries: others name files by the pid, and look at the computer
_OF_OWN = (_NUMBER, _DEVICE)
_SYSTEMS = ('/usr/lib/', '/lib/', '/lib64/', '/opt/ros/')
_LIMIT = 'MOVE_BASE_ABSTRACT_COMPUTE_LIMIT'
_DEFAULT_LIMIT = 20.0  # s of the processor
_PATH_SIZE = 4096
ABSENT = ('the library that stands in front of libc for extension modules is not in this process ({}): clocks, chance '
          'and sleeps that they ask for themselves are not seen'.format(native_library.LIBRARY))


class Native:
    """The Python side of the library. Without the library it does nothing."""

    def __init__(self) -> None:
        self._library: Any = ctypes.PyDLL(None) if native_library.is_loaded() else None
        self.cells: Any = None if self._library is None else self._find_cells()
        self._sleep: Any = None
        self._callback: Any = None
        self._told = 0
        self._last_word = wire.crashing()  # the library keeps its address

    def _find_cells(self) -> memoryview:
        find = self._library.move_base_abstract_native_cells
        find.restype = ctypes.c_void_p
        return memoryview((ctypes.c_int64 * _CELLS).from_address(find())).cast('B').cast('q')

    def install(self, text: str, clocks: Any, sleep: Any) -> None:
        """Make libraries see the run's time and chance from now on. Call this in the main thread.

        :param text: the seed and the node's name.
        :param clocks: the clocks that the program sees.
        :param sleep: function ``sleep(seconds, frame)`` that sleeps as the program's time.sleep does.
        """
        if self.cells is None:
            return
        self._sleep = sleep
        Scheduler.thread_changes = self._thread_changes
        for cell, kind in ((_DATE, view.DATE), (_UPTIME, view.UPTIME), (_PROCESSOR, view.PROCESSOR)):
            self.cells[cell] = clocks.start(kind)
        self.cells[_PATIENCE] = int(_limit() * NS_PER_S)
        self._callback = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int64)(self._wait)  # must live as long as the process
        self._library.move_base_abstract_native_begin(os.fsencode(text), self._callback)
        self.cells[_EPOCH] = _BEFORE
        self._library.move_base_abstract_native_enter(1)
        self.cells[_MAY_CALL] = self.cells[_IS_FOLLOWED] = 1
        atexit.register(self._end)

    def _end(self) -> None:
        self.cells[_MAY_CALL] = 0

    def follow(self, participant: Optional[Participant]) -> None:
        """Report to ``participant`` from now on; None if the time master is not in lockstep any more."""
        if participant is None:
            if self.cells is not None:
                self.cells[_IS_FOLLOWED] = 0
            return
        if self.cells is None:
            participant.label(ABSENT)
            return
        self.cells[_NOW] = participant.now_ns
        self._tell_crashes(participant.connection.fileno())
        participant.connection.before_close = lambda: self._tell_crashes(-1)
        participant.scheduler.shown_ns = self.cells[_NOW:_NOW + 1]
        participant.last_words.append(self._tell)

    def _tell_crashes(self, descriptor: int) -> None:
        self._library.move_base_abstract_native_crashes(descriptor, os.getpid(), self._last_word,
                                                        ctypes.c_size_t(len(self._last_word)))

    @property
    def is_there(self) -> bool:
        """Whether this process has the library."""
        return self.cells is not None

    def trouble(self) -> Any:
        """Return a sequence of one number: the bits that say what makes addresses in arenas differ from run to run."""
        return self.cells[_TROUBLE:_TROUBLE + 1]

    def slept_ns(self) -> Any:
        """Return a sequence of one number, which both sides use: how far the clocks have gone on by themselves [ns]."""
        return [0] if self.cells is None else self.cells[_SLEPT:_SLEPT + 1]

    def _thread_changes(self, begins: bool) -> None:
        """Tell the library that the calling thread begins to take turns, or ends to."""
        self.cells[_EPOCH] = _AS_NODE
        self._library.move_base_abstract_native_enter(int(begins))

    def _wait(self, duration_ns: int) -> int:
        """Sleep for a library, in the thread that has the turn. The library calls this. Return 1 if it was interrupted.

        A negative ``duration_ns`` means that the library looks at a clock again and again.
        """
        try:
            if duration_ns >= 0:
                self._sleep(duration_ns / NS_PER_S, sys._getframe(0).f_back)
            else:
                _look_away(-duration_ns)
        except KeyboardInterrupt:
            _thread.interrupt_main()  # Python raises it again when the library returns to it
            return 1
        return 0

    def _tell(self) -> None:
        """Label the run for the library's new notices."""
        while self._told < self.cells[_NOTICES]:
            path, offset = ctypes.create_string_buffer(_PATH_SIZE), ctypes.c_size_t()
            what = self._library.move_base_abstract_native_notice(self._told, path, ctypes.c_size_t(_PATH_SIZE),
                                                                  ctypes.byref(offset))
            if what < 0:
                return  # it is being written
            self._told += 1
            _tell(what, os.fsdecode(path.value), offset.value)


def _tell(what: Any, path: str, offset: Any) -> None:
    if what in _OF_OWN and (not path or path.startswith(_SYSTEMS) or is_library(os.path.realpath(path))):
        return
    if told.participant is None or told.is_over():
        return
    place = '{}+{:#x}'.format(path, offset) if path else 'code without a file'
    told.tell_text('{} ({})'.format(WORDS[what].format(_limit(), _LIMIT), place))


def _look_away(step_ns: int) -> None:
    """Let simulated time go on by ``step_ns`` [ns], since a library looks at a clock again and again."""
    participant = told.participant
    try:
        if participant is not None and participant.scheduler.is_mine():
            participant.scheduler.wait(participant.now_ns + step_ns)
            return
    except TurnLost:
        pass  # lockstep is over
    native.cells[_SLEPT] += step_ns


def _limit() -> float:
    """Return how long a thread may compute between two of its waits [s of the processor]."""
    try:
        limit = float(os.environ.get(_LIMIT, _DEFAULT_LIMIT))
    except ValueError:
        return _DEFAULT_LIMIT
    return limit if 0.0 < limit < 1e9 else _DEFAULT_LIMIT


#: the library's Python side in this process
native = Native()
