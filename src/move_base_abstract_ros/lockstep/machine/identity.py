"""What a program learns about its threads and the computer is the same in each run, on any computer.

Threads without a name get numbers as the program makes them; rospy's own threads, which come and go by the wall clock,
are not counted. A pool has as many threads as on a computer with :data:`CORES` cores. Records of the program's log have
the run's date.
"""
from __future__ import annotations

import itertools
import os
import sys
import threading
from typing import Any, Callable

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.lockstep.machine_view import DATE, UPTIME

from ...replacing.replaced import replace
from ..code.callers import sees_run
from ..code.labels import told

CORES = 4
_THREADS = 'Thread-%d'
#: modules whose threads come and go by the wall clock
_FOREIGN = ('rospy.impl.', 'rosgraph.', 'xmlrpc.', 'socketserver.', 'http.', 'move_base_abstract_ros.')
_LOGGING = ('logging', 'rosgraph.roslogging')


def install(clocks: Any) -> None:
    """Install the replacements, before the program's first line runs. ``clocks`` are the clocks that it sees."""
    replace('threading._newname', _Names)
    for name in ('os.cpu_count', 'os.process_cpu_count'):
        if hasattr(os, name.partition('.')[2]):
            replace(name, lambda _machine: lambda: CORES)
    replace('logging._logRecordFactory', lambda record: _recording(record, clocks))


class _Names:
    """Makes the names of threads that are made without one."""

    def __init__(self, machine: Callable[..., Any]) -> None:
        self._machine = machine
        self._numbers = itertools.count(1)

    def __call__(self, template: str = _THREADS) -> str:
        is_counted = template == _THREADS and told.is_ordered() and not _is_foreign(sys._getframe(1))
        return template % next(self._numbers) if is_counted else self._machine(template)


def _is_foreign(frame: Any) -> bool:
    """Return whether the code that makes a thread is that of a module whose threads come and go by the wall clock."""
    while frame is not None and frame.f_globals.get('__name__') == threading.__name__:
        frame = frame.f_back
    return frame is None or (frame.f_globals.get('__name__') or '').startswith(_FOREIGN)


def _recording(make: Any, clocks: Any) -> Callable[..., Any]:
    def record(*args: Any, **kwds: Any) -> Any:
        made = make(*args, **kwds)
        frame: Any = sys._getframe(1)  # not the record's own place, which a logger of rospy does not always find
        while frame is not None and frame.f_globals.get('__name__') in _LOGGING:
            frame = frame.f_back
        if told.is_ordered() and sees_run(frame):
            now_ns = clocks.now(DATE)
            made.created = now_ns / NS_PER_S
            made.msecs = float(now_ns % NS_PER_S // 1000000)
            made.relativeCreated = (clocks.now(UPTIME) - clocks.start(UPTIME)) / 1e6
        return made
    return record
