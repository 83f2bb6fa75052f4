"""Run trials that are functions one after another in one process (``isolation: batch``), without a fork for each.

If a trial leaves something behind, the process ends and another one takes its place. That may be a thread, a child
process, an open file, another environment, much memory, an exception, or other values in the modules of the function.
Changes that a function makes in modules of others are not noticed.
"""
from __future__ import annotations

import json
import os
import pickle
import select
import signal
import socket
import sys
import threading  # noqa: TID251 - the program's own may start some
import time
import traceback
import types
from typing import Any, Dict, List, Optional, Set, Tuple

from move_base_abstract.common import processes, sockets
from move_base_abstract.common.errors import SimulatorError

from ..description import program_files
from ..description.job import Job
from . import functions, run_folders
from .run_folders import Folders

LABEL = 'isolation: batch: trials before it may have run in its process'
_MOST_TRIALS = 250  # the largest number of trials in one process
_MOST_GROWN = 64 << 20  # bytes; the process may grow by this much memory
_MOST_COMPARED = 1 << 20  # bytes of a value; a larger one counts as changed
_MOST_BYTES = 1 << 20  # of an answer
_DYING_S = 1.0  # wall; a process that has closed its connection has this time to end
_FIXED = (types.ModuleType, types.FunctionType, types.BuiltinFunctionType, type, int, float, complex, str, bytes,
          type(None))  # the types of values that cannot change: the same object is the same value
_TASKS = '/proc/self/task'
_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGALRM, signal.SIGCHLD)
_LAST = b'!'  # begins the last answer of a process, after which it ends


class Series:
    """The process in which the trials run, one after another, and the connection to it."""

    def __init__(self) -> None:
        self._child: Optional[Tuple[int, socket.socket]] = None
        self._count = 0
        self._program: Any = None  # the modules and the program of the trials in the process

    def run(self, job: Job, folders: Folders) -> functions.Returned:
        """Run the trial that is a job's function, as functions.run_trial() does."""
        processes.adopt_orphans()
        processes.block_child_signal()
        if self._count >= _MOST_TRIALS or self._program != (job.modules, job.program):
            self.end()
        self._program = job.modules, job.program
        pid, connection = self._child = self._child or self._start()
        self._count += 1
        limit = job.trial.experiment.time_limit
        try:
            connection.sendall(pickle.dumps((job, folders)))
            line = _read_line(connection, limit)
        except OSError:
            line = b''
        if line is None or not line.endswith(b'\n'):
            statuses: Dict[int, int] = {}
            if line is not None:
                processes.await_ends({pid}, _DYING_S, statuses)
            self.end()
            raise functions.DeathError(limit, processes.code_of(statuses[pid]) if pid in statuses else None,
                                       line is None)
        if line.startswith(_LAST):
            self.end()
        answer = json.loads(line.lstrip(_LAST))
        if 'problem' in answer:
            raise functions.FunctionError(answer['problem'])
        return functions.Returned(*answer['value'])

    def end(self) -> None:
        """End the process, and all processes that its trials have left."""
        if self._child is not None:
            pid, connection = self._child
            self._child = None
            connection.close()
            processes.end([pid], signal.SIGKILL, 1.0, {})
            processes.end_all_children()

    def _start(self) -> Tuple[int, socket.socket]:
        own, other = sockets.pair()

        def child() -> None:
            own.close()
            _carry_on(other)
        with other:
            pid = processes.fork(child)
        self._count = 0
        return pid, own


_series = Series()
run, end = _series.run, _series.end


def _read_line(connection: socket.socket, seconds: float) -> Optional[bytes]:
    """Return the bytes up to the end of the first line, or of the connection; None if that takes longer [s, wall]."""
    text, deadline = b'', time.monotonic() + seconds
    while not text.endswith(b'\n') and len(text) < _MOST_BYTES:
        if not select.select([connection], [], [], max(0.0, deadline - time.monotonic()))[0]:
            return None
        piece = connection.recv(1 << 16)
        if not piece:
            break
        text += piece
    return text


def _carry_on(asked: socket.socket) -> None:
    """Run the trials that are asked for until the connection ends, or a trial has left something behind."""
    watch, is_last = _Watch(), False
    with asked.makefile('rb') as requests:
        while not is_last and requests.peek(1):
            job, folders = pickle.load(requests)
            text, is_last = _answer(job, folders, watch)
            for stream in (sys.stdout, sys.stderr):
                stream.flush()
            asked.sendall((_LAST if is_last else b'') + text.encode() + b'\n')


def _answer(job: Job, folders: Folders, watch: _Watch) -> Tuple[str, bool]:
    """Run a trial; return its result as JSON, and whether the trial has left something behind."""
    processes.redirect(os.path.join(folders.logs, run_folders.OUTPUT))
    os.chdir(folders.files)
    os.environ.update(functions.environment(folders))
    hook = threading.excepthook
    try:
        functions.load(job.trial.experiment.function, job.modules)
        watch.begin(job)
        text = json.dumps({'value': functions.perform(job, folders)})
        threading.excepthook = hook
        return text, watch.has_seen_something()
    except BaseException as problem:
        if not isinstance(problem, SimulatorError):
            traceback.print_exc()
        return json.dumps({'problem': functions.described(problem)}), True


class _Watch:
    """Notices what a trial leaves behind in its process, and in its modules except those that pip has installed."""

    def __init__(self) -> None:
        self._memory = _resident()
        self._paths: Set[str] = set()
        self._folder = ''
        self._before: Any = None

    def begin(self, job: Job) -> None:
        """Take note of the state in which a trial begins."""
        self._paths = {path for path, _, _ in job.files.files if not program_files.is_by_pip(path)}
        self._folder = job.modules + os.sep
        self._before = _process(), self._values()

    def has_seen_something(self) -> bool:
        """Return whether something has changed since the trial began."""
        process, values = self._before
        now = self._values()
        return (_process() != process or functions.LOOPBACK in sys.modules or _resident() - self._memory > _MOST_GROWN
                or any(name not in now or _differ(found, now[name]) for name, found in values.items()))

    def _values(self) -> Dict[str, Dict[str, Any]]:
        """Return {module or class: {name: value, or its bytes}} for the trial's modules."""
        found: Dict[str, Dict[str, Any]] = {}
        for name, module in list(sys.modules.items()):
            file = getattr(module, '__file__', None) or ''
            if file in self._paths or file.startswith(self._folder) and not program_files.is_by_pip(file):
                found[name] = _kept_of(module)
                for key, value in list(vars(module).items()):
                    if isinstance(value, type) and value.__module__ == name:
                        found[f'{name}.{key}'] = _kept_of(value)
        return found


def _kept_of(owner: Any) -> Dict[str, Any]:
    """Return {name: value, or its bytes} for a module or class, with the defaults of its functions."""
    found = {}
    for name, value in list(vars(owner).items()):
        if not name.startswith('__'):
            found[name] = _kept(value)
        if isinstance(value, types.FunctionType):
            found[f'{name}()'] = _kept((value.__defaults__, value.__kwdefaults__, vars(value)))
    return found


def _kept(value: Any) -> Any:
    """Return a value that cannot change as it is, and any other one as its pickle, if it has one."""
    if isinstance(value, _FIXED):
        return value
    try:
        content = pickle.dumps(value, pickle.HIGHEST_PROTOCOL)
    except Exception:
        return value
    return _Changed() if len(content) > _MOST_COMPARED else content


class _Changed:
    """Stands for a value that always counts as changed."""


def _differ(before: Dict[str, Any], now: Dict[str, Any]) -> bool:
    return before.keys() != now.keys() or any(
        before[key] is not value and not (isinstance(value, bytes) and before[key] == value)
        for key, value in now.items())


def _process() -> List[Any]:
    """Return the state of this process: threads, children, open files, environment, path, hook, signal handlers."""
    return [len(os.listdir(_TASKS)), processes.children(), sorted(os.listdir('/proc/self/fd')), dict(os.environ),
            list(sys.path), sys.excepthook, [signal.getsignal(number) for number in _SIGNALS]]


def _resident() -> int:
    """Return the memory that this process uses [bytes]."""
    with open('/proc/self/statm') as stream:
        return int(stream.read().split()[1]) * os.sysconf('SC_PAGESIZE')
