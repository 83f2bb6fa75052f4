"""Run one trial again on this computer, and compare: up to an instant, at a limited speed or in RViz, if wanted."""
from __future__ import annotations

import dataclasses
import os
import sys
from typing import List, NamedTuple, Optional, TextIO, Tuple

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.kinds import unknown
from move_base_abstract.runs import event_log, run_difference

from . import records
from .carrying import jobs
from .description import plan, spec
from .description.job import Job
from .description.trial import Trial
from .records import Plan, Result
from .results import outputs, resumption
from .trials import execution, termination
from .trials.run_folders import LOG

SAME, DIFFERENT, FAILED = 0, 1, 1
CHANGED = 3  # the trial is different or failed, and something on which it depends has changed


def rerun(output: str, name: str, until: float = 0.0, speed: float = 0.0, rviz: bool = False,
          logs: Optional[str] = None, stream: TextIO = sys.stdout) -> int:
    """Run a trial of an experiment's folder again; return the exit code.

    It is 0 if the trial is the same, and 1 if it is different or failed; then it is 3 instead if something on which the
    trial depends has changed. Such a change is printed first.

    output: the experiment's folder. name: the trial's ID, or the number at its beginning. until: the instant [s,
    simulated] at which it ends; 0: its own end. speed: the largest number of times real time; 0: no limit, or 1 with
    rviz. rviz: whether RViz shows it. logs: a new folder for the logs of this run, or None.
    :raises SimulatorError: if the trial cannot be run again.
    """
    folder = _folder_of(records.read_plan(output), output)
    one = _find(plan.trials(spec.read(os.path.join(output, 'experiment.yaml'), folder)), name)
    if logs is not None and os.path.lexists(logs):
        raise ConfigurationError(f'--logs: {logs} is there already; must be a new folder')
    was = records.read_trial(output, one.id)
    if was is None:
        raise _not_run(os.path.join(output, 'trials', one.id, 'trial.json'))
    since = resumption.changed_since(output, one, was)
    if since:
        print(f'rerun: {since} changed since the trial was recorded: the result shows the effect of the change, not '
              'whether the trial repeats', file=stream, flush=True)
    before = os.path.join(output, 'trials', one.id, LOG)
    if one.experiment.function:
        if until or speed or rviz:
            raise ConfigurationError('--until, --speed and --rviz are for launch files and commands; this trial is a '
                                     'function')
    elif not os.path.isfile(before):
        raise _not_run(before)
    left = _run(_job_of(one, until, speed, rviz), logs, stream)
    if left.result.error:
        print('rerun: {}{}'.format('' if left.result.is_complete else 'failed: ', left.result.error), file=stream)
    if not left.result.is_complete:
        code = FAILED
    elif one.experiment.function:
        code = _compare_function(left, before, was, stream)
    else:
        code = _compare(left, before, bool(until), stream)
    return CHANGED if since and code == DIFFERENT else code


def _job_of(trial: Trial, until: float, speed: float, rviz: bool) -> Job:
    experiment = trial.experiment
    if until:
        until = min(until, experiment.until.at or until)
        experiment = dataclasses.replace(experiment, until=dataclasses.replace(experiment.until, at=until))
    return jobs.make_job(dataclasses.replace(trial, experiment=experiment, verified_by=''),
                         speed_limit=speed or (1.0 if rviz else 0.0), onlooker=_rviz_words() if rviz else ())


def _not_run(path: str) -> ConfigurationError:
    return ConfigurationError(f'{path}: is not there; the trial has not run to its end')


def _folder_of(planned: Plan, output: str) -> str:
    return planned.provenance.get('folder') or os.path.abspath(output)


def _find(trials: List[Trial], name: str) -> Trial:
    for one in trials:
        if name == one.id or name == one.id.partition('-')[0] or name.isdecimal() and (
                int(name) == int(one.id.partition('-')[0])):
            return one
    raise unknown('TRIAL', name, [one.id for one in trials][:20])


def _rviz_words() -> Tuple[str, ...]:
    import shutil

    import rospkg
    path = shutil.which('rviz')
    if path is None:
        raise ConfigurationError('rviz is not on PATH; Debian has it as the package rviz (make deps-picture)')
    config = os.path.join(rospkg.RosPack().get_path('move_base_abstract'), 'rviz', 'simulator.rviz')
    return path, '-d', config  # without this file RViz shows no robots


class _Left(NamedTuple):
    """The outputs of a run of a trial. ``log``: the bytes of its event log, or None."""

    result: Result
    log: Optional[bytes]


def _run(job: Job, logs: Optional[str], stream: TextIO) -> _Left:
    trial = job.trial
    warm = jobs.WarmProcess()
    try:
        print(f'rerun: {trial.id} {trial.configuration}, seed {trial.seed}', file=stream, flush=True)
        content = warm.run(job) or b''
    finally:
        warm.close()
    with outputs.opened(content) as archive:
        if logs is not None:
            os.mkdir(logs)
            for member in outputs.checked_members(archive):
                with open(os.path.join(logs, member.name.replace('/', '_')), 'xb') as target:
                    target.write(outputs.opened_member(archive, member.name).read())
        return _Left(outputs.result_in(archive).judged_by(trial.experiment.primary), outputs.member(archive, LOG))


def _compare_function(left: _Left, before: str, was: Result, stream: TextIO) -> int:
    """Compare the metrics of a function with those before (``was``), and the event logs if it writes one."""
    had_log = os.path.isfile(before)
    difference = execution.other_metrics(was.metrics, left.result.metrics)
    if difference is None and (left.log is not None) != had_log:
        difference = f'an event log the {"first" if had_log else "second"} time only'
    if difference is not None:
        print(f'rerun: different: {difference}', file=stream)
        return DIFFERENT
    if had_log:
        return _compare(left, before, False, stream)
    print('rerun: the same trial, by its metrics' if was.metrics else
          'rerun: nothing to compare: the function gave no number and no event log', file=stream)
    return SAME


def _compare(left: _Left, before: str, is_part: bool, stream: TextIO) -> int:
    """Compare the event log with that before. is_part: whether it need only be the beginning of that one."""
    is_part = is_part and left.result.ended_by == termination.SECONDS  # otherwise it came to an end of its own
    with event_log.opened(before) as one:
        other = event_log.of_bytes(left.log or b'', LOG)
        found = event_log.compare(one, other)
    if found.identical or is_part and found.second is None:
        print(f'rerun: the same trial: {other.events} events' + (' up to there' if is_part else ''), file=stream)
        return SAME
    print(f'rerun: different: {run_difference.told_pair(found.first, found.second)}', file=stream)
    return DIFFERENT
