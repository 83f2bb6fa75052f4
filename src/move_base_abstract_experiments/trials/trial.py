"""One trial in its own process: the run, the run under another condition, the metrics, and what goes back.

carry_out() leaves an archive in the trial's folder (see bundle.py).
"""
import os
import re
import time
import traceback

from move_base_abstract.common.errors import ConfigurationError, SimulatorError
from move_base_abstract.runs import run_difference
from move_base_abstract_ros.launching import ends

from ..description import elsewhere, ingredients, launch_files, plan, spec
from . import bundle, ended_by, functions, metrics, run, run_folders, user_metrics

FORMAT = 1
COMPLETE, FAILED = 'complete', 'failed'
IDENTICAL, DIFFERENT = 'identical', 'different'
_ERROR_LINE = re.compile(
    r'^(?!Traceback|Exception in )\S*(Error|Exception)\b.*|.*\[ *(ERROR|FATAL)\].*|.*\bterminate called\b.*')
_STAMP = re.compile(r'\x1b\[[0-9;]*m|\[[0-9]+\.[0-9]+(, *[0-9.]+)?\]:? ?')
_LONGEST_ERROR = 300


def carry_out(job, path, problem=None):
    """Run the trial of a job (see jobs.py) in an empty folder. ``problem``: why it cannot be run, in a line."""
    about = {'format': FORMAT, 'id': job['id'], 'configuration': job['configuration'],
             'replication': job['replication'], 'seed': job['seed'], 'status': FAILED, 'error': None, 'metrics': {},
             'simulated_seconds': None, 'wall_seconds': None, 'times_real_time': None, 'repeatable': False,
             'labels': [], 'events': 0, 'log_sha256': None, 'verified': None, 'difference': None, 'robots': {},
             'ended_by': ended_by.ERROR, 'open_goals': None, 'crashes': [], 'ends': [],
             'made_of': job['made_of'], 'program': job['program']}
    folders = None
    try:
        _check_version(job)
        unsure = _check_files(job)
        if problem is not None:
            raise ConfigurationError(problem)
        folders = run_folders.make_folders(os.path.join(path, run_folders.RUN))
        (_call if job['trial_function'] else _run_first)(job, folders, about)
        first = dict(about['metrics'])  # without those that the user's function adds
        if job['function']:
            _measure(job, folders, about)
        if job['verified_by'] and not (job['trial_function'] and about['labels']):  # it says that it would differ
            _verify(job, path, folders, about, first)
        _check_files_again(job, about, unsure)
    except (SimulatorError, OSError) as error:
        about['error'] = _first_line(str(error), folders)
        about['ended_by'] = ended_by.of_error(str(error), about['ended_by'])
    except Exception as error:
        traceback.print_exc()
        about['error'] = _first_line(f'{type(error).__name__}: {error}', folders)
    if about['status'] == COMPLETE and job.get('crashed_before'):  # it is one of those that came through
        about['labels'] = [*about['labels'], f"its first attempt failed: {job['crashed_before'][0]}"]
        about['repeatable'] = False
    if not job['trial_function']:  # what that looks up, it looks up in a process of its own
        launch_files.save_programs(path)
    try:
        bundle.pack(path, folders, job['record'][1], about, has_all_logs=about['status'] != COMPLETE)
    except Exception as error:
        traceback.print_exc()
        text = f'its outputs cannot be packed: {type(error).__name__}: {error}'
        about.update(status=FAILED, error=text[:_LONGEST_ERROR])
        bundle.pack(path, None, (), about, has_all_logs=True)


def wanted_of(job):
    """Return the run.Wanted of a job."""
    files = [(launch_files.find(job['launch'], job['folder']), job['arguments'])] if job['launch'] else []
    participants = job['participants']
    return run.Wanted(files=files, command=tuple(job['command']),
                      participants=None if participants is None else tuple(participants),
                      leave_out=tuple(job['leave_out']),
                      replace=tuple((tuple(old.split('/')), tuple(new.split('/'))) for old, new in job['replace']),
                      seed=job['seed'], sleep=job['sleep'], until=spec.Until(*job['until']),
                      record=spec.Record(*job['record']), time_limit=job['time_limit'], is_warm=job['is_warm'],
                      speed_limit=job.get('speed_limit', 0.0), lookahead=job.get('lookahead', 0.0),
                      cores=job.get('cores', ''), stored_topics=tuple(job.get('stored_topics', ())),
                      extra=tuple(job.get('extra', ())))


def _check_version(job):
    if job['version'] != plan.package_version():
        raise ConfigurationError(f"move_base_abstract is {plan.package_version()} on this worker, and "
                                 f"{job['version']} where the experiment was started; allowed: the same")


def _check_files(job):
    """Complain of files that are others than when the experiment started; return labels for what is unsure."""
    ingredients.check(job['files'])
    return elsewhere.check(job)


def _check_files_again(job, about, unsure):
    """Complain of files that have changed while the trial ran; add the labels."""
    about['labels'] = about['labels'] + unsure
    try:
        ingredients.check(job['files'])
    except ingredients.ChangedError:
        about['status'] = FAILED
        raise


def _run_first(job, folders, about):
    begin = time.monotonic()
    ended = run.run(wanted_of(job), folders)
    about['wall_seconds'] = round(time.monotonic() - begin, 6)
    if ended.problem is not None:
        _judge(job, about, ended.processes, ends.read_log(os.path.join(folders.own, run.LOG)), ended.problem)
    summary = _take_log(folders, about, ended.starts)
    about.update(metrics=dict(summary.metrics), simulated_seconds=summary.simulated_seconds,
                 ended_by=ended_by.of_run(summary.reason, summary.by_fault), open_goals=summary.open_goals)
    _tell_speed(about)
    _judge(job, about, ended.processes, summary.ends,
           f'the run was ended by a fault: {summary.reason}' if summary.by_fault else None)
    about['status'] = COMPLETE


def _judge(job, about, processes, log, problem=None):
    """Tell how the processes of a run ended.

    :raises RunError: for a problem, and for a crash that the experiment does not allow.
    """
    found = ends.judge(processes, log)
    about.update(ends=[one.told for one in found], crashes=ends.crashes(found))
    if about['crashes'] and job['crashes'] == ends.FAIL:
        about['ended_by'] = ended_by.CRASH
        more = f" (and {len(about['crashes']) - 1} more)" if len(about['crashes']) > 1 else ''
        raise run.RunError(about['crashes'][0] + more + (f'; {problem}' if problem else ''))
    if problem is not None:
        raise run.RunError(problem)


def _take_log(folders, about, starts):
    """Tell what the event log of a run says; return its Summary."""
    log = os.path.join(folders.own, run.LOG)
    summary = metrics.summarise(log, starts)
    about.update(repeatable=summary.repeatable, labels=summary.labels, events=summary.events, robots=summary.robots,
                 log_sha256=metrics.digest(log))
    return summary


def _tell_speed(about):
    if about['simulated_seconds'] is not None:
        about['times_real_time'] = round(about['simulated_seconds'] / max(about['wall_seconds'], 1e-6), 3)


def _call(job, folders, about):
    """Run the trial that is a function."""
    begin = time.monotonic()
    try:
        answer = functions.run_trial(job, folders)
    except functions.DeathError as error:
        about['ended_by'] = ended_by.TIME_LIMIT if error.is_late else about['ended_by']
        died = error.code is not None
        _judge(job, about, [ends.Process('the function', False, error.code, was_early=died)], ends.Log(), str(error))
        raise
    about['wall_seconds'] = round(time.monotonic() - begin, 6)
    about['repeatable'] = True
    log = ends.Log()
    if os.path.exists(os.path.join(folders.own, run.LOG)):
        summary = _take_log(folders, about, {})
        about['simulated_seconds'], log = summary.simulated_seconds, summary.ends
    if answer['simulated_seconds'] is not None:
        about['simulated_seconds'] = answer['simulated_seconds']
    about['labels'] = about['labels'] + answer['labels']
    about.update(metrics=answer['metrics'], ended_by=ended_by.RETURNED,
                 repeatable=about['repeatable'] and not answer['labels'])
    _tell_speed(about)
    _judge(job, about, [ends.Process(**one) for one in answer['processes']], log)
    about['status'] = COMPLETE


def _measure(job, folders, about):
    """Call the user's function; what is wrong with it is told and stops nothing."""
    found, problem = user_metrics.call(job, folders, about)
    about['metrics'].update(found)
    if problem is not None:
        about['error'] = f"metrics {job['function']}: {problem}"[:_LONGEST_ERROR]


def _verify(job, path, folders, about, first):
    """Run once more under another condition, each node started as a program, and compare."""
    again = run_folders.make_folders(os.path.join(path, 'again'))
    try:
        if job['trial_function']:
            found = functions.again(job, os.path.join(path, 'again', 'job.json'), again)
            about['difference'] = other_metrics(first, found['metrics']) or compare(folders, again)
        else:
            from move_base_abstract_ros.launching.conditions import CONDITIONS
            condition = next(one for one in CONDITIONS if one.name == job['verified_by'])
            ended = run.run(wanted_of(job)._replace(condition=condition, is_warm=False), again)
            about['difference'] = compare(folders, again) or _other_end(about, ended, again)
    except SimulatorError as problem:
        about['difference'] = f'the second run did not come to its end: {_first_line(str(problem), again)}'
    about['verified'] = IDENTICAL if about['difference'] is None else DIFFERENT
    if about['difference'] is not None:
        about['difference'] = f"{job['verified_by']}: {about['difference']}"


def _other_end(about, ended, again):
    """Return in which way a second run that went the same way did not end in the same one, or None."""
    found = ends.crashes(ends.judge(ended.processes, ends.read_log(os.path.join(again.own, run.LOG))))
    if found != about['crashes']:
        return ' / '.join(', '.join(one) or 'no crash' for one in (about['crashes'], found))[:_LONGEST_ERROR]
    return ended.problem


def other_metrics(first, second):
    """Return which of the metrics that a function gave twice is another one, or there once only, or None."""
    for name in sorted({*first, *second}):
        values = [one.get(name, 'none') for one in (first, second)]
        if values[0] != values[1]:
            return '{}: {!r} / {!r}'.format(name, *values)
    return None


def compare(folders, again):
    """Return where two runs differ, in a line, or None."""
    if not os.path.exists(os.path.join(folders.own, run.LOG)):
        return None
    compared = run_difference.compare(os.path.join(folders.own, run.LOG), os.path.join(again.own, run.LOG))
    if compared.difference is not None:
        return ' / '.join(run_difference.told_lines(event) if event else 'no more events'
                          for event in (compared.difference.first, compared.difference.second))[:_LONGEST_ERROR]
    if compared.bags is not None:
        return f'the bags of {compared.bags.node} differ (number {compared.bags.number} of them)'
    first, second = (os.path.join(one.own, run.MESSAGES) for one in (folders, again))
    if os.path.exists(first) and metrics.digest(first) != metrics.digest(second):
        return f'{run.MESSAGES}: recorded messages differ'
    return None


def _first_line(text, folders):
    """Return the first line of an error, with the first error line of the nodes' outputs, without wall times."""
    line = text.strip().splitlines()[0] if text.strip() else 'no text'
    for name in sorted(os.listdir(folders.logs)) if folders is not None else ():
        path = os.path.join(folders.logs, name)
        # The master's complains of who has gone.
        if name.endswith('.txt') and name != 'rosmaster.txt' and bundle.is_plain(path) and os.access(path, os.R_OK):
            with open(path, encoding='utf-8', errors='replace') as stream:
                found = next((_STAMP.sub('', one).strip() for one in stream if _ERROR_LINE.match(one)), None)
            if found and found not in line:  # of a function the error is what it has printed itself
                return f'{line}; {name[:-len(".txt")]}: {found}'[:_LONGEST_ERROR]
    return line[:_LONGEST_ERROR]
