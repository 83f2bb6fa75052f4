"""Functions of users, called in processes of their own; and trials that are such a function, where no graph is run.

A function that is a trial may be a simulation in plain Python, or start what it likes: all that it has started is gone
at its end.
"""
import contextlib
import hashlib
import importlib
import json
import math
import os
import random  # noqa: TID251 - the program's own is given its seed
import re
import select
import signal
import sys
import time
from pathlib import Path

from move_base_abstract.common.errors import ConfigurationError, SimulatorError
from move_base_abstract.common.shown import shown
from move_base_abstract_ros.launching import ends, processes

from . import run, run_folders

OUTPUT = 'function.txt'  # what a trial's function prints
_LOOPBACK = 'move_base_abstract_experiments.carrying.warm_loopback'  # there if a function starts nodes by it
_MOST_BYTES = 1 << 20
_DYING_S = 1.0  # wall, in which a process that says no more has ended
_MOST_METRICS = 200
_MOST_LABELS = 100
_LONGEST_LABEL = 200
_LARGEST = int(sys.float_info.max)
_NAME = re.compile(r'[A-Za-z]\w{0,63}\Z', re.ASCII)


class FunctionError(SimulatorError):
    """A function raised, did not come to its end, or returned what it must not."""


class DeathError(FunctionError):
    """A process that has not said what came out. ``code``: its exit code, of a signal its negative number, or None."""

    def __init__(self, seconds, code, is_late):
        how = '' if code is None else f': {ends.described(code)}'
        super().__init__(f'it was not over after {seconds:g} s of wall time' if is_late
                         else f'its process has told nothing of its end{how}')
        self.code, self.is_late = code, is_late


class FunctionTrial:
    """What a function that is a trial is given; see docs/experiments.md.

    configuration: {factor: value}; replication, seed: whole numbers; args: the experiment's args, filled in; files: a
    Path, the folder that it works in; event_log: a Path where it may leave an event log. It may set simulated_seconds.
    """

    def __init__(self, job, folders):
        self.configuration = job['configuration']
        self.replication = job['replication']
        self.seed = job['seed']
        self.args = job['function_arguments']
        self.files = Path(folders.files)
        self.event_log = Path(folders.own) / run.LOG
        self.simulated_seconds = None
        self.labels = []

    def not_repeatable(self, reason):
        """Say why the same seed may give another trial: the report tells it."""
        self.labels.append(reason)


def sources(names, folder):
    """Return {path from the folder: text} of those modules of functions that lie beside the experiment's file.

    They go with a trial to a worker that may have no such folder. Of a package all modules go.
    """
    found = {}
    for name in filter(None, names):
        module = name.partition(':')[0]
        for path in _modules_beside(module.partition('.')[0], folder):
            with contextlib.suppress(OSError, ValueError), open(os.path.join(folder, path), encoding='utf-8') as stream:
                found[path] = stream.read(_MOST_BYTES)
    return found if sum(map(len, found.values())) < _MOST_BYTES else {}


def _modules_beside(name, folder):
    """Return the paths from the folder of the modules that a module's name stands for there: Python's own choice."""
    alone = f'{name}.py'
    if os.path.isfile(os.path.join(folder, alone)) and not os.path.isfile(os.path.join(folder, name, '__init__.py')):
        return [alone]
    return [os.path.relpath(path, folder) for path in sorted(Path(folder, name).rglob('*.py'))]


def place(job, folder):
    """Have a job find its modules: where they are, or, if they are not there or others, in a new place in a folder."""
    if all(_holds(os.path.join(job['folder'], path), text) for path, text in job['sources'].items()):
        return {**job, 'modules': job['folder']}
    key = hashlib.sha256(json.dumps(job['sources'], sort_keys=True).encode()).hexdigest()[:16]
    own = os.path.join(folder, f'modules-{key}')
    for path, text in job['sources'].items():
        target = os.path.join(own, path)
        if not os.path.abspath(target).startswith(own + os.sep):
            raise ConfigurationError(f'a module by the path {path}; allowed: beside the experiment')
        if not os.path.exists(target):
            os.makedirs(os.path.dirname(target), exist_ok=True)
            with open(target, 'x', encoding='utf-8') as stream:
                stream.write(text)
    return {**job, 'modules': own}


def _holds(path, text):
    try:
        with open(path, encoding='utf-8') as stream:
            return stream.read() == text
    except (OSError, ValueError):
        return False


def load(name, folder):
    """Return the function of a name module:function; modules beside the experiment's file are found, too."""
    if folder not in sys.path:
        sys.path.insert(0, folder)
    module, _, function = name.partition(':')
    found = getattr(importlib.import_module(module), function)
    if not callable(found):
        raise TypeError(f'{name} cannot be called')
    return found


def call(work, seconds, output, cwd):
    """Return what work() returns, as JSON carries it, called in a forked process; all that it has started ends with it.

    seconds: wall. output: the path of a file for what it prints. :raises FunctionError: saying what is wrong.
    """
    read, write = os.pipe()

    def child():
        os.close(read)
        try:
            answer = {'value': work()}
            text = json.dumps(answer)
        except BaseException as problem:
            text = json.dumps({'problem': described(problem)})
            if not isinstance(problem, SimulatorError):
                raise
        finally:
            for stream in (sys.stdout, sys.stderr):
                stream.flush()
            # Children that were forked from this process hold the pipe, too: the end of the line is the end.
            with os.fdopen(write, 'wb') as stream:
                stream.write(text.encode() + b'\n')
    pid = processes.fork(child, output, cwd)
    os.close(write)
    text, statuses = _read_line(read, seconds), {}
    if text is not None and not text.endswith(b'\n'):
        processes.await_ends({pid}, _DYING_S, statuses)
    code = processes.code_of(statuses[pid]) if pid in statuses else None
    processes.end([pid], signal.SIGKILL, 1.0, {})
    processes.end_all_children()
    try:
        answer = json.loads(text or b'')
    except ValueError:
        raise DeathError(seconds, code, text is None) from None
    if 'problem' in answer:
        raise FunctionError(answer['problem'])
    return answer['value']


def described(problem):
    """Return the first line of an exception; of those that are raised on purpose the text alone."""
    lines = str(problem).strip().splitlines()
    text = lines[0] if lines else ''
    return text if isinstance(problem, SimulatorError) and text else f'{type(problem).__name__}: {text}'


def checked(found, factors, known):
    """Return what a function gave, checked. ``known``: names of metrics that there are already.

    :raises ValueError, TypeError: saying what is allowed.
    """
    from ..description.spec import OWN_COLUMNS
    if not isinstance(found, dict) or len(found) > _MOST_METRICS:
        raise TypeError(f'must return a mapping of at most {_MOST_METRICS} numbers by name, got {type(found).__name__}')
    numbers = {}
    for name, given in found.items():
        if not isinstance(name, str) or not _NAME.match(name) or name in (*known, *OWN_COLUMNS, *factors):
            raise ValueError(f'{name!r} is no name for a metric: a letter, then letters, digits and underscores, not a '
                             'column of the table already')
        value = given.item() if hasattr(given, 'item') else given  # of numpy
        if value is not None and not isinstance(value, (bool, int, float)):
            raise TypeError(f'{name} must be a number or None, got {type(value).__name__}')
        if isinstance(value, float) and math.isinf(value):
            raise ValueError(f'{name} must be finite, NaN or None (no value), got {value}')
        is_none = isinstance(value, float) and math.isnan(value)
        if isinstance(value, int) and abs(value) > _LARGEST:
            raise ValueError(f'{name} must lie within what a float holds, got {shown(value)}')
        numbers[name] = None if is_none else int(value) if isinstance(value, bool) else value
    return numbers


def run_trial(job, folders):
    """Run the trial that is a job's function; return {'metrics', 'labels', 'simulated_seconds', 'processes'}.

    The last are fields of launching.ends.Process: of the function itself, and of nodes that it has started.

    :raises SimulatorError: if it failed.
    """
    processes.adopt_orphans()
    processes.block_child_signal()
    os.environ.update(ROS_LOG_DIR=folders.logs, ROS_HOME=folders.files)

    def work():
        trial = FunctionTrial(job, folders)
        uncaught = ends.note_threads()
        _seed(job['seed'])
        metrics = checked(load(job['trial_function'], job['modules'])(trial), job['factors'], ())
        return {'metrics': metrics, 'labels': [str(one)[:_LONGEST_LABEL] for one in trial.labels[:_MOST_LABELS]],
                'simulated_seconds': _seconds(trial.simulated_seconds),
                'processes': [{'node': 'the function', 'takes_part': False, 'code': 0, 'shown': uncaught},
                              *getattr(sys.modules.get(_LOOPBACK), 'ended', [])]}
    return call(work, job['time_limit'], os.path.join(folders.logs, OUTPUT), folders.files)


def _seed(seed):
    """Have the global generators of Python and numpy start from the trial's seed, as those of nodes do."""
    import numpy  # here: it may start threads, which the process that forks must not have
    random.seed(seed)
    numpy.random.seed(seed % 2 ** 32)  # noqa: NPY002 - likewise


def _seconds(given):
    if given is None:
        return None
    value = float(given)
    if not 0.0 <= value < math.inf:
        raise ValueError(f'simulated_seconds must be a finite number >= 0, got {shown(given)}')
    return value


def prepare(wanted, folder):
    """Call the function that a job's 'prepare' names, [name, args, factors], in this process. folder: of modules.

    :raises ConfigurationError: if it fails, or leaves a thread.
    """
    name, arguments, factors = wanted
    try:
        load(name, folder)(arguments, factors)
        processes.assert_one_thread()
    except Exception as problem:
        raise ConfigurationError(f'prepare: {name}: {described(problem)}') from problem


def _read_line(descriptor, seconds):
    """Return what comes until the end of the first line, or of the pipe; None if that takes longer [s, wall]."""
    pieces, deadline = [], time.monotonic() + seconds
    with os.fdopen(descriptor, 'rb', buffering=0) as stream:
        while sum(map(len, pieces)) < _MOST_BYTES:
            ready, _, _ = select.select([stream], [], [], max(0.0, deadline - time.monotonic()))
            if not ready:
                return None
            piece = stream.read(1 << 16)
            pieces.append(piece)
            if not piece or piece.endswith(b'\n'):
                break
    return b''.join(pieces)


def again(job, path, folders):
    """Run a job's function once more: in a Python started anew, with another hash seed; return what run_trial does.

    path: the job's file of JSON to be. :raises SimulatorError: if it failed.
    """
    with open(path, 'w', encoding='utf-8') as stream:
        json.dump({'job': job, 'folders': folders}, stream)
    environment = {**os.environ, 'PYTHONHASHSEED': '12345', 'PYTHONPATH': os.pathsep.join(filter(None, sys.path))}
    words = [sys.executable, '-m', __name__, path]
    pid = processes.execute(words, environment, os.path.join(folders.logs, 'again.txt'), folders.files)
    statuses = {}
    processes.await_ends({pid}, job['time_limit'] + 30.0, statuses)
    processes.end([pid] if pid not in statuses else [], signal.SIGKILL, 1.0, statuses)
    processes.end_all_children()
    with contextlib.suppress(OSError, ValueError), open(path + '.answer', encoding='utf-8') as stream:
        answer = json.load(stream)
        if 'problem' in answer:
            raise FunctionError(answer['problem'])
        return answer
    raise FunctionError('its process died')


def main(words):
    """Run a trial in this process, which was started for it: what again() asks for."""
    with open(words[0], encoding='utf-8') as stream:
        given = json.load(stream)
    job = given['job']
    try:
        if job['prepare']:
            prepare(job['prepare'], job['modules'])
        answer = run_trial(job, run_folders.Folders(*given['folders']))
    except SimulatorError as problem:
        answer = {'problem': str(problem)}
    with open(words[0] + '.answer', 'w', encoding='utf-8') as stream:
        json.dump(answer, stream)


if __name__ == '__main__':
    main(sys.argv[1:])
