"""One trial in its own process: the run, the second run under another condition, the metrics, and the outputs.

carry_out() writes the outputs as an archive into the trial's folder (see bundle.py).
"""
from __future__ import annotations

import contextlib
import os
import re
import time
import traceback
from typing import TYPE_CHECKING, Any, Dict, List, Optional

from move_base_abstract.common.errors import ConfigurationError, SimulatorError
from move_base_abstract.common.input_files import sha256_of
from move_base_abstract.common.version import package_version
from move_base_abstract.lockstep.run_options import FAIL
from move_base_abstract.properties import Run, judgement_on
from move_base_abstract.runs import ends, error_lines, event_log, run_difference
from move_base_abstract.runs.calls import CallError, DeathError

from ..description import ingredients, launch_files, worker_files
from ..description.job import Job
from ..records import COMPLETE, DIFFERENT, IDENTICAL, Number, Result
from . import bundle, functions, metrics, run_folders, termination, user_metrics
from .run_folders import Folders
from .termination import RunError

if TYPE_CHECKING:
    from . import run

_ERROR_LINE = re.compile(
    r'^(?!Traceback|Exception in )\S*(Error|Exception)\b.*|.*\[ *(ERROR|FATAL)\].*|.*\bterminate called\b.*')
_STAMP = re.compile(r'\x1b\[[0-9;]*m|\[[0-9]+\.[0-9]+(, *[0-9.]+)?\]:? ?')
_LONGEST_ERROR = 300


def result_of(job: Job) -> Result:
    """Return the Result of a trial that has not run yet."""
    trial = job.trial
    return Result(trial.id, trial.configuration, trial.replication, trial.seed, made_of=job.made_of,
                  program=job.program)


def carry_out(job: Job, path: str, problem: Optional[str] = None) -> None:
    """Run the trial of a Job in an empty folder, and write its outputs there. An error goes into its trial.json.

    ``problem``: why the trial cannot be run, in one line; None: it can.
    """
    experiment, result, folders = job.trial.experiment, result_of(job), None
    result.ended_by = termination.ERROR
    try:
        _check_version(job)
        unsure = _check_files(job)
        if problem is not None:
            raise ConfigurationError(problem)
        folders = run_folders.make_folders(os.path.join(path, run_folders.RUN))
        (_call if experiment.function else _run_first)(job, folders, result)
        first = dict(result.metrics)  # without those that the user's function adds
        if experiment.metrics.function:
            _measure(job, folders, result)
        if job.trial.verified_by and not (experiment.function and result.labels):  # with labels, it may well differ
            _verify(job, path, folders, result, first)
        _check_files_again(job, result, unsure)
    except (SimulatorError, OSError) as error:
        result.error = _first_line(str(error), folders)
        result.ended_by = getattr(error, 'ended_by', None) or result.ended_by
    except Exception as error:
        traceback.print_exc()
        result.error = _first_line(f'{type(error).__name__}: {error}', folders)
    if result.is_complete and job.crashed_before:  # the run crashes sometimes, but this attempt did not
        result.labels = [*result.labels, f'its first attempt failed: {job.crashed_before[0]}']
        result.repeatable = False
    if not experiment.function:  # a function looks up programs in a process of its own
        launch_files.save_programs(path)
    try:
        bundle.pack(path, folders, experiment.record.files, result, has_all_logs=not result.is_complete)
    except Exception as error:
        traceback.print_exc()
        result.fail(f'its outputs cannot be packed: {type(error).__name__}: {error}'[:_LONGEST_ERROR])
        bundle.pack(path, None, (), result, has_all_logs=True)


def _check_version(job: Job) -> None:
    if job.common.version != package_version():
        raise ConfigurationError(f'move_base_abstract is {package_version()} on this worker, and '
                                 f'{job.common.version} where the experiment was started')


def _check_files(job: Job) -> List[str]:
    """Check that files are the same as when the experiment started; return labels for what cannot be decided."""
    ingredients.check(job.files)
    return worker_files.check(job)


def _check_files_again(job: Job, result: Result, unsure: List[str]) -> None:
    """Add the labels; check that no file has changed while the trial ran, otherwise the trial fails."""
    result.labels = result.labels + unsure
    try:
        ingredients.check(job.files)
    except ingredients.ChangedError as problem:
        result.fail(str(problem))
        raise


def _run_first(job: Job, folders: Folders, result: Result) -> None:
    from . import run  # needs ROS
    begin = time.monotonic()
    ended = run.run(job, folders)
    result.wall_seconds = round(time.monotonic() - begin, 6)
    result.error_lines = [one.told for one in error_lines.noted(folders.own)]
    _look_at_properties(job, result, ended.processes, folders)
    if ended.problem is not None:
        _judge(job, result, ended.processes, ends.read_log(folders.log), ended.problem)
    summary = _take_log(folders, result, ended.starts)
    result.metrics, result.simulated_seconds = {**summary.metrics, **result.metrics}, summary.simulated_seconds
    result.ended_by, result.open_goals = summary.ended_by, summary.open_goals
    _tell_speed(result)
    _judge(job, result, ended.processes, summary.log,
           RunError(f'the run was ended by a fault: {summary.reason}') if summary.by_fault else None)
    result.status = COMPLETE


def _look_at_properties(job: Job, result: Result, processes: List[ends.Process], folders: Folders) -> None:
    """Record which properties the run has broken, of those that the experiment names, if there is an event log."""
    names = job.trial.experiment.properties
    if not names:
        return
    with contextlib.suppress(OSError, event_log.EventLogError):
        found = ends.judge(processes, ends.read_log(folders.log))
        judged = judgement_on(Run(folders.log, found, names))
        result.properties = judged.told()
        result.metrics['broken_properties'] = len(judged.broken)


def _judge(job: Job, result: Result, processes: List[ends.Process], log: ends.Log,
           problem: Optional[SimulatorError] = None) -> None:
    """Record how the processes of a run ended.

    :raises RunError: if there is a problem, or a crash that the experiment does not allow.
    """
    found = ends.judge(processes, log)
    result.ends, result.crashes = [one.told for one in found], _crashes(found)
    result.labels = [*result.labels, *(f'{one.words}; it looks on' for one in found if one.crash and one.looks_on)]
    if result.crashes and job.trial.experiment.crashes == FAIL:
        more = f' (and {len(result.crashes) - 1} more)' if len(result.crashes) > 1 else ''
        raise RunError(result.crashes[0] + more + (f'; {problem}' if problem else ''), termination.CRASH)
    if problem is not None:
        raise problem


def _crashes(found: List[ends.End]) -> List[str]:
    """Return the texts of the crashes that make a trial incomplete: those of onlookers do not."""
    return ends.crashes(one for one in found if not one.looks_on)


def _take_log(folders: Folders, result: Result, starts: metrics.Starts) -> metrics.Summary:
    """Record what the event log of a run says; return its Summary."""
    summary = metrics.summarise(folders.log, starts)
    result.repeatable, result.labels, result.events = summary.repeatable, summary.labels, summary.events
    result.robots, result.waits, result.log_sha256 = summary.robots, summary.waits, sha256_of(folders.log)
    return summary


def _tell_speed(result: Result) -> None:
    if result.simulated_seconds is not None and result.wall_seconds is not None:
        result.times_real_time = round(result.simulated_seconds / max(result.wall_seconds, 1e-6), 3)


def _call(job: Job, folders: Folders, result: Result) -> None:
    """Run the trial that is a function."""
    begin = time.monotonic()
    try:
        answer = functions.run_trial(job, folders)
    except DeathError as error:
        died = ends.Process('the function', False, error.code, was_early=error.code is not None)
        _judge(job, result, [died], ends.Log(), RunError(
            str(error), termination.TIME_LIMIT if error.is_late else None))
        raise
    result.wall_seconds, result.repeatable = round(time.monotonic() - begin, 6), True
    log = ends.Log()
    if os.path.exists(folders.log):
        summary = _take_log(folders, result, {})
        result.simulated_seconds, log = summary.simulated_seconds, summary.log
    if answer.simulated_seconds is not None:
        result.simulated_seconds = answer.simulated_seconds
    result.labels, result.metrics = result.labels + answer.labels, dict(answer.metrics)
    result.ended_by, result.repeatable = termination.RETURNED, result.repeatable and not answer.labels
    _tell_speed(result)
    _judge(job, result, [ends.Process(**one) for one in answer.processes], log)
    result.status = COMPLETE


def _measure(job: Job, folders: Folders, result: Result) -> None:
    """Call the user's function for metrics. If it fails, the result gets an error; its run came to its end, though."""
    try:
        result.metrics.update(user_metrics.call(job, folders, result))
    except CallError as problem:
        result.error = f'metrics: {problem}'[:_LONGEST_ERROR]


def _verify(job: Job, path: str, folders: Folders, result: Result, first: Dict[str, Number]) -> None:
    """Run the trial a second time under another condition, with each node started as a program, and compare."""
    again = run_folders.make_folders(os.path.join(path, 'again'))
    try:
        if job.trial.experiment.function:
            found = functions.again(job, os.path.join(path, 'again', 'job'), again)
            result.difference = other_metrics(first, found.metrics) or compare(folders, again)
        else:
            from move_base_abstract_ros.launching.conditions import CONDITIONS

            from . import run
            condition = next(one for one in CONDITIONS if one.name == job.trial.verified_by)
            ended = run.run(job, again, condition)
            result.difference = compare(folders, again) or _other_end(result, ended, again)
    except SimulatorError as problem:
        result.difference = f'the second run did not come to its end: {_first_line(str(problem), again)}'
    if result.difference is None and not (job.trial.experiment.function and first) and _is_empty(folders):
        result.labels = [*result.labels, 'it ran twice, but there was nothing to compare: no metric, event, message '
                         'or bag']
        return
    result.verified = IDENTICAL if result.difference is None else DIFFERENT
    if result.difference is not None:
        result.difference = f'{job.trial.verified_by}: {result.difference}'


def _other_end(result: Result, ended: run.Ended, again: Folders) -> Optional[str]:
    """Return how the end of a second run differs from that of the first, although its events are the same; or None."""
    found = _crashes(ends.judge(ended.processes, ends.read_log(again.log)))
    if found != result.crashes:
        return ' / '.join(', '.join(one) or 'no crash' for one in (result.crashes, found))[:_LONGEST_ERROR]
    return None if ended.problem is None else str(ended.problem)


def other_metrics(first: Dict[str, Number], second: Dict[str, Number]) -> Optional[str]:
    """Return the first metric that differs between two calls of a function, with both values, or None.

    A metric that only one of the calls returned differs, too.
    """
    for name in sorted({*first, *second}):
        values = [one.get(name, 'none') for one in (first, second)]
        if values[0] != values[1]:
            return '{}: {!r} / {!r}'.format(name, *values)
    return None


def _is_empty(folders: Folders) -> bool:
    """Return whether a run has left nothing that compare() could compare."""
    if not os.path.exists(folders.log):
        return True
    with event_log.opened(folders.log) as log:
        return next(log.rows(), None) is None and not log.bags and not (
            os.path.exists(folders.messages) and os.path.getsize(folders.messages))


def compare(folders: Any, again: Folders) -> Optional[str]:
    """Return the first difference of two runs in one line, or None. A function without an event log has none."""
    has_log, has_again = (os.path.exists(one.log) for one in (folders, again))
    if has_log != has_again:
        return f'an event log the {"first" if has_log else "second"} time only'
    if not has_log:
        return None
    compared = run_difference.compare(folders.log, again.log)
    if compared.difference is not None:
        return run_difference.told_pair(compared.difference.first, compared.difference.second)[:_LONGEST_ERROR]
    if compared.bags is not None:
        return f'the bags of {compared.bags.node} differ (number {compared.bags.number} of them)'
    if os.path.exists(folders.messages) and sha256_of(folders.messages) != sha256_of(again.messages):
        return f'{run_folders.MESSAGES}: recorded messages differ'
    return None


def _first_line(text: str, folders: Optional[Folders]) -> str:
    """Return the first line of an error, with the first error in the nodes' outputs; without stamps of wall time."""
    line = text.strip().splitlines()[0] if text.strip() else 'no text'
    logs = folders.logs if folders is not None else ''
    for name in sorted(os.listdir(logs)) if logs else ():
        path = os.path.join(logs, name)
        # The ROS master's output has errors about nodes that have ended.
        if name.endswith('.txt') and name != 'rosmaster.txt' and bundle.is_plain(path) and os.access(path, os.R_OK):
            with open(path, encoding='utf-8', errors='replace') as stream:
                found = next((_STAMP.sub('', one).strip() for one in stream if _ERROR_LINE.match(one)), None)
            if found and found not in line:  # a function's error is in its own output, too
                return f'{line}; {name[:-len(".txt")]}: {found}'[:_LONGEST_ERROR]
    return line[:_LONGEST_ERROR]
