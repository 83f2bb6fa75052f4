"""Call functions of users in processes of their own; and run trials that are such a function instead of a ROS graph.

A function that is a trial may be a simulation in plain Python. It may also start processes; they are all ended when the
function has returned.
"""
from __future__ import annotations

import contextlib
import dataclasses
import hashlib
import importlib
import importlib.machinery
import json
import math
import os
import pickle
import random
import re
import signal
import sys
import threading
from pathlib import Path
from typing import Any, Callable, Dict, Iterable, List, NamedTuple, Optional

from move_base_abstract.common import processes
from move_base_abstract.common.errors import ConfigurationError, SimulatorError
from move_base_abstract.common.shown import shown
from move_base_abstract.runs.calls import CallError, call, described
from move_base_abstract.runs.failures import words_of

from ..description.experiment import OWN_COLUMNS, Experiment
from ..description.job import Job
from ..description.trial import Trial
from . import run_folders

LOOPBACK = 'move_base_abstract_experiments.carrying.warm_loopback'  # imported if a function starts nodes with it
_NUMPY = 'numpy.random'
_MOST_BYTES = 1 << 20
_MOST_METRICS = 200
_MOST_LABELS = 100
_LONGEST_LABEL = 200
_LARGEST = int(sys.float_info.max)
_NAME = re.compile(r'[A-Za-z]\w{0,63}\Z', re.ASCII)


class FunctionTrial:
    """The argument of a function that is a trial; see docs/experiments.md.

    configuration: {factor: value}; replication, seed: whole numbers; args: the experiment's args, filled in; files: a
    Path, the function's working folder; event_log: a Path at which it may write an event log. The function may set
    simulated_seconds.
    """

    def __init__(self, trial: Trial, folders: run_folders.Folders) -> None:
        self.configuration = trial.configuration
        self.replication = trial.replication
        self.seed = trial.seed
        self.args = trial.function_arguments
        self.files = Path(folders.files)
        self.event_log = Path(folders.own) / run_folders.LOG
        self.simulated_seconds: Any = None
        self.labels: List[Any] = []

    def not_repeatable(self, reason: str) -> None:
        """Record a reason why the same seed may give another result. The report shows it as a label."""
        self.labels.append(reason)


class Returned(NamedTuple):
    """The result of a trial that is a function.

    ``processes``: the fields of ends.Process, for its own process and for nodes that it started.
    """

    metrics: Dict[str, Optional[float]]
    labels: List[str]
    simulated_seconds: Optional[float]
    processes: List[Dict[str, Any]]


def sources(names: Iterable[str], folder: str) -> Dict[str, str]:
    """Return {path from the folder: text} of those modules of functions that are beside the experiment's file.

    They are sent with a trial, because the worker may not have the folder. A package is sent with all its modules.
    """
    found = {}
    for name in names:
        module = name.partition(':')[0]
        for path in _modules_beside(module.partition('.')[0], folder):
            with contextlib.suppress(OSError, ValueError), open(os.path.join(folder, path), encoding='utf-8') as stream:
                found[path] = stream.read(_MOST_BYTES)
    return found if sum(map(len, found.values())) < _MOST_BYTES else {}


def _modules_beside(name: str, folder: str) -> List[str]:
    """Return the paths, from the folder, of the module or package with this name, by the rules of Python's import."""
    alone = f'{name}.py'
    if os.path.isfile(os.path.join(folder, alone)) and not os.path.isfile(os.path.join(folder, name, '__init__.py')):
        return [alone]
    return [os.path.relpath(path, folder) for path in sorted(Path(folder, name).rglob('*.py'))]


def place(job: Job, folder: str) -> Job:
    """Return the job with the folder in which its modules are found.

    That is the folder of the experiment, if it holds the same modules here. Otherwise they are written into a new
    folder below ``folder``.
    """
    beside, texts = job.trial.experiment.folder, job.common.sources
    if all(_holds(os.path.join(beside, path), text) for path, text in texts.items()):
        return dataclasses.replace(job, modules=beside)
    key = hashlib.sha256(json.dumps(texts, sort_keys=True).encode()).hexdigest()[:16]
    own = os.path.join(folder, f'modules-{key}')
    for path, text in texts.items():
        target = os.path.join(own, path)
        if not os.path.abspath(target).startswith(own + os.sep):
            raise ConfigurationError(f"a module has the path {path}; allowed: a path in the experiment's folder")
        if not os.path.exists(target):
            os.makedirs(os.path.dirname(target), exist_ok=True)
            with open(target, 'x', encoding='utf-8') as stream:
                stream.write(text)
    return dataclasses.replace(job, modules=own)


def _holds(path: str, text: str) -> bool:
    try:
        with open(path, encoding='utf-8') as stream:
            return stream.read() == text
    except (OSError, ValueError):
        return False


def load(name: str, folder: str) -> Callable[..., Any]:
    """Return the function of a name 'module:function'.

    :param folder: the folder of the experiment's own modules, which goes to the front of Python's path.
    """
    if folder not in sys.path:
        sys.path.insert(0, folder)
    module, _, function = name.partition(':')
    found: Callable[..., Any] = getattr(importlib.import_module(module), function)
    if not callable(found):
        raise TypeError(f'{name} cannot be called')
    return found


def checked(found: Any, factors: Iterable[str], known: Iterable[str]) -> Dict[str, Optional[float]]:
    """Return the metrics that a function returned, checked: {name: number or None}.

    :param factors: the names of the factors. :param known: the names of metrics that are taken already.
    :raises ValueError, TypeError: saying what is allowed.
    """
    if not isinstance(found, dict) or len(found) > _MOST_METRICS:
        raise TypeError(f'must return a mapping of at most {_MOST_METRICS} numbers by name, got {type(found).__name__}')
    numbers: Dict[str, Optional[float]] = {}
    for name, given in found.items():
        if not isinstance(name, str) or not _NAME.match(name) or name in (*known, *OWN_COLUMNS, *factors):
            raise ValueError(f'{name!r} is not a name for a metric: a letter, then letters, digits and underscores, '
                             'not a column of the table already')
        value = given.item() if hasattr(given, 'item') else given  # a number of numpy
        if value is not None and not isinstance(value, (bool, int, float)):
            raise TypeError(f'{name} must be a number or None, got {type(value).__name__}')
        if isinstance(value, float) and math.isinf(value):
            raise ValueError(f'{name} must be finite, NaN or None (no value), got {value}')
        is_none = isinstance(value, float) and math.isnan(value)
        if isinstance(value, int) and abs(value) > _LARGEST:
            raise ValueError(f'{name} must lie within what a float holds, got {shown(value)}')
        numbers[name] = None if is_none else int(value) if isinstance(value, bool) else value
    return numbers


def run_trial(job: Job, folders: run_folders.Folders) -> Returned:
    """Run the trial that is a job's function. :raises SimulatorError: if it failed."""
    experiment = job.trial.experiment
    processes.adopt_orphans()
    processes.block_child_signal()
    os.environ.update({'ROS_LOG_DIR': folders.logs, 'ROS_HOME': folders.files})
    output = os.path.join(folders.logs, run_folders.OUTPUT)
    return Returned(*call(lambda: _perform(job, folders), experiment.time_limit, output, folders.files))


def _perform(job: Job, folders: run_folders.Folders) -> Returned:
    """Call the function that is a trial, in this process."""
    trial, experiment = FunctionTrial(job.trial, folders), job.trial.experiment
    uncaught = _note_threads()
    _seed(trial.seed)
    metrics = checked(load(experiment.function, job.modules)(trial), experiment.factors, ())
    return Returned(metrics, [str(one)[:_LONGEST_LABEL] for one in trial.labels[:_MOST_LABELS]],
                    _seconds(trial.simulated_seconds),
                    [{'node': 'the function', 'takes_part': False, 'code': 0, 'shown': uncaught},
                     *getattr(sys.modules.get(LOOPBACK), 'ended', [])])


def _note_threads() -> List[str]:
    """Return a list that will get the uncaught exceptions of this process's threads from now on."""
    noted: List[str] = []
    show = threading.excepthook

    def note(about: Any) -> None:
        if about.exc_type is not SystemExit:
            noted.append(f'{about.exc_type.__name__} in {words_of(about.thread)}')
        show(about)
    threading.excepthook = note
    return noted


def _seed(seed: int) -> None:
    """Seed the global generators of Python and numpy with the trial's seed, as in nodes."""
    random.seed(seed)  # noqa: TID251 - the generator of the program, not ours
    if _NUMPY in sys.modules:
        sys.modules[_NUMPY].seed(seed % 2 ** 32)
    else:
        sys.meta_path[:] = [_Seeding(seed % 2 ** 32), *(one for one in sys.meta_path if not isinstance(one, _Seeding))]


class _Seeding:
    """A finder that seeds numpy's generator when the function imports numpy; many functions never do."""

    def __init__(self, seed: int) -> None:
        self._seed = seed

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> Any:
        """Return the spec of numpy.random with a loader that seeds it; None for any other module."""
        if name != _NUMPY:
            return None
        sys.meta_path.remove(self)
        spec = importlib.machinery.PathFinder.find_spec(name, path, target)
        loader: Any = spec.loader if spec else None
        if loader is not None:
            run = loader.exec_module

            def execute(module: Any) -> None:
                run(module)
                module.seed(self._seed)
            loader.exec_module = execute
        return spec


def _seconds(given: Any) -> Optional[float]:
    if given is None:
        return None
    value = float(given)
    if not 0.0 <= value < math.inf:
        raise ValueError(f'simulated_seconds must be a finite number >= 0, got {shown(given)}')
    return value


def prepare(experiment: Experiment, folder: str) -> None:
    """Call, in this process, the function that 'prepare' of an experiment names. folder: that of its modules.

    :raises ConfigurationError: if the function fails, or leaves a thread.
    """
    name = experiment.prepare
    try:
        load(name, folder)(dict(experiment.args), {key: list(levels) for key, levels in experiment.factors.items()})
        processes.assert_one_thread()
    except Exception as problem:
        raise ConfigurationError(f'prepare: {name}: {described(problem)}') from problem


def again(job: Job, path: str, folders: run_folders.Folders) -> Returned:
    """Run a job's function a second time, in a new Python process with another hash seed.

    path: the file into which the job is pickled. :raises SimulatorError: if the function failed.
    """
    with open(path, 'wb') as stream:
        pickle.dump((job, folders), stream)
    environment = {**os.environ, 'PYTHONHASHSEED': '12345', 'PYTHONPATH': os.pathsep.join(filter(None, sys.path))}
    pid = processes.execute([sys.executable, '-m', __name__, path], environment,
                            os.path.join(folders.logs, 'again.txt'), folders.files)
    statuses: Dict[int, int] = {}
    processes.await_ends({pid}, job.trial.experiment.time_limit + 30.0, statuses)
    processes.end([pid] if pid not in statuses else [], signal.SIGKILL, 1.0, statuses)
    processes.end_all_children()
    with contextlib.suppress(OSError, ValueError), open(path + '.answer', encoding='utf-8') as answer_file:
        answer = json.load(answer_file)
        if 'problem' in answer:
            raise CallError(answer['problem'])
        return Returned(**answer)
    raise CallError('its process died')


def main(words: List[str]) -> None:
    """Run the trial for again() in this process, which again() started. ``words``: the path of the pickled job."""
    with open(words[0], 'rb') as stream:
        job, folders = pickle.load(stream)
    try:
        if job.prepared:
            prepare(job.trial.experiment, job.modules)
        answer = run_trial(job, folders)._asdict()
    except SimulatorError as problem:
        answer = {'problem': str(problem)}
    with open(words[0] + '.answer', 'w', encoding='utf-8') as answer_file:
        json.dump(answer, answer_file)


if __name__ == '__main__':
    main(sys.argv[1:])
