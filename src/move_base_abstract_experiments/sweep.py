"""Run the trials of an experiment that are not complete, then write the table of all trials."""
from __future__ import annotations

import contextlib
import dataclasses
import importlib
import os
import subprocess
import sys
import tarfile
import threading
from typing import Any, Callable, Dict, Iterator, List, Optional, Set, TextIO, Tuple

from move_base_abstract.common.errors import ConfigurationError, SimulatorError
from move_base_abstract.common.kinds import unknown
from move_base_abstract.common.options import words_of
from move_base_abstract.common.shown import pasted, shown_text

from .carrying import cluster, jobs, warm_ros
from .carrying.workers import workers_file
from .description import launch_files, plan, spec
from .description.experiment import Experiment
from .description.job import Job
from .description.trial import Trial
from .records import Result
from .results import outputs, resumption, tables
from .results.progress import Progress
from .trials import execution


def run(path: str, output: str, workers: int, scheduler: Optional[str], stream: TextIO = sys.stdout,
        folder: Optional[str] = None, keep_old: bool = False, has_dashboard: bool = False,
        given: Optional[Dict[str, Any]] = None) -> int:
    """Run the missing trials of the experiment in a file; return the number of bad trials of all.

    Bad are trials that are not complete, have an error, or were different when they ran a second time.

    output: the folder of the experiment. workers: the number of processes on this computer. scheduler: the address of a
    running Dask scheduler instead, or None. folder: where relative paths in the file start; None: in its own folder.
    keep_old: whether complete trials of another program stay. has_dashboard: whether Dask's page about the workers is
    served on 127.0.0.1. given: {key: value} from the command line, which change the
    file's.
    :raises SimulatorError: if it cannot be run. :raises KeyboardInterrupt: on Ctrl-C, after everything has ended.
    """
    experiment = spec.read(path, folder, given)
    with open(path, 'rb') as source:
        text = source.read()
    if given:
        text = spec.changed_text(text, given)
    chosen = plan.trials(experiment)
    if scheduler is None:
        for note in check(experiment, chosen):
            print(f'experiment: note: {note}', file=stream, flush=True)
    with outputs.OutputFolder(output) as out:
        planned = plan.describe(experiment, chosen, text)
        missing, count = resumption.missing(chosen, out, planned, keep_old, stream), len(chosen)
        del chosen  # so that nothing of a trial that has ended stays in memory, except its entry in the plan
        out.write('experiment.yaml', text)
        out.write_pieces('plan.json', tables.plan_text(planned))
        try:
            _run_missing(count, missing, out, (workers, scheduler, has_dashboard), stream)
        finally:
            summary = tables.write(out, planned)
        return _tell(out, summary, stream)


def check(experiment: Experiment, chosen: List[Trial]) -> List[str]:
    """Check the launch file, functions and inputs of an experiment before anything starts. Return notes for the user.

    :raises ConfigurationError: naming what cannot be used.
    """
    if not (experiment.function or warm_ros.is_there()):
        raise ConfigurationError(f"'{experiment.system}' needs ROS, which is not installed; without ROS a trial must "
                                 "be a 'function'")
    notes: Dict[str, str] = {}
    with _asked_functions(experiment) as complain:
        seen: Set[Tuple[str, ...]] = set()
        for one in chosen if experiment.launch else ():
            key = (one.launch, *one.arguments, *words_of(one.run_options))
            if one.replication == 0 and key not in seen:  # other replications differ only in their seeds
                seen.add(key)
                _check_launch(one, notes)
        for name in experiment.inputs:
            if not os.path.isfile(os.path.join(experiment.folder, name)):
                raise ConfigurationError(f'inputs: there is no file {os.path.join(experiment.folder, name)}')
        complain()
    return list(filter(None, notes.values()))


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
def _asked_functions(experiment: Experiment) -> Iterator[Callable[[], None]]:
    """Let another process load the experiment's functions meanwhile.

    The context is a function that waits for the process, and raises ConfigurationError if one cannot be loaded.
    """
    names = list(experiment.functions.items())
    if not names:
        yield lambda: None
        return
    words = [sys.executable, '-c', _LOAD, experiment.folder, *[word for pair in names for word in pair]]
    with subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:

        def complain() -> None:
            with contextlib.suppress(ImportError):
                importlib.import_module('distributed')  # it takes as long, and is needed next
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


def _check_launch(trial: Trial, notes: Dict[str, str]) -> None:
    """Check a trial's launch file. Add a note for the user to ``notes`` for each kind of node, '' if there is none."""
    from roslaunch.arg_dump import get_args

    from move_base_abstract_ros.launching import roles
    from move_base_abstract_ros.launching.command_line import of_adopted
    experiment = trial.experiment
    path = launch_files.find(trial.launch, experiment.folder)
    # roslaunch ignores arguments that are not declared. It cannot list the declared ones if packages are missing.
    is_tolerant = experiment.adopt or experiment.tolerant
    declared = launch_files.arguments_of(path) if is_tolerant else get_args([path])
    for name in experiment.args:
        if name not in declared:
            raise unknown('args: the argument', name, declared)
    config, options = launch_files.with_options(trial)
    if experiment.adopt:
        notes.setdefault('adopt', of_adopted(trial.run_options, [path, *trial.arguments]))
    names = [roles.name_of(node) for node in config.nodes]
    for key, nodes in (('participants', experiment.participants or ()), ('participant', experiment.participant),
                       ('onlooker', experiment.onlooker), ('leave_out', experiment.leave_out)):
        for name in nodes:
            if name not in names:
                raise unknown(f'{key}: the node', name, names)
    for node, name in zip(config.nodes, names):
        kind = roles.kind_of(node)
        if kind not in notes and name not in experiment.leave_out and kind not in experiment.replace:
            notes[kind] = roles.choice_of_program(node)
    launch_files.check_programs(config, options)


def _run_missing(count: int, missing: List[Trial], folder: outputs.OutputFolder,
                 where: Tuple[int, Optional[str], bool], stream: TextIO) -> None:
    """Run the trials of a list, and leave the list empty. ``count``: the number of all planned trials."""
    progress = Progress(stream, count, count - len(missing))
    if not missing:
        return

    def done(job: Job, worker: str, content: Optional[bytes], problem: Optional[str], attempts: int) -> None:
        progress.count(_taken(folder, job, worker, content, problem, attempts))
    workers, scheduler, has_dashboard = where
    with cluster.connected(min(workers, len(missing)), scheduler, has_dashboard) as (client, watch), \
            workers_file(folder) as tell:
        progress.begin(client, has_dashboard or scheduler is not None)
        threading.Thread(target=_import_report, name='report', daemon=True).start()

        def look(runner: cluster.Runner) -> None:
            progress.look(runner)
            tell(watch.known)
        common = jobs.common_of(missing[0].experiment)
        missing.reverse()
        cluster.Runner(client, watch, done, again, look, folder.together).run(
            (jobs.make_job(missing.pop(), common) for _ in range(len(missing))), len(missing))


def _taken(folder: outputs.OutputFolder, job: Job, worker: str, content: Optional[bytes], problem: Optional[str],
           attempts: int) -> Result:
    """Put the outputs of a trial into its folder, or the reason why there are none; return its Result.

    An error of one trial does not end the others, except if the disk is full.
    """
    if content is not None:
        try:
            return folder.put(content, worker, attempts).judged_by(job.trial.experiment.primary)
        except (SimulatorError, OSError, EOFError, ValueError, LookupError, TypeError, AttributeError,
                tarfile.TarError) as error:
            problem = f'its outputs cannot be taken: {error}'
    result = dataclasses.replace(execution.result_of(job), error=problem, attempts=attempts)
    with contextlib.suppress(ConfigurationError):  # its folder holds files of somebody else, which stay
        folder.put_failure(result)
    return result


def _import_report() -> None:
    """Import the modules that the report needs while the workers work; it takes a second."""
    with contextlib.suppress(Exception):  # if something is missing, the report says so
        for name in ('.report.command', 'matplotlib.backends.backend_agg', 'matplotlib.backends.backend_svg'):
            importlib.import_module(name, __package__)


def again(content: Optional[bytes], job: Job) -> Optional[Job]:
    """Return the job that runs a failed trial once more, or None if the trial is complete.

    content: the outputs of its first attempt, None if there are none. They name what crashed.
    """
    if content is None:
        return job
    try:
        with outputs.opened(content) as archive:
            result = outputs.result_in(archive)
        return None if result.is_complete else dataclasses.replace(job, crashed_before=tuple(result.crashes))
    except (SimulatorError, OSError, EOFError, ValueError, LookupError, TypeError, AttributeError, tarfile.TarError):
        return job


def _tell(folder: outputs.OutputFolder, told: tables.Summary, stream: TextIO) -> int:
    """Print the results in a few lines; return the number of bad trials, as run() says; some may count twice."""
    total = told.complete + told.failed_count + told.missing
    print(f'experiment: {told.complete} of {total} trials are complete'
          + (f'; run twice: {told.identical} identical, {told.different_count} different'
             if told.identical or told.different_count else ''), file=stream)
    for one in told.failed:
        print(f'  failed: {one.id}: {one.error}', file=stream)
    for one in told.different:
        print(f'  different: {one.id}: {one.difference}', file=stream)
    for one in [*told.failed, *told.different][:1]:
        print(f'next: the first of them again: rosrun move_base_abstract experiment rerun '
              f'{pasted(str(folder.path))} {one.id}', file=stream)
    for line in (*told.errors.lines(total - told.missing), *map(shown_text, told.properties.lines())):
        print(f'  {line}', file=stream)
    print(f'table: {os.path.join(str(folder.path), "trials.csv")}', file=stream, flush=True)
    return total - told.complete + told.different_count + told.errors.count
