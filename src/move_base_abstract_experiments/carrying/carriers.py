"""The process that carries out trials that are functions, one after another, forked from a warm process.

Each function runs in a process of its own, as functions.call() forks it, and all that it has started ends with that. So
nothing of one trial is left for the next one, and a fork for each trial is saved.
"""
import contextlib
import os
import pickle
import select
import socket

from move_base_abstract.common import processes

_MOST_TRIALS = 1000  # of one process; then another one takes its place, so that what it may keep never grows
_DONE = b'd'


class Carrier:
    """Runs jobs in such a process, which it starts when there is none. descriptors: to be closed in it."""

    def __init__(self, descriptors):
        self._descriptors = descriptors
        self._pid = None
        self._socket = None
        self._count = 0

    def run(self, job, path, problem, client, wake):
        """Carry out a job as trial.carry_out(); return 0, the exit code of the process if it died, or None.

        None: the socket ``client`` was closed meanwhile; the process still runs then. wake: a descriptor that can be
        read when a child has ended.
        """
        if self._count >= _MOST_TRIALS:
            self.end()
        if self._pid is None:
            self._start()
        self._count += 1
        with contextlib.suppress(OSError):  # it has died before
            self._socket.sendall(pickle.dumps((job, path, problem)))
        while True:
            ready, _, _ = select.select([client, self._socket, wake], [], [])
            if self._socket in ready and _received(self._socket) == _DONE:
                return 0
            if client in ready:  # nobody says anything meanwhile: it is closed
                return None
            drain(wake)
            found, status = os.waitpid(self._pid, 0 if self._socket in ready else os.WNOHANG)
            if found:
                self._socket.close()
                self._pid = None
                return processes.code_of(status)

    def end(self):
        """End the process, if there is one; between two trials it has no child."""
        if self._pid is not None:
            self._socket.close()
            os.waitpid(self._pid, 0)
            self._pid = None

    def _start(self):
        own, other = socket.socketpair()
        with other:
            descriptors = (*self._descriptors, own.fileno())
            self._pid = processes.fork(lambda: _carry_on(other, descriptors), new_session=True)
        self._socket, self._count = own, 0


def drain(wake):
    """Read all that a pipe which does not block holds."""
    with contextlib.suppress(BlockingIOError):
        while os.read(wake, 512):
            pass


def _received(connection):
    try:
        return connection.recv(1)
    except OSError:
        return b''


def _carry_on(asked, descriptors):
    """Carry out what is asked for until nobody can ask any more."""
    from ..trials import execution
    for descriptor in descriptors:
        os.close(descriptor)
    with asked.makefile('rb') as requests:
        while requests.peek(1):
            job, path, problem = pickle.load(requests)
            processes.redirect(os.path.join(path, 'trial.txt'))
            execution.carry_out(job, path, problem)
            asked.sendall(_DONE)
