"""Run one launch file with chaos, each run with a seed of its own, on several warm processes."""
from __future__ import annotations

import concurrent.futures
import dataclasses
import hashlib
import json
import queue
from types import TracebackType
from typing import Any, Callable, Dict, Generator, Iterable, List, NamedTuple, Optional, Sequence, Tuple, Type

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.faults import buggify
from move_base_abstract.properties import Judgement
from move_base_abstract.runs.built_in import ALL

from ..carrying import jobs
from ..description import launch_files, plan, spec
from ..description.job import Job
from ..results import outputs
from ..trials.run_folders import LOG
from ..trials.run_plan import DECISIONS
from . import failures
from .variation import Variation

_NETWORK = '/time_master/network'  # a launch file's own
_TIME_LIMIT_S = 120.0  # wall, of a run
#: takes candidates; returns (the place of the first that fails, those of its names that occurred in its run), or None
Try = Callable[[List[List[str]]], Optional[Tuple[int, List[str]]]]


class RunRequest(NamedTuple):
    """What is to run. ``only``: the names of the decisions that are applied; None: all that the seed makes."""

    seed: int
    only: Optional[Tuple[str, ...]] = None


class RunResult(NamedTuple):
    """The result of a run.

    ``decisions``: [{'name', 'time_ns', 'what', 'says'}]; ``digest``: that of the event log, or ''.
    """

    chosen: RunRequest
    failure: Optional[failures.Failure]
    decisions: List[Dict[str, Any]]
    digest: str
    problem: str = ''  # why the run has left no outputs
    judged: Optional[Judgement] = None  # the run's properties


def document_of(path: str, arguments: Sequence[str], given: Dict[str, Any]) -> Dict[str, Any]:
    """Return a launch file, its ARG:=VALUE words and options of a run as the content of an experiment's file."""
    others = {key: value for key, value in given.items() if key != 'until'}
    return {'experiment': 'chaos', 'launch': path, 'args': dict(word.split(':=', 1) for word in arguments),
            'until': {'idle': True, **({'at': given['until']} if given.get('until') else {})},
            'time_limit': _TIME_LIMIT_S, 'record': {'files': [DECISIONS]}, **others}


class Runs:
    """Runs on several warm processes; a context manager. ``wanted``: the names of failures that count; empty: all."""

    def __init__(self, document: Dict[str, Any], folder: str, workers: int, variation: Variation,
                 wanted: Sequence[str]) -> None:
        self._wanted = wanted
        trial, = plan.trials(spec.checked(document, folder))
        config, options = launch_files.with_options(trial)
        launch_files.check_programs(config, options)
        self.variation = dataclasses.replace(variation, has_network=bool(trial.network) or _NETWORK in config.params)
        self._job = jobs.make_job(trial)
        self._idle: Any = queue.LifoQueue()  # of warm processes, and of None for each that was not needed yet
        self._all: List[jobs.WarmProcess] = []
        for _ in range(workers):
            self._idle.put(None)
        # These threads only wait; this process does not fork.
        self._pool = concurrent.futures.ThreadPoolExecutor(workers)
        self._workers = workers
        self._is_over = False
        self.count = 0

    def __enter__(self) -> Runs:
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self._is_over = True  # a thread that loses its process now does not start another one
        for warm in list(self._all):
            warm.close()
        self._pool.shutdown()

    def each(self, chosen: Iterable[RunRequest]) -> Generator[RunResult, None, None]:
        """Yield the result of each run, in the order given. As many run at the same time as there are processes."""
        ahead: List[Any] = []  # Futures of RunResult
        waiting = iter(chosen)
        try:
            while True:
                while len(ahead) < 2 * self._workers:
                    one = next(waiting, None)
                    if one is None:
                        break
                    ahead.append(self._pool.submit(self._run, one))
                if not ahead:
                    return
                self.count += 1
                yield ahead.pop(0).result()
        finally:
            for future in ahead:
                future.cancel()

    def one(self, chosen: RunRequest) -> RunResult:
        """Return the result of one run."""
        return next(self.each([chosen]))

    def shrunk(self, found: RunResult) -> RunResult:
        """Return the result of a run with as few of the decisions of ``found`` as still fail in the same way.

        If its ``failure`` is None, the run is not repeatable.
        """
        failure = found.failure
        assert failure is not None
        def first_failing(candidates: List[List[str]]) -> Optional[Tuple[int, List[str]]]:
            told = self.each(RunRequest(found.chosen.seed, tuple(names)) for names in candidates)
            for number, one in enumerate(told):
                if one.failure is not None and one.failure.name == failure.name:
                    return number, [decision['name'] for decision in one.decisions]
            return None
        left = ddmin([decision['name'] for decision in found.decisions], first_failing)
        return self.one(RunRequest(found.chosen.seed, tuple(left)))

    def _run(self, chosen: RunRequest) -> RunResult:
        warm = self._idle.get() or self._started()
        try:
            content = warm.run(self._job_of(chosen)) or b''
        except (jobs.TrialError, jobs.WorkerError) as problem:
            if isinstance(problem, jobs.WorkerError) and not self._is_over:
                warm.close()
                self._all.remove(warm)
                warm = None
            return RunResult(chosen, failures.Failure('unfinished', str(problem)), [], '', str(problem))
        finally:
            self._idle.put(warm)
        with outputs.opened(content) as archive:
            result, log = outputs.result_in(archive), outputs.member(archive, LOG)
            decisions = outputs.member(archive, 'files-' + DECISIONS)
        if log is None and result.error and not result.crashes:
            raise ConfigurationError(result.error)
        evidence = failures.evidence_of(result, log, self._job.trial.experiment.properties or (ALL,))
        made = [*[json.loads(line) for line in (decisions or b'').splitlines()], *buggify.decisions(evidence.events)]
        return RunResult(chosen, failures.of_run(evidence, self._wanted),
                         sorted(made, key=lambda one: int(one['time_ns'])),
                         hashlib.sha256(log).hexdigest() if log is not None else '', judged=evidence.judged)

    def _started(self) -> jobs.WarmProcess:
        """Start a warm process, when it is needed for the first time."""
        warm = jobs.WarmProcess()
        self._all.append(warm)
        return warm

    def _job_of(self, chosen: RunRequest) -> Job:
        trial = self._job.trial
        only = () if chosen.only is None else chosen.only or ('none',)
        delay, starts = self.variation.of(chosen.seed)
        experiment = dataclasses.replace(trial.experiment, chaos_seed=chosen.seed, chaos_delay=delay,
                                         chaos_starts=starts, chaos_only=only if chosen.seed else ())
        return dataclasses.replace(self._job, trial=dataclasses.replace(trial, experiment=experiment))


def ddmin(names: Sequence[str], first_failing: Try) -> List[str]:
    """Return some of the names that still fail together, and of which none can be left out by itself.

    first_failing: finds the first of several candidates that fails, in their order. It may try several at once.
    """
    left, parts = list(names), 2
    while left:
        parts = min(parts, len(left))
        chunks = [left[k * len(left) // parts:(k + 1) * len(left) // parts] for k in range(parts)]
        candidates = chunks if parts > 1 else []
        others = [[name for name in left if name not in set(chunk)] for chunk in chunks]
        candidates = candidates + (others if parts != 2 else [])
        found = first_failing(candidates)
        if found is not None:
            number, there = found
            kept = set(there)
            left = [name for name in candidates[number] if name in kept]
            parts = 2 if number < len(chunks) and parts > 1 else max(2, parts - 1)
        elif parts >= len(left):
            break
        else:
            parts *= 2
    return left
