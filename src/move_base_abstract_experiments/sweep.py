"""All trials of an experiment: those that are complete stay, the others run; then the table is written."""
import contextlib
import importlib
import json
import os
import subprocess
import sys
import tarfile
import threading  # noqa: TID251 - of the client, whose threads are Dask's

from move_base_abstract.common.errors import ConfigurationError, SimulatorError

from .carrying import cluster, jobs
from .carrying.workers import told_workers
from .description import checks, launch_files, plan, spec
from .results import outputs, resumed, tables
from .results.progress import Progress
from .trials import trial


def run(path, output, workers, scheduler, stream=sys.stdout, folder=None, keep_old=False,
        has_dashboard=False):
    """Run what is missing of the experiment in a file; return how many trials failed, or differ when run again.

    folder: where relative paths in it start, if not where it lies. keep_old: complete trials of another program stay.
    has_dashboard: Dask's page on the workers is served, on 127.0.0.1.
    :raises SimulatorError: if it cannot be run. :raises KeyboardInterrupt: after all that was started has ended.
    """
    experiment = spec.read(path, folder)
    with open(path, 'rb') as source:
        text = source.read()
    chosen = plan.trials(experiment)
    if scheduler is None:
        check(experiment, chosen)
    with outputs.OutputFolder(output) as folder:
        about = plan.describe(experiment, chosen, text)
        missing = resumed.missing(experiment, chosen, folder, about, keep_old, stream)
        folder.write('experiment.yaml', text)
        folder.write_pieces('plan.json', tables.plan_text(about))
        try:
            _run_missing(experiment, chosen, missing, folder, (workers, scheduler, has_dashboard), stream)
        finally:
            told = tables.write(folder, about)
        return _tell(folder, told, stream)


def check(experiment, chosen):
    """Complain of a launch file or a function that cannot be used, before anything starts.

    :raises ConfigurationError: naming it.
    """
    with _asked_functions(experiment) as complain:
        seen = set()
        for one in chosen if experiment.launch else ():
            if one.replication == 0:  # the others have other seeds only
                job = jobs.make_job(experiment, one)
                key = (job['launch'], *job['arguments'])
                if key not in seen:
                    seen.add(key)
                    _check_launch(job)
        for name in experiment.inputs:
            if not os.path.isfile(os.path.join(experiment.folder, name)):
                raise ConfigurationError(f'inputs: there is no file {os.path.join(experiment.folder, name)}')
        complain()


_LOAD = """
import sys
from move_base_abstract_experiments.trials.functions import load
for key, name in zip(sys.argv[2::2], sys.argv[3::2]):
    try:
        load(name, sys.argv[1])
    except BaseException:
        print(f'{key}: {name}', flush=True)
        raise
"""


@contextlib.contextmanager
def _asked_functions(experiment):
    """Have a process load the experiment's functions meanwhile; gives a function that complains of what it found."""
    names = [(key, name) for key, name in (
        ('metrics', experiment.function), ('function', experiment.trial_function),
        ('prepare', experiment.prepare)) if name]
    if not names:
        yield lambda: None
        return
    words = [sys.executable, '-c', _LOAD, experiment.folder, *[word for pair in names for word in pair]]
    with subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:

        def complain():
            with contextlib.suppress(ImportError):
                importlib.import_module('distributed')  # which takes as long, and is needed next
            said, problem = process.communicate()
            if process.returncode:
                which = said.decode('utf-8', 'replace').strip().splitlines()
                last = problem.decode('utf-8', 'replace').strip().splitlines()
                raise ConfigurationError(f'{which[-1] if which else names[0][0]} cannot be used: '
                                         f'{last[-1] if last else "no text"}')
        try:
            yield complain
        finally:
            process.kill()


def _check_launch(job):
    from roslaunch.arg_dump import get_args

    from move_base_abstract_ros.launching import roles
    path = launch_files.find(job['launch'], job['folder'])
    declared = get_args([path])  # roslaunch itself takes no notice of others
    for word in job['arguments']:
        if word.partition(':=')[0] not in declared:
            raise checks.unknown('args: the argument', word.partition(':=')[0], declared)
    try:
        config = launch_files.read([(path, job['arguments'])])
    except ConfigurationError as error:
        raise ConfigurationError(f"launch, with {' '.join(job['arguments']) or 'no arguments'}: {error}") from None
    names = [roles.name_of(node) for node in config.nodes]
    for key in ('participants', 'leave_out'):
        for name in job[key] or ():
            if name not in names:
                raise checks.unknown(f'{key}: the node', name, names)


def _run_missing(experiment, chosen, missing, folder, where, stream):
    progress = Progress(stream, len(chosen), len(chosen) - len(missing))
    if not missing:
        return

    def done(job, worker, content, problem, attempts):
        progress.count(_taken(folder, job, worker, content, problem, attempts))
    workers, scheduler, has_dashboard = where
    with cluster.connected(min(workers, len(missing)), scheduler, has_dashboard) as (client, watch), \
            told_workers(folder) as tell:
        progress.begin(client, has_dashboard or scheduler is not None)
        threading.Thread(target=_import_report, name='report', daemon=True).start()

        def look(runner):
            progress.look(runner)
            tell(watch.told)
        shared = jobs.shared_of(experiment)
        cluster.Runner(client, watch, done, again, look, folder.together).run(
            (jobs.make_job(experiment, one, shared) for one in missing), len(missing))


def _taken(folder, job, worker, content, problem, attempts):
    """Put what a trial has left into its place, or why there is nothing; return trial.json's content.

    Whatever is wrong with one trial ends no other: only a disk that takes nothing more does.
    """
    if content is not None:
        try:
            return folder.put(content, worker, attempts)
        except (SimulatorError, OSError, EOFError, ValueError, LookupError, TypeError, AttributeError,
                tarfile.TarError) as error:
            problem = f'its outputs cannot be taken: {error}'
    about = failure(job, problem, attempts)
    with contextlib.suppress(ConfigurationError):  # somebody has put something into its folder, which stays as it is
        folder.put_failure(about)
    return about


def _import_report():
    """Import what the report needs, which takes a second, while the workers work."""
    with contextlib.suppress(Exception):  # whoever writes the report says what is missing
        for name in ('.report.command', 'matplotlib.backends.backend_agg', 'matplotlib.backends.backend_svg'):
            importlib.import_module(name, __package__)


def again(content, job):
    """Return the job that runs a trial once more whose outputs (None: there are none) say that it failed, or None."""
    if content is None:
        return job
    try:
        with outputs.opened(content) as archive:
            about = json.load(archive.extractfile(archive.next()))
        return None if about['status'] == trial.COMPLETE else {**job, 'crashed_before': about['crashes']}
    except (OSError, EOFError, ValueError, LookupError, TypeError, AttributeError, tarfile.TarError):
        return job


def failure(job, problem, attempts):
    """Return trial.json's content of a trial that has left nothing."""
    return {'format': trial.FORMAT, **{key: job[key] for key in ('id', 'configuration', 'replication', 'seed',
                                                                 'made_of', 'program')},
            'status': trial.FAILED, 'error': problem, 'metrics': {}, 'simulated_seconds': None, 'wall_seconds': None,
            'times_real_time': None, 'repeatable': False, 'labels': [], 'events': 0, 'log_sha256': None,
            'verified': None, 'difference': None, 'robots': {}, 'crashes': [], 'ends': [], 'worker': '',
            'attempts': attempts}


def _tell(folder, told, stream):
    """Say in a few lines what came out; return how many trials are not as they should be."""
    total = told.complete + told.failed_count + told.missing
    print(f'experiment: {told.complete} of {total} trials are complete'
          + (f'; run twice: {told.identical} identical, {told.different_count} different'
             if told.identical or told.different_count else ''), file=stream)
    for one in told.failed:
        print(f"  failed: {one['id']}: {one['error']}", file=stream)
    for one in told.different:
        print(f"  different: {one['id']}: {one['difference']}", file=stream)
    print(f'table: {os.path.join(str(folder.path), "trials.csv")}', file=stream, flush=True)
    return total - told.complete + told.different_count
