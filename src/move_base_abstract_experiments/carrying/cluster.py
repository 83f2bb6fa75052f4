"""Run trials by Dask distributed: on workers on this computer, or on those of a running scheduler.

Short trials go in batches. If a worker dies, the trial that it was running runs again elsewhere, a bounded number of
times. A trial that fails runs once more; then its failure is recorded. Only as many trials are under way as keep the
workers busy, so that the memory of client, scheduler and workers does not grow with the number of trials.
"""
from __future__ import annotations

import collections
import contextlib
import multiprocessing
import os
import pickle
import queue
import signal
import sys
import time
import warnings
from multiprocessing import resource_tracker
from typing import (
    Any,
    Callable,
    ContextManager,
    Deque,
    Dict,
    Iterable,
    Iterator,
    List,
    NamedTuple,
    Optional,
    Sequence,
    Tuple,
)

from move_base_abstract.common import guard, temporary
from move_base_abstract.common.errors import SimulatorError

from ..description.job import Job
from . import batches, jobs, spool
from .workers import LOST_S, Workers, key_of

TRIES = 2  # the attempts of a trial that fails by itself
LOSSES = 8  # so many workers may be lost before a trial counts as failed
AHEAD = 2  # batches under way per thread of a worker
_MOST_LOGGED = 1000  # entries in the logs that Dask keeps in memory
_LOOK_S = 0.5  # wall
_SPOOL = 'outputs'  # the name of the spool, in the temporary folder of Dask
_HTTP = '127.0.0.1:0'  # Dask serves pages in any case; without an address, on all addresses of the computer
#: Dask keeps, for an hour, a profile of each process (100 times a second) and its load. Only Dask's page shows them.
_UNSEEN = {'distributed.worker.profile.enabled': False, 'distributed.worker.profile.interval': '1h',
           'distributed.worker.profile.cycle': '1h', 'distributed.admin.system-monitor.interval': '10s'}
_CONNECT_S = 30.0  # wall
_STOP_S = 10.0  # wall


class ClusterError(SimulatorError):
    """Dask is not installed, or its scheduler cannot be reached."""


@contextlib.contextmanager
def connected(workers: int, scheduler: Any, has_dashboard: bool = False) -> Iterator[Tuple[Any, Workers]]:
    """Give (a Client, its Workers) of a new cluster on this computer, or of a running scheduler.

    workers: the number of processes of a new cluster. scheduler: the address of a running one, or None.
    has_dashboard: whether a new cluster serves Dask's page; everybody with an account on this computer can see it.
    :raises ClusterError: if Dask is not installed, or the scheduler cannot be reached.
    """
    try:
        import dask
        from distributed import Client, LocalCluster, Security
    except ImportError as error:
        raise ClusterError(f'{error.name} is not installed for {sys.executable}; Debian has it as '
                           'python3-distributed (make deps-experiment), pip as the extra [experiments]') from None
    _configure(dask, has_dashboard)
    own = shared = None
    with contextlib.ExitStack() as stack:
        if scheduler is None:
            # Workers that live on make what has been removed again: a guard removes it last.
            folder = temporary.make('dask_') if guard.is_there() else stack.enter_context(temporary.folder('dask_'))
            others = list(LocalCluster._instances)
            try:
                with _ctrl_c_is_ours():
                    scheduler = own = LocalCluster(
                        n_workers=workers, threads_per_worker=1, processes=True, host='127.0.0.1',
                        dashboard_address=_HTTP, worker_dashboard_address=_HTTP,
                        scheduler_kwargs={'dashboard': has_dashboard},
                        local_directory=folder, memory_limit=0, silence_logs=50,
                        security=_in_files(Security.temporary(), folder), protocol='tls://')  # other users stay out
            except BaseException:
                _stop(*(begun for begun in LocalCluster._instances if begun not in others))
                raise
            shared = os.path.join(folder, _SPOOL)
            stack.callback(_close_all, scheduler)
        try:
            with _ctrl_c_is_ours():
                client = Client(scheduler, timeout=_CONNECT_S)
        except (OSError, ValueError) as error:
            raise ClusterError(f'the scheduler {scheduler} cannot be reached: {error}') from None
        stack.callback(_close, client)
        yield client, Workers(client, own, workers, spool=shared)


def _configure(dask: Any, has_dashboard: bool) -> None:
    warnings.filterwarnings('ignore', module='distributed')
    dask.config.set({'distributed.logging.distributed': 'critical', 'distributed.comm.timeouts.connect': _CONNECT_S,
                     'distributed.scheduler.allowed-failures': LOSSES,
                     'distributed.deploy.lost-worker-timeout': f'{LOST_S:g}s',
                     'distributed.worker.daemon': False,
                     'distributed.scheduler.transition-log-length': _MOST_LOGGED,
                     'distributed.scheduler.events-log-length': _MOST_LOGGED,
                     'distributed.admin.low-level-log-length': _MOST_LOGGED,
                     # Otherwise Dask reads the program's text each time that a task is submitted.
                     'distributed.diagnostics.computations.ignore-modules': ['.*'],
                     'distributed.diagnostics.computations.nframes': 0})
    _quiet()
    if not has_dashboard:
        dask.config.set({'distributed.scheduler.http.routes': [], 'distributed.worker.http.routes': [], **_UNSEEN})


def _in_files(security: Any, folder: str) -> Any:
    """Put Dask's keys into files: otherwise each process does, in TMPDIR, and leaves them there if it is killed."""
    whose = ('client', 'scheduler', 'worker')
    for role in ('ca_file', *(f'{one}_{what}' for one in whose for what in ('key', 'cert'))):
        path = os.path.join(folder, role)
        with open(path, 'x', encoding='ascii') as stream:
            stream.write(getattr(security, f'tls_{role}'))
        setattr(security, f'tls_{role}', path)
    return security


@contextlib.contextmanager
def _ctrl_c_is_ours() -> Iterator[None]:
    """Let threads and processes that are started in this context not see Ctrl-C. This process ends them itself."""
    resource_tracker.ensure_running()  # the first child would start it otherwise, and that unblocks the signal
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _quiet() -> None:
    import logging
    for name in ('distributed', 'distributed.nanny', 'distributed.worker', 'distributed.scheduler',
                 'distributed.client', 'distributed.core', 'distributed.utils', 'tornado.application', 'bokeh',
                 'asyncio'):
        logging.getLogger(name).setLevel(logging.CRITICAL)


def _close(what: Any) -> None:
    with contextlib.suppress(Exception):
        what.close(timeout=10)


def _close_all(cluster: Any) -> None:
    """Close a cluster on this computer; kill workers that are left, for example because they are stopped."""
    _close(cluster)
    _stop(cluster)


def _stop(*clusters: Any) -> None:
    """Stop the threads of clusters, and kill their workers.

    Otherwise Python would wait for them at its end, and Dask would wait for their answers once more and start others.
    """
    for cluster in clusters:
        with contextlib.suppress(Exception):
            cluster._loop_runner.stop()
            cluster.status = type(cluster.status).closed
    for process in multiprocessing.active_children():
        process.kill()


class _Piece(NamedTuple):
    """A trial that is to run."""

    job: Job
    attempts: int = 1
    losses: int = 0  # the number of workers that died while they ran it
    is_alone: bool = False  # whether it must be alone in its batch


class Runner:
    """Runs jobs on a Client with its Workers.

    ``done(job, worker, outputs, problem, attempts)`` is called for each job, in the order in which they end.
    ``outputs``: bytes, or None with a text in ``problem``. ``again(outputs, job)`` returns the job with which a failed
    trial runs again, or None. ``look(runner)`` is called now and then. ``together()`` gives a context, in which done()
    is called for the jobs of one batch.
    """

    def __init__(self, client: Any, watch: Workers, done: Callable[..., None],
                 again: Callable[[Optional[bytes], Job], Optional[Job]], look: Callable[[Runner], None],
                 together: Callable[[], ContextManager[Any]] = contextlib.nullcontext) -> None:
        self._client = client
        self._watch = watch
        self._done = done
        self._again = again
        self._look = look
        self._together = together
        self._ended: Any = queue.SimpleQueue()  # the keys of batches that have ended
        self._running: Dict[str, Tuple[List[_Piece], Any]] = {}  # {key: (the batch, its future)}
        self._returned: Deque[_Piece] = collections.deque()  # pieces that run again, or were not begun
        self._sizes = batches.Sizes()
        self._left = 0
        self._count = 0
        self.workers = 0

    def run(self, all_jobs: Iterable[Job], count: int) -> None:
        """Run all jobs; ``count``: their number. However this ends, no trial is under way afterwards."""
        waiting, self._left = iter(all_jobs), count
        last_look = 0.0
        try:
            self._fill(waiting)
            while self._running:
                with contextlib.suppress(queue.Empty):
                    self._take(self._ended.get(timeout=_LOOK_S))
                if time.monotonic() - last_look > _LOOK_S:
                    last_look = time.monotonic()
                    self.workers = self._watch.look()
                    self._look(self)
                self._fill(waiting)
        finally:
            self._stop()

    @property
    def under_way(self) -> int:
        """The number of trials that were submitted and have not come back."""
        return sum(len(pieces) for pieces, _ in self._running.values())

    def _fill(self, waiting: Iterator[Job]) -> None:
        while len(self._running) < AHEAD * max(1, self.workers):
            pieces = self._next(waiting)
            if not pieces:
                return
            self._submit(pieces)

    def _next(self, waiting: Iterator[Job]) -> List[_Piece]:
        """Return the pieces of the next batch."""
        size = self._sizes.size(self._left + len(self._returned), self.workers)
        pieces: List[_Piece] = []
        while len(pieces) < size:
            if self._returned:
                if self._returned[0].is_alone:
                    return pieces or [self._returned.popleft()]
                pieces.append(self._returned.popleft())
                continue
            job = next(waiting, None)
            if job is None:
                break
            self._left -= 1
            pieces.append(_Piece(job))
        return pieces

    def _submit(self, pieces: List[_Piece]) -> None:
        self._count += 1
        key = key_of(self._count, [one.job.trial.id for one in pieces])
        notes = self._notes(key)
        future = self._client.submit(batches.carry_out, pickle.dumps([one.job for one in pieces]),
                                     notes and notes.path, key=key, pure=False, retries=0)
        self._running[key] = (pieces, future)
        future.add_done_callback(lambda one: self._ended.put(one.key))

    def _notes(self, key: str) -> Optional[spool.Notes]:
        return spool.Notes(os.path.join(self._watch.spool, key)) if self._watch.spool else None

    def _take(self, key: str) -> None:
        if key not in self._running:
            return
        pieces, future = self._running.pop(key)
        notes = self._notes(key)
        error: Optional[Exception] = None
        answers: Sequence[Optional[Tuple[Any, ...]]]
        try:
            seconds, ran, answers = future.result(timeout=_CONNECT_S)
        except Exception as problem:  # KilledWorker, CancelledError, a worker that dies while it answers
            error, answers = problem, self._found(pieces, notes)
        else:
            if ran:
                self._sizes.learn(ran, seconds)
        finally:
            future.release()
        with self._together():
            for number, (piece, answer) in enumerate(zip(pieces, answers)):
                if answer is not None:
                    self._end(piece, batches.Answer(*answer), notes, number)
                elif len(pieces) == 1:
                    self._lost(piece, error)
                else:  # alone in a batch, a trial shows whether it kills its worker
                    self._returned.append(piece._replace(is_alone=True))
        self._returned.extend(pieces[len(answers):])
        if notes:
            notes.remove(len(pieces))

    def _found(self, pieces: List[_Piece], notes: Optional[spool.Notes]) -> List[Optional[Tuple[Any, ...]]]:
        """Return, for a batch without an answer, the Answer of each trial whose outputs are in the spool, or None."""
        found = [notes is not None and notes.has(number) for number in range(len(pieces))]
        return [tuple(batches.Answer('', None, None)) if is_there else None for is_there in found]

    def _end(self, piece: _Piece, answer: batches.Answer, notes: Optional[spool.Notes], number: int) -> None:
        """Take the Answer of a piece."""
        if answer.is_lost:
            self._lost(piece, answer.problem)
            return
        outputs = notes.take(number) if notes and answer.problem is None else answer.outputs
        next_job = self._again(outputs, piece.job) if piece.attempts < TRIES else None
        if next_job is not None:
            self._returned.append(piece._replace(job=next_job, attempts=piece.attempts + 1))
        else:
            self._done(piece.job, answer.worker, outputs, answer.problem, piece.attempts)

    def _lost(self, piece: _Piece, error: object) -> None:
        if piece.losses < LOSSES:
            self._returned.append(piece._replace(losses=piece.losses + 1, is_alone=True))
            return
        text = str(error).strip().splitlines()
        kind = '' if isinstance(error, str) else f'{type(error).__name__}: '
        self._done(piece.job, '', None, f'its workers were lost {piece.losses + 1} times; the last time: '
                   f'{kind}{text[0] if text else ""}', piece.attempts)

    def _stop(self) -> None:
        if self._running:
            with contextlib.suppress(Exception):
                self._client.cancel([future for _, future in self._running.values()], force=True)
            with contextlib.suppress(Exception):
                # Without a limit this would wait for a stopped worker for ever.
                self._client.sync(self._client._run, jobs.end_all, callback_timeout=_STOP_S)
        self._running.clear()
