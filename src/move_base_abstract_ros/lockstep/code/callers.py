"""Which code asks the machine for time or chance: the program's, or code whose asking decides nothing for the program.

The program sees the run's time and chance, and so do all libraries that it uses, also ROS's packages (actionlib and
dynamic_reconfigure wait by the clock). Two kinds of code see the machine itself: Python's library where it deals with
other processes, sockets and logs, and the code that makes rospy's own connections. The run is labelled only for what
the program's own code does, by itself or by a library.
"""
from __future__ import annotations

import os
import sysconfig
from functools import lru_cache
from typing import Any, Tuple

from .own_code import OWN, is_library

_STDLIB = sysconfig.get_path('stdlib') + os.sep
_FROZEN = '<frozen '  # followed by the name of a module that is part of Python's binary
#: packages and modules of Python's library that wait in the kernel, or keep a log
_MACHINES = frozenset((
    '_pyio', 'asyncio', 'cProfile', 'concurrent', 'ctypes', 'doctest', 'ensurepip', 'ftplib', 'http', 'imaplib',
    'importlib', 'linecache', 'logging', 'multiprocessing', 'nntplib', 'poplib', 'profile', 'pydoc', 'queue',
    'selectors', 'signal', 'site', 'smtplib', 'socket', 'socketserver', 'ssl', 'subprocess', 'telnetlib', 'tempfile',
    'threading', 'unittest', 'urllib', 'wsgiref', 'xmlrpc'))
#: modules of Python's library that only pass requests on
_BETWEEN = frozenset(('random', 'secrets', 'uuid', 'os', '_strptime'))
#: ROS's packages that talk to the ROS master or to other nodes, or describe them
_ROS = frozenset(('rospy', 'rosgraph', 'roslib', 'rospkg', 'genpy', 'genmsg', 'rosmaster', 'catkin'))
_ROS_TOOLS = frozenset(('rosnode', 'rosservice', 'rostopic', 'rosparam', 'rosmsg'))
#: files of the packages above that see the run's clocks: for time-outs of waits, and durations of a timer's callbacks
_PROGRAMS = ('/concurrent/futures/_base.py', '/rospy/timer.py', '/multiprocessing/queues.py',
             '/multiprocessing/synchronize.py')
#: files of Python's library that start another process to ask about the system
_OF_SYSTEM = ('ctypes/util.py', 'platform.py', 'uuid.py')


@lru_cache(maxsize=None)
def _place(filename: str) -> Tuple[str, bool]:
    """Return (first part of a file's module name, whether it is in Python's library); ('', True) for this package."""
    if filename.startswith(_FROZEN):
        return filename[len(_FROZEN):].rstrip('>').partition('.')[0], True
    if filename.startswith(OWN):
        return '', True
    if filename.startswith(_STDLIB) and '-packages/' not in filename:
        return filename[len(_STDLIB):].split(os.sep)[0].partition('.')[0], True
    return filename.rpartition('-packages/')[2].split(os.sep)[0] if '-packages/' in filename else '', False


@lru_cache(maxsize=None)
def is_of_program(filename: str) -> bool:
    """Return whether the code of a file sees the run's clocks and chance, not the machine's."""
    return filename.endswith(_PROGRAMS) or asks_for_program(filename)


@lru_cache(maxsize=None)
def asks_for_program(filename: str) -> bool:
    """Return whether what the code of a file asks the machine for may reach the program, also by way of a library."""
    name, is_stdlib = _place(filename)
    return name not in ('', *_MACHINES) if is_stdlib else name not in _ROS


def is_of_python(filename: str) -> bool:
    """Return whether code is in Python's library."""
    name, is_stdlib = _place(filename)
    return is_stdlib and name != ''


def is_of_library(filename: str) -> bool:
    """Return whether code sees the run's clocks, and is not Python's own."""
    return is_of_program(filename) and not _place(filename)[1]


@lru_cache(maxsize=None)
def _is_between(filename: str) -> bool:
    name, is_stdlib = _place(filename)
    return is_stdlib and name in _BETWEEN


def asker(frame: Any) -> Any:
    """Return the frame that asks, above those of modules that only pass requests on."""
    while frame is not None and _is_between(frame.f_code.co_filename):
        frame = frame.f_back
    return frame


def sees_run(frame: Any) -> bool:
    """Return whether the code of a frame sees the run's clocks and chance, not the machine's."""
    return frame is not None and is_of_program(frame.f_code.co_filename)


def is_own(frame: Any) -> bool:
    """Return whether a frame belongs to the program's own code."""
    return frame is not None and not is_library(frame.f_code.co_filename)


@lru_cache(maxsize=None)
def _ends_search(filename: str) -> bool:
    name, is_stdlib = _place(filename)
    if is_stdlib:
        return name in ('', 'importlib') or filename.endswith(_OF_SYSTEM)
    return name in _ROS or name in _ROS_TOOLS


def own_frame(frame: Any) -> Any:
    """Return the frame of the program's own code that calls, directly or by libraries, what ``frame`` does; or None.

    None means that ROS, this package, or the import of a library does it.
    """
    while frame is not None and (is_library(frame.f_code.co_filename) or frame.f_code.co_filename == '<string>'):
        if _ends_search(frame.f_code.co_filename):
            return None
        frame = frame.f_back
    return frame
