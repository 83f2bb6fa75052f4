"""Calls of a program whose results differ from run to run, and cannot be followed: each place labels the run.

These are other processes, connections and devices, figures about the processor and the machine, waits in the kernel,
and addresses. Only calls of the program's own code count, not those that ROS or Python's library make for themselves.
"""
from __future__ import annotations

import builtins
import functools
import getpass  # noqa: F401 - replaced by name, as the others
import os
import platform  # noqa: F401
import re
import resource  # noqa: F401
import shutil  # noqa: F401
import signal  # noqa: F401
import socket  # noqa: F401
import sys
import threading
import types
from contextlib import AbstractContextManager
from typing import Any, Callable, Iterator, Optional

import rosgraph
import rospy
import rospy.msproxy  # noqa: F401 - replaced by name

from move_base_abstract.lockstep.call_rewriting import ASK, FILE_TIME, HASHED, KEPT, SHOWING, SHOWN
from move_base_abstract.lockstep.own_cores import own_cores
from move_base_abstract.lockstep.stable_hash import Address, Numbered, is_hashed_by_address

from ...replacing.replaced import replace
from ..code.callers import asks_for_program, is_own, own_frame
from ..code.imports import when_imported
from ..code.labels import NUMBER, told
from . import arenas, chance
from .clocks import is_moment
from .files import files
from .native import native

_PROCESS = 'starts another process, which does not take part in lockstep by itself'
_CONNECTION = 'opens a connection of its own: data comes over it at moments of the wall clock'
#: {event of sys.audit: label}
EVENTS = {
    'socket.connect': _CONNECTION,
    'socket.bind': _CONNECTION,
    'subprocess.Popen': _PROCESS,
    'os.system': _PROCESS,
    'os.posix_spawn': _PROCESS,
    'os.exec': 'becomes another program, which does not take part any more',
    'os.fork': 'forks: the child does not take part in lockstep',
    'os.forkpty': 'forks: the child does not take part in lockstep',
    'builtins.input': 'waits until a person types',
}
_STARTS = ('subprocess.Popen', 'os.system', 'os.posix_spawn', 'os.exec', 'os.fork')
_PROCESSOR = 'says how long the processor has worked, or how busy the machine is'
_WOKEN = 'has the kernel wake the program by the wall clock'
_COMPUTER = 'differs from computer to computer'
_EVERYWHERE = 'localhost'  # a name of a computer that does not differ
_WRITTEN = 'says when a file was written, by the wall clock'
_THREADS = 'counts threads of ROS, too, which come and go by the wall clock'
#: {function: label}; it counts if the program's own code calls it
CALLS = {
    'os.getpid': NUMBER, 'os.getppid': NUMBER, 'os.getpgrp': NUMBER, 'threading.get_native_id': NUMBER,
    'threading.active_count': _THREADS, 'threading.enumerate': _THREADS,
    'socket.gethostname': _COMPUTER, 'socket.getfqdn': _COMPUTER, 'platform.node': _COMPUTER, 'os.uname': _COMPUTER,
    'getpass.getuser': _COMPUTER, 'uuid.getnode': _COMPUTER, 'os.sched_getaffinity': _COMPUTER,
    'shutil.disk_usage': _COMPUTER, 'os.path.getmtime': _WRITTEN, 'os.path.getctime': _WRITTEN,
    'os.path.getatime': _WRITTEN,
    'rospy.get_node_uri': 'has a port, which is another one in another run',
    'os.times': _PROCESSOR, 'os.getloadavg': _PROCESSOR, 'resource.getrusage': _PROCESSOR,
    'signal.setitimer': _WOKEN, 'signal.alarm': _WOKEN, 'signal.sigtimedwait': _WOKEN,
}
#: a log's format with the number of a process or thread
_NUMBER_IN_LOG = re.compile(r'%\((process|thread)\)|[{$]\{?(process|thread)\b')
_ADDRESS = 'gives an address, which differs from run to run'
_DEVICES = ('/dev/', '/proc/', '/sys/')
#: paths there that read the same in each run, or are the program's own output
_HARMLESS = ('/dev/null', '/dev/zero', '/dev/full', '/dev/tty', '/dev/stdin', '/dev/stdout', '/dev/stderr', '/dev/fd/',
             '/dev/shm/', '/dev/pts/')
#: in a path there: a label is the same in each run
_PROCESS_NUMBER = re.compile('(?<=^/proc)/[0-9]+(?=/|$)|(?<=/task)/[0-9]+(?=/|$)')


#: functions of the C library that a program gets by ctypes, and that are never the run's
_OF_C = frozenset(('clock_gettime64', 'times', 'getpid', 'gettid', 'getrusage', 'syscall'))
#: functions that are the run's if the program gets them from all loaded libraries (CDLL(None)), but not from libc
_FOLLOWED_OF_C = frozenset((
    'time', 'clock_gettime', 'gettimeofday', 'ftime', 'timespec_get', 'clock', 'nanosleep', 'clock_nanosleep', 'usleep',
    'sleep', 'getrandom', 'getentropy', 'arc4random', 'arc4random_buf', 'arc4random_uniform'))


def install() -> None:
    """Begin to watch, before the program's first line runs, and after its clocks are installed."""
    replace('os.sched_getaffinity', own_cores.seen)
    replace('os.sched_setaffinity', own_cores.chosen)
    replace('_imp.create_dynamic', own_cores.loading)
    for name, why in CALLS.items():
        replace(name, lambda function, name=name, why=why: _telling(function, name, why))
    replace('os.readlink', _reading_link)
    replace('logging.Formatter.__init__', _formatting)
    replace('threading.Thread.ident', lambda of: property(lambda thread: _ident_of(of.fget(thread))))
    replace('threading.Thread.native_id', lambda of: property(_telling(of.fget, 'threading.Thread.native_id', NUMBER)))
    when_imported('multiprocessing.process', _follow_processes)
    replace('rospy.msproxy.MasterProxy.__getitem__', _asking_parameter)
    replace('rosgraph.masterapi.Master.getParam', _asking_master)
    replace('_posixsubprocess.fork_exec', _spawning)
    replace('concurrent.futures._base.Future.__hash__', lambda _hash: Numbered.__hash__)
    for name, kind in (('listdir', sorted), ('scandir', _Scan)):
        replace('os.' + name, lambda machine, kind=kind: _listing(machine, kind))
        in_order = getattr(os, name)
        os.supports_fd.add(in_order)
        if sys.version_info < (3, 11):  # pathlib has kept the function from the time of its import
            replace('pathlib._NormalAccessor.' + name, lambda _machine, by=in_order: staticmethod(by))
    for name in ('stat', 'lstat', 'access'):
        machine = getattr(os, name)
        replace('os.' + name, files.asking)
        for able in (os.supports_dir_fd, os.supports_fd, os.supports_follow_symlinks, os.supports_effective_ids):
            able.update({getattr(os, name)} if machine in able else ())
        if name != 'access' and sys.version_info < (3, 11):
            replace('pathlib._NormalAccessor.' + name, lambda _machine, ask=getattr(os, name): staticmethod(ask))
    sys.addaudithook(_audit)


def hand_on(clocks: Any) -> None:
    """Replace functions made in C, such as ``id``, where the program's own code names them.

    ``clocks`` are the clocks that the program sees.
    """
    setattr(builtins, ASK, _Asking(clocks).ask)
    setattr(builtins, FILE_TIME, _file_time)
    setattr(builtins, HASHED, _hashed)
    keepers = {_id: _key, threading.get_ident: _key_of_thread}
    setattr(builtins, KEPT, lambda what: keepers.get(what, what))
    setattr(builtins, SHOWN, _shown)
    setattr(builtins, SHOWING, lambda what: _showing(what) if what in _TEXT_MAKERS else what)


def _telling(function: Any, name: str, why: str) -> Callable[..., Any]:
    def call(*args: Any, **kwds: Any) -> Any:
        frame = sys._getframe(1)
        found = function(*args, **kwds)
        if found != _EVERYWHERE and (is_own(frame) or asks_for_program(frame.f_code.co_filename)):
            told.tell(own_frame(frame), name, why)
        return found
    return call


def _asking_parameter(getitem: Callable[..., Any]) -> Callable[..., Any]:
    """Return ``MasterProxy.__getitem__`` that labels the run for parameters that roslaunch sets anew in each run."""
    def get(self: Any, key: str) -> Any:
        frame: Any = sys._getframe(1)
        while frame is not None and not is_own(frame):
            frame = frame.f_back
        _tell_of_roslaunch(rospy.resolve_name(key), frame)
        return getitem(self, key)
    return get


def _asking_master(get_param: Callable[..., Any]) -> Callable[..., Any]:
    """Return ``Master.getParam`` of rosgraph that does the same; calls of ROS and of this package do not count."""
    def getParam(self: Any, key: str) -> Any:  # noqa: N802
        frame: Any = sys._getframe(1)
        while frame.f_globals.get('__name__') == 'rosparam':
            frame = frame.f_back
        if is_own(frame):
            _tell_of_roslaunch(rosgraph.names.resolve_name(key, self.caller_id), frame)
        return get_param(self, key)
    return getParam


def _tell_of_roslaunch(name: str, frame: Any) -> None:
    if name in ('/', '/run_id') or (name + '/').startswith('/roslaunch/'):
        told.tell(frame, 'rospy.get_param', 'of {}: roslaunch sets another one in each run'.format(name))


def _spawning(fork_exec: Callable[..., Any]) -> Callable[..., Any]:
    """Return ``fork_exec`` that labels the run for processes of multiprocessing; for subprocess, sys.audit does it."""
    def call(*args: Any) -> Any:
        frame = sys._getframe(1)
        if frame.f_globals.get('__name__') != 'subprocess':
            told.tell(own_frame(frame), '_posixsubprocess.fork_exec', _PROCESS)
        with own_cores.lifted():
            return fork_exec(*args)
    return call


def _follow_processes() -> None:
    for name in ('multiprocessing.process.BaseProcess.ident', 'multiprocessing.process.BaseProcess.pid'):
        replace(name, lambda of, name=name: property(_telling(of.fget, name, NUMBER)))


def _reading_link(readlink: Callable[..., Any]) -> Callable[..., Any]:
    def call(path: Any, *args: Any, **kwds: Any) -> Any:
        _tell_of_device(path, sys._getframe(1))
        return readlink(path, *args, **kwds)
    return call


def _formatting(init: Callable[..., None]) -> Callable[..., None]:
    """Return ``Formatter.__init__`` that labels the run if the program's log shows numbers of processes or threads."""
    @functools.wraps(init)
    def call(self: Any, fmt: Optional[str] = None, *args: Any, **kwds: Any) -> None:
        if isinstance(fmt, str) and _NUMBER_IN_LOG.search(fmt):
            told.tell(own_frame(sys._getframe(1)), 'logging.Formatter', 'shows the number of the process or thread, '
                      'which is another one in another run')
        init(self, fmt, *args, **kwds)
    return call


def _listing(machine: Callable[..., Any], in_order: Callable[..., Any]) -> Callable[..., Any]:
    """Return ``os.listdir`` or ``os.scandir`` with the entries in order; otherwise their order is the file system's."""
    def call(path: str = '.') -> Any:
        _tell_of_device(path, sys._getframe(1))
        return in_order(machine(path))
    return call


def _tell_of_device(path: str, frame: Any) -> None:
    path = os.fsdecode(path) if isinstance(path, (bytes, os.PathLike)) else path
    if isinstance(path, str) and (path + '/').startswith(_DEVICES) and not path.startswith(_HARMLESS):
        path = _PROCESS_NUMBER.sub('/NUMBER', path)
        told.tell(own_frame(frame), 'open', 'of {}: what the machine says there differs from run to run'.format(path))


class _Scan(Iterator[Any], AbstractContextManager):
    """Replaces the result of os.scandir, with the entries in the order of their names."""

    def __init__(self, entries: Any) -> None:
        with entries:
            self._entries = iter(sorted(entries, key=lambda entry: entry.name))

    def __next__(self) -> Any:
        return next(self._entries)

    def __exit__(self, *_error: Any) -> None:
        self.close()

    def close(self) -> None:
        """Close it, as the result of os.scandir."""
        self._entries = iter(())


def _audit(event: Any, arguments: Any) -> None:
    files.audit(event, arguments)
    if event in EVENTS:
        told.tell(own_frame(sys._getframe(1)), event, EVENTS[event])
        if event in _STARTS and told.participant is not None:
            told.participant.parameters.settle()  # the other process may read them
    elif event == 'open':
        _tell_of_device(arguments[0], sys._getframe(1))
    elif event == 'ctypes.dlsym' and (arguments[1] in _OF_C or arguments[1] in _FOLLOWED_OF_C and not (
            native.is_there and getattr(arguments[0], '_name', '') is None)):
        told.tell(own_frame(sys._getframe(1)), 'ctypes.dlsym', "{}() of the C library is the machine's, not the run's"
                  .format(arguments[1]))
    elif event in ('tempfile.mkstemp', 'tempfile.mkdtemp'):
        chance.is_taken(arguments[0], sys._getframe(1))


class _Asking:
    """Replaces names of C functions in the program's own code."""

    def __init__(self, clocks: Any) -> None:
        self._clocks = clocks

    def ask(self, what: Any) -> Callable[..., Any]:
        """Return what the program gets instead of ``what``."""
        kind = type(what)
        if kind is types.BuiltinFunctionType:
            if what is _id:
                if arenas.are_on():
                    return _id_of
                told.tell(sys._getframe(1), 'id', _ADDRESS)
            elif what is threading.get_ident:
                told.tell(sys._getframe(1), 'threading.get_ident', _ADDRESS)
            elif what is _hash:
                return _hash_of  # the function itself is passed on, for example as a key to sort by
            elif is_moment(what):
                return self._clocks.moment(what.__self__, what.__name__, sys._getframe(1))
        elif kind in _HASHES and what.__qualname__ == 'object.__hash__':
            if arenas.are_on() and kind is types.WrapperDescriptorType:
                return _address_of
            if not arenas.holds(_id(getattr(what, '__self__', None))):
                told.tell(sys._getframe(1), 'hash', _ADDRESS)
        elif kind is type and what.__name__ == 'datetime64' and not native.is_there:  # datetime64('now') is the present
            told.tell(sys._getframe(1), 'numpy.datetime64', 'reads the wall clock')
        return what


_id, _hash = id, hash
_HASHES = (types.MethodWrapperType, types.WrapperDescriptorType)


def _file_time(value: Any) -> Any:
    if type(value) in (int, float):
        told.tell(sys._getframe(1), 'os.stat', _WRITTEN)
    return value


def _hashed(value: Any) -> Any:
    if is_hashed_by_address(value):
        told.tell(sys._getframe(1), 'hash', _ADDRESS)
    return value


def _hash_of(value: Any, /) -> Any:
    if is_hashed_by_address(value):
        told.tell(own_frame(sys._getframe(1)), 'hash', _ADDRESS)
    return _hash(value)


class _Key(Address):
    """An address that the program keeps as a key. It labels the run when it shows, or puts things in an order."""

    __slots__ = ()


def _telling_key(name: str) -> Callable[..., Any]:
    machine = getattr(int, name)

    def call(self: Any, *others: Any) -> Any:
        told.tell(own_frame(sys._getframe(1)), 'id', _ADDRESS)
        return machine(self, *others)
    return call


for _name in ('lt', 'le', 'gt', 'ge', 'repr', 'format', 'add', 'radd', 'sub', 'rsub', 'mul', 'rmul', 'mod', 'rmod',
              'floordiv', 'truediv', 'divmod', 'and', 'rand', 'or', 'ror', 'xor', 'rxor', 'lshift', 'rshift', 'neg',
              'invert', 'float', 'int', 'abs', 'pow', 'rpow', 'round'):
    setattr(_Key, '__{}__'.format(_name), _telling_key('__{}__'.format(_name)))


def _holding(function: Callable[[Any], int], name: str) -> Callable[[Any], int]:
    """Return ``id`` or ``object.__hash__`` that labels the run if the object lies elsewhere in the next run."""
    def call(one: Any, /) -> int:
        if not arenas.holds(_id(one)):
            told.tell(own_frame(sys._getframe(1)), name, _ADDRESS)
        return function(one)
    return call


_id_of, _address_of = _holding(_id, 'id'), _holding(object.__hash__, 'hash')


def _key(one: Any, /) -> int:
    address = _id(one)
    return address if arenas.holds(address) else _Key(address)


def _key_of_thread() -> int:
    return _Key(threading.get_ident())


def _ident_of(ident: Optional[int]) -> Optional[int]:
    return ident if ident is None or not is_own(sys._getframe(2)) else _Key(ident)


#: an address in a text of an object, and the number of a thread in its text; Numbered shows numbers that begin with 0
_SHOWN_ADDRESS = re.compile(r' at (0x[1-9a-f][0-9a-f]*)|, started (?:daemon )?[0-9]+\)>')
_TEXT_MAKERS = (ascii, repr, str)


def _shown(text: Any, how: str, frame: Any = None) -> Any:
    if type(text) is str and (' at 0x' in text or ', started ' in text) and any(
            not address or not arenas.holds(int(address, 16)) for address in _SHOWN_ADDRESS.findall(text)):
        told.tell(frame or sys._getframe(1), how, _ADDRESS)
    return text


def _showing(make: Callable[[Any], str]) -> Callable[[Any], str]:
    return lambda one: _shown(make(one), make.__name__, own_frame(sys._getframe(1)))
