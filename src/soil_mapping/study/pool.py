"""Many trials side by side: as many at a time as there are cores; what is complete already is not run again."""

import sys
from multiprocessing import connection

from .running import POLL_S, RunningTrial, is_done, prepare


def path_of(folder, spec):
    """Return where the trial of a TrialSpec belongs in a study's folder (a Path)."""
    return folder / 'trials' / spec.name


def run_all(specs, folder, jobs, pictures=False, stream=sys.stderr):
    """Run those of the TrialSpecs that are not complete in the folder; return (spec, error text) of those that failed.

    jobs: how many at a time. A trial under load runs alone. :raises KeyboardInterrupt: after all children have ended.
    """
    missing = [spec for spec in specs if not is_done(spec, path_of(folder, spec))]
    if not missing:
        return []
    prepare(missing)
    progress = _make_progress(len(specs), len(specs) - len(missing), stream)
    running, failed = [], []
    try:
        while missing or running:
            while missing and _may_start(missing[0], running, jobs):
                spec = missing.pop(0)
                running.append(RunningTrial(spec, path_of(folder, spec), pictures))
            connection.wait([trial.sentinel for trial in running], POLL_S)
            for trial in [trial for trial in running if trial.poll() is not None]:
                running.remove(trial)
                progress.update()
                progress.set_postfix_str(trial.spec.name)
                if not trial.poll():
                    failed.append((trial.spec, trial.error))
    finally:
        for trial in running:
            trial.stop()
        progress.close()
    return failed


def _may_start(spec, running, jobs):
    if spec.load or any(trial.spec.load for trial in running):
        return not running
    return len(running) < jobs


def _make_progress(total, done, stream):
    from tqdm import tqdm
    tqdm.monitor_interval = 0  # its thread would be in the way of forking
    return tqdm(total=total, initial=done, unit='trial', file=stream, smoothing=0.1, dynamic_ncols=True)
