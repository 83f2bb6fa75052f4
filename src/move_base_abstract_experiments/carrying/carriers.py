"""A process that carries out trials: one of a graph, or many that are functions, one after another.

It is forked from a warm process. calls.call() forks a process of its own for each function, and ends everything that
it has started. So a trial leaves nothing behind for the next one, and one fork per trial is saved.
"""
from __future__ import annotations

import contextlib
import os
import pickle
import select
import socket
from typing import Optional, Tuple

from move_base_abstract.common import processes

from ..description.job import Job
from ..trials import run_folders
from . import sockets

_MOST_TRIALS = 1000  # in one process; then another one takes its place, so that its memory cannot grow without end
_DONE = b'd'


class Carrier:
    """Runs jobs in such a process, and starts one if there is none. descriptors: those that the process closes."""

    def __init__(self, descriptors: Tuple[int, ...]) -> None:
        self._descriptors = descriptors
        self._child: Optional[Tuple[int, socket.socket]] = None  # its process id, and the connection to it
        self._count = 0

    def run(self, job: Job, path: str, problem: Optional[str], client: socket.socket, wake: int) -> Optional[int]:
        """Carry out a job, as execution.carry_out() does. Return 0, or the exit code of the process if it died.

        Return None if the socket ``client`` was closed meanwhile; the process still runs then. wake: a descriptor that
        can be read when a child has ended.
        """
        if self._count >= _MOST_TRIALS:
            self.end()
        pid, connection = self._child = self._child or self._start()
        self._count += 1
        with contextlib.suppress(OSError):  # the process may have died before
            connection.sendall(pickle.dumps((job, path, problem)))
        while True:
            ready, _, _ = select.select([client, connection, wake], [], [])
            if connection in ready and _received(connection) == _DONE:
                return 0
            if client in ready:  # the worker sends nothing meanwhile, so it has closed the socket
                return None
            drain(wake)
            found, status = os.waitpid(pid, 0 if connection in ready else os.WNOHANG)
            if found:
                connection.close()
                self._child = None
                return processes.code_of(status)

    def end(self) -> None:
        """End the process, if there is one. To be called between two trials, when it has no child."""
        if self._child is not None:
            pid, connection = self._child
            connection.close()
            os.waitpid(pid, 0)
            self._child = None

    def _start(self) -> Tuple[int, socket.socket]:
        own, other = sockets.pair()
        with other:
            descriptors = (*self._descriptors, own.fileno())
            pid = processes.fork(lambda: _carry_on(other, descriptors), new_session=True)
        self._count = 0
        return pid, own


def drain(wake: int) -> None:
    """Read everything from a non-blocking pipe."""
    with contextlib.suppress(BlockingIOError):
        while os.read(wake, 512):
            pass


def _received(connection: socket.socket) -> bytes:
    try:
        return connection.recv(1)
    except OSError:
        return b''


def _carry_on(asked: socket.socket, descriptors: Tuple[int, ...]) -> None:
    """Carry out the jobs that are asked for, until the connection is closed."""
    from ..trials import execution
    for descriptor in descriptors:
        os.close(descriptor)
    with asked.makefile('rb') as requests:
        while requests.peek(1):
            job, path, problem = pickle.load(requests)
            processes.redirect(os.path.join(path, run_folders.PRINTS))
            execution.carry_out(job, path, problem)
            asked.sendall(_DONE)
