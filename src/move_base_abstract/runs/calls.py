"""Call a function in a fork of this process, which ends with all that it has started, and have its result."""
from __future__ import annotations

import json
import os
import select
import signal
import sys
import time
from typing import Any, Callable, Dict, List, Optional

from ..common import processes
from ..common.errors import SimulatorError
from .ends import described as described_end

_MOST_BYTES = 1 << 20
_DYING_S = 1.0  # wall; a process that has closed its pipe has this time to end


class CallError(SimulatorError):
    """A function raised an exception, did not come to its end, or returned a value that is not allowed."""


class DeathError(CallError):
    """A process that has ended, or was ended, without a result.

    ``code``: its exit code, or the negative number of the signal that ended it, or None. ``is_late``: it was ended.
    """

    def __init__(self, seconds: float, code: Optional[int], is_late: bool) -> None:
        how = '' if code is None else f': {described_end(code)}'
        super().__init__(f'it was not over after {seconds:g} s of wall time' if is_late
                         else f'its process ended without a result{how}')
        self.code, self.is_late = code, is_late


def call(work: Callable[[], Any], seconds: float, output: str, cwd: Optional[str] = None) -> Any:
    """Call work() in a forked process; return its result, as JSON can hold it. All processes that it started are ended.

    seconds: the limit of wall time. output: the path of the file for its prints. cwd: its working folder.

    :raises CallError: saying what is wrong.
    """
    read, write = os.pipe()

    def child() -> None:
        os.close(read)
        _answer(work, write)
    pid = processes.fork(child, output, cwd)
    os.close(write)
    statuses: Dict[int, int] = {}
    try:
        text = _read_line(read, seconds)
        if text is not None and not text.endswith(b'\n'):
            processes.await_ends({pid}, _DYING_S, statuses)
        code = processes.code_of(statuses[pid]) if pid in statuses else None
    finally:
        processes.end([pid], signal.SIGKILL, 1.0, {})
        processes.end_all_children()
    try:
        answer = json.loads(text or b'')
    except ValueError:
        raise DeathError(seconds, code, text is None) from None
    if 'problem' in answer:
        raise CallError(answer['problem'])
    return answer['value']


def _answer(work: Callable[[], Any], write: int) -> None:
    """Call work(), and write its result or its problem into the pipe."""
    try:
        text = json.dumps({'value': work()})
    except BaseException as problem:
        text = json.dumps({'problem': described(problem)})
        if not isinstance(problem, SimulatorError):
            raise
    finally:
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        # Children of this process may hold the pipe open, so the end of the line marks the end of the answer.
        with os.fdopen(write, 'wb') as pipe:
            pipe.write(text.encode() + b'\n')


def described(problem: BaseException) -> str:
    """Return the type and the first line of an exception; for a SimulatorError the line alone."""
    lines = str(problem).strip().splitlines()
    text = lines[0] if lines else ''
    return text if isinstance(problem, SimulatorError) and text else f'{type(problem).__name__}: {text}'


def _read_line(descriptor: int, seconds: float) -> Optional[bytes]:
    """Return the bytes up to the end of the first line, or of the pipe; None if that takes longer [s, wall]."""
    pieces: List[bytes] = []
    deadline = time.monotonic() + seconds
    with os.fdopen(descriptor, 'rb', buffering=0) as stream:
        while sum(map(len, pieces)) < _MOST_BYTES:
            ready, _, _ = select.select([stream], [], [], max(0.0, deadline - time.monotonic()))
            if not ready:
                return None
            piece = stream.read(1 << 16)
            pieces.append(piece)
            if not piece or piece.endswith(b'\n'):
                break
    return b''.join(pieces)
