"""One trial again, here, and whether it is the same trial: in RViz, or up to an instant, if asked."""
import io
import json
import os
import sys
import tarfile

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.runs import event_log, run_difference
from move_base_abstract.runs.event_log import EventLog

from . import records
from .carrying import jobs, temporary
from .description import checks, plan, spec
from .results import outputs, resumed
from .trials import run, trial

SAME, DIFFERENT, FAILED = 0, 1, 1
CHANGED = 3  # it is different, and so is what it is made of


def rerun(output, name, until=0.0, speed=0.0, rviz=False, logs=None, stream=sys.stdout):
    """Run a trial of an experiment's folder again; return the exit code: 0 the same, 1 not, or it failed.

    It is 3 if the trial is not the same, and neither is what it is made of, which is said first.

    until: simulated s from its start, 0: to its own end. speed: at most so many times real time, 0: no limit.
    """
    known = records.read_plan(output)
    experiment = spec.read(os.path.join(output, 'experiment.yaml'))._replace(folder=_folder_of(known, output))
    one = _find(plan.trials(experiment), name)
    if logs is not None and os.path.lexists(logs):
        raise ConfigurationError(f'--logs: {logs} is there already; must be a new folder')
    was = records.read_trial(output, one.id)
    if was is None:
        raise _not_run(os.path.join(output, 'trials', one.id, 'trial.json'))
    since = resumed.changed_since(output, experiment, one, was)
    if since:
        print(f'rerun: {since} changed since the trial was recorded: what comes out says what that changes, not '
              'whether the trial repeats', file=stream, flush=True)
    code = _run_and_compare(output, experiment, one, was, (until, speed, rviz, logs), stream)
    return CHANGED if since and code == DIFFERENT else code


def _run_and_compare(output, experiment, one, was, options, stream):
    until, speed, rviz, logs = options
    if experiment.trial_function:
        if until or speed or rviz:
            raise ConfigurationError('--until, --speed and --rviz are of launch files and commands; a function runs as '
                                     'it is')
        job = jobs.make_job(experiment, one._replace(verified_by=''))
        return _compare_function(_run(job, logs, stream), os.path.join(output, 'trials', one.id), was, stream)
    if until:
        experiment = experiment._replace(until=experiment.until._replace(
            seconds=min(until, experiment.until.seconds or until)))
    before = os.path.join(output, 'trials', one.id, run.LOG)
    if not os.path.isfile(before):
        raise _not_run(before)
    job = jobs.make_job(experiment, one._replace(verified_by=''), speed_limit=speed or (1.0 if rviz else 0.0),
                        extra=_rviz_words() if rviz else ())
    return _compare(_run(job, logs, stream), before, bool(until), stream)


def _not_run(path):
    return ConfigurationError(f'{path}: is not there; the trial has not run to its end')


def _folder_of(known, output):
    return known['provenance'].get('folder') or os.path.abspath(output)


def _find(trials, name):
    for one in trials:
        if name == one.id or name == one.id.partition('-')[0] or name.isdecimal() and (
                int(name) == int(one.id.partition('-')[0])):
            return one
    raise checks.unknown('TRIAL', name, [one.id for one in trials][:20])


def _rviz_words():
    import shutil

    import rospkg
    path = shutil.which('rviz')
    if path is None:
        raise ConfigurationError('rviz is not on PATH; Debian has it as the package rviz (make deps-picture)')
    config = os.path.join(rospkg.RosPack().get_path('move_base_abstract'), 'rviz', 'simulator.rviz')
    return [path, '-d', config]  # without it RViz shows none of the robots


def _run(job, logs, stream):
    warm = jobs.WarmProcess()
    try:
        print(f"rerun: {job['id']} {job['configuration']}, seed {job['seed']}", file=stream, flush=True)
        content = warm.run(job)
    finally:
        warm.close()
    if logs is not None:
        os.mkdir(logs)
        with tarfile.open(fileobj=io.BytesIO(content), mode='r:*') as archive:
            for member in outputs.checked_members(archive):
                path = os.path.join(logs, member.name.replace('/', '_'))
                with open(path, 'xb') as target:
                    target.write(archive.extractfile(member).read())
    return content


def _compare_function(content, before, was, stream):
    """Compare what a function gave with what it gave before (``was``), and the event logs where it leaves any."""
    with tarfile.open(fileobj=io.BytesIO(content), mode='r:*') as archive:
        about, has_log = json.load(archive.extractfile('trial.json')), run.LOG in archive.getnames()
    had_log = os.path.isfile(os.path.join(before, run.LOG))
    if about['status'] != 'complete':
        print(f"rerun: failed: {about['error']}", file=stream)
        return FAILED
    difference = trial.other_metrics(was['metrics'], about['metrics'])
    if difference is None and has_log != had_log:
        difference = 'an event log the first time only' if had_log else 'an event log the second time only'
    if difference is not None:
        print(f'rerun: different: {difference}', file=stream)
        return DIFFERENT
    if has_log:
        return _compare(content, os.path.join(before, run.LOG), False, stream)
    print('rerun: the same trial, by its metrics', file=stream)
    return SAME


def _compare(content, before, is_part, stream):
    with tarfile.open(fileobj=io.BytesIO(content), mode='r:*') as archive, \
            temporary.folder('move_base_abstract_rerun_') as folder:
        about = json.load(archive.extractfile('trial.json'))
        if about['status'] != 'complete':
            print(f"rerun: failed: {about['error']}", file=stream)
            return FAILED
        path = os.path.join(folder, run.LOG)
        with open(path, 'wb') as target:
            target.write(archive.extractfile(run.LOG).read())
        difference, count = _difference(before, path, is_part)
    if difference is None:
        print(f'rerun: the same trial: {count} events' + (' up to there' if is_part else ''), file=stream)
        return SAME
    print(f'rerun: different: {difference}', file=stream)
    return DIFFERENT


def _difference(before, path, is_part):
    """Return (the first difference of two logs as text, or None; events read); a part need only be the beginning."""
    with event_log.open_text(before) as one, event_log.open_text(path) as other:
        old, count = iter(EventLog(one, before)), 0
        for event in EventLog(other, path):
            was = next(old, None)
            if was is None or was.compared != event.compared:
                return ' / '.join(run_difference.told_lines(each) if each else 'no more events'
                                  for each in (was, event)), count
            count += 1
        left = None if is_part else next(old, None)
        return (f'no more events after {count}, but {run_difference.told_lines(left)}' if left else None), count
