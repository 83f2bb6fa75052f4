"""Dask distributed carries the trials: workers on this computer, or those of a scheduler that is running.

A worker that dies costs the trials that it was running, which run again elsewhere, a bounded number of times. A trial
that fails runs once more; then its failure is recorded. Only as many trials are under way as keep the workers busy, so
that the memory of all who take part does not grow with the number of trials.
"""
import contextlib
import multiprocessing
import os
import queue
import signal
import sys
import time
import warnings
from multiprocessing import resource_tracker

from move_base_abstract.errors import SimulatorError

from . import jobs, temporary
from .workers import LOST_S, Workers

TRIES = 2  # of a trial that fails by itself
LOSSES = 8  # of workers, before a trial counts as failed
AHEAD = 2  # trials under way per thread of a worker
_LOOK_S = 0.5  # wall
_HTTP = '127.0.0.1:0'  # Dask serves pages in any case: without an address on all of the computer's
_CONNECT_S = 30.0  # wall
_STOP_S = 10.0  # wall


class ClusterError(SimulatorError):
    """Dask is not installed, or its scheduler cannot be reached."""


@contextlib.contextmanager
def connected(workers, scheduler, has_dashboard=False):
    """Give (a Client, its Workers) of a cluster of ``workers`` processes here, or of the scheduler at an address.

    has_dashboard: of a cluster here. Whoever has an account on this computer can look at it.
    :raises ClusterError: if there is none.
    """
    try:
        import dask
        from distributed import Client, LocalCluster
    except ImportError as error:
        raise ClusterError(f'{error.name} is not installed for {sys.executable}; Debian has it as '
                           'python3-distributed (make deps)') from None
    warnings.filterwarnings('ignore', module='distributed')
    dask.config.set({'distributed.logging.distributed': 'critical', 'distributed.comm.timeouts.connect': _CONNECT_S,
                     'distributed.scheduler.allowed-failures': LOSSES,
                     'distributed.deploy.lost-worker-timeout': f'{LOST_S:g}s',
                     'distributed.worker.daemon': False})
    _quiet()
    if not has_dashboard:
        dask.config.set({'distributed.scheduler.http.routes': [], 'distributed.worker.http.routes': []})
    own = None
    with contextlib.ExitStack() as stack:
        if scheduler is None:
            folder = stack.enter_context(temporary.folder('move_base_abstract_dask_'))
            with _ctrl_c_is_ours():
                scheduler = own = LocalCluster(
                    n_workers=workers, threads_per_worker=1, processes=True, host='127.0.0.1',
                    dashboard_address=_HTTP, worker_dashboard_address=_HTTP,
                    scheduler_kwargs={'dashboard': has_dashboard},
                    local_directory=folder, memory_limit=0, silence_logs=50,
                    security=True, protocol='tls://')  # other users of this computer stay out
            stack.callback(_close_all, scheduler)
        try:
            with _ctrl_c_is_ours():
                client = Client(scheduler, timeout=_CONNECT_S)
        except (OSError, ValueError) as error:
            raise ClusterError(f'the scheduler {scheduler} cannot be reached: {error}') from None
        stack.callback(_close, client)
        yield client, Workers(client, own, workers)


@contextlib.contextmanager
def _ctrl_c_is_ours():
    """Have threads and processes that are started meanwhile not see Ctrl-C: who asked for all of them ends them."""
    resource_tracker.ensure_running()  # started by the first child, it would take the block off again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _quiet():
    import logging
    for name in ('distributed', 'distributed.nanny', 'distributed.worker', 'distributed.scheduler',
                 'distributed.client', 'distributed.core', 'distributed.utils', 'tornado.application', 'bokeh',
                 'asyncio'):
        logging.getLogger(name).setLevel(logging.CRITICAL)


def _close(what):
    with contextlib.suppress(Exception):
        what.close(timeout=10)


def _close_all(cluster):
    """Close a cluster of this computer; end the workers that closing has not ended, as they are stopped, say.

    Python would wait for them at its end, and Dask, which would once more wait for their answers, start others.
    """
    _close(cluster)
    with contextlib.suppress(Exception):
        cluster._loop_runner.stop()
        cluster.status = type(cluster.status).closed
    for process in multiprocessing.active_children():
        process.kill()


class Runner:
    """Runs jobs on a Client with its Workers.

    ``done(job, worker, outputs, problem, attempts)`` is called for each in the order they end. ``outputs``:
    bytes, or None with a text in ``problem``. ``again(outputs, job)``: the job by which a trial that has failed
    is to run again, or None. ``look(runner)`` is called now and then.
    """

    def __init__(self, client, watch, done, again, look):
        self._client = client
        self._watch = watch
        self._done = done
        self._again = again
        self._look = look
        self._ended = queue.SimpleQueue()
        self._running = {}  # key: (job, future, attempts, losses)
        self._count = 0
        self.workers = 0

    def run(self, waiting):
        """Run all jobs of an iterable. Whatever ends it, no trial of it is under way afterwards."""
        waiting = iter(waiting)
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
    def under_way(self):
        """The number of trials that were handed over and have not come back."""
        return len(self._running)

    def _fill(self, waiting):
        while len(self._running) < AHEAD * max(1, self.workers):
            job = next(waiting, None)
            if job is None:
                return
            self._submit(job, 1, 0)

    def _submit(self, job, attempts, losses):
        self._count += 1
        key = f"{job['id']}-{os.getpid()}-{self._count}"
        future = self._client.submit(jobs.carry_out, job, key=key, pure=False, retries=0)
        self._running[key] = (job, future, attempts, losses)
        future.add_done_callback(lambda one: self._ended.put(one.key))

    def _take(self, key):
        job, future, attempts, losses = self._running.pop(key, (None, None, 0, 0))
        if future is None:
            return
        try:
            worker, outputs, problem = future.result(timeout=_CONNECT_S)
        except Exception as error:  # KilledWorker, CancelledError, a worker that dies while it answers, WorkerError
            self._lost(job, attempts, losses, error)
        else:
            next_job = self._again(outputs, job) if attempts < TRIES else None
            if next_job is not None:
                self._submit(next_job, attempts + 1, losses)
            else:
                self._done(job, worker, outputs, problem, attempts)
        finally:
            future.release()

    def _lost(self, job, attempts, losses, error):
        if losses < LOSSES:
            self._submit(job, attempts, losses + 1)
        else:
            text = str(error).strip().splitlines()
            self._done(job, '', None, f'its workers were lost {losses + 1} times; the last time: '
                       f'{type(error).__name__}: {text[0] if text else ""}', attempts)

    def _stop(self):
        if self._running:
            with contextlib.suppress(Exception):
                self._client.cancel([future for _, future, _, _ in self._running.values()], force=True)
            with contextlib.suppress(Exception):
                # One that is stopped would be waited for for ever.
                self._client.sync(self._client._run, jobs.end_all, callback_timeout=_STOP_S)
        self._running.clear()
