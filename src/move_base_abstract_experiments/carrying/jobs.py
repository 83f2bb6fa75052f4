"""Make the jobs that go to a worker, and run them there with the worker's warm process."""
from __future__ import annotations

import contextlib
import json
import os
import pickle
import socket
import subprocess
import sys
import tempfile
import threading
from typing import Any, List, Optional, Sequence, Tuple

from move_base_abstract.common.errors import SimulatorError
from move_base_abstract.common.processes import interpreter_of
from move_base_abstract.common.version import package_version

from ..description import ingredients, plan, worker_files
from ..description.experiment import Experiment
from ..description.job import NUMPY, ROS, Common, Job
from ..description.trial import Trial
from ..trials import bundle, functions, run_folders
from . import sockets, spool, warm_ros

_END_S = 10.0  # wall
#: the names of modules with which a function may start nodes
_OF_ROS = {'actionlib', 'move_base_abstract_experiments', 'move_base_abstract_ros', 'rosgraph', 'roslaunch', 'roslib',
           'rospy', 'soil_mapping', 'tf', 'tf2_ros'}
_BESIDE_S = 300.0  # wall; the time that a trial may take besides its runs: for metrics and packing
_state = threading.local()
_all: List[WarmProcess] = []
_ends = [0]


def common_of(experiment: Experiment) -> Common:
    """Return the part that the jobs of all trials of an experiment share, with the files as they are now."""
    return Common(functions.sources(experiment.functions.values(), experiment.folder), package_version(),
                  worker_files.view(), _to_be_warm(experiment))


def _to_be_warm(experiment: Experiment) -> Tuple[str, ...]:
    """Return what a warm process imports. Modules that no function needs would only make each fork slower."""
    names = ingredients.names_from_elsewhere(experiment)
    if not experiment.function or names & _OF_ROS:
        return ROS, NUMPY
    return (NUMPY,) if names else ()


def make_job(trial: Trial, common: Optional[Common] = None, **others: Any) -> Job:
    """Return the Job of a Trial. common: the result of common_of(), if known. others: further fields of the Job."""
    made = ingredients.of_trial(trial)
    return Job(trial, common or common_of(trial.experiment), plan.made_of(trial, made), ingredients.name_of(made),
               ingredients.files_of(made), worker_files.parameters(trial), **others)


class WorkerError(SimulatorError):
    """The warm process of a worker did not start, or was lost."""


class TrialError(SimulatorError):
    """The process of a trial died without outputs; the warm process goes on."""


class WarmProcess:
    """A warm process and the connection to it, for one thread at a time. wanted: what it imports, as Common.warm.

    :raises WorkerError: if it does not start.
    """

    def __init__(self, wanted: Sequence[str] = (ROS, NUMPY)) -> None:
        own, other = sockets.pair()
        # A file: a full pipe that nobody reads would stop the process.
        self._said = tempfile.TemporaryFile()  # noqa: SIM115 - it lasts as long as this object
        with other:
            os.set_inheritable(other.fileno(), True)
            python = _python(interpreter_of(warm_ros.launcher()) if warm_ros.is_there() else '')
            environment = {name: value for name, value in os.environ.items() if name not in (
                'ROS_HOSTNAME', 'ROS_NAMESPACE')}
            self._process = subprocess.Popen(
                [python, '-m', 'move_base_abstract_experiments.carrying.warm', *wanted, str(other.fileno())],
                env=environment, pass_fds=[other.fileno()], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                stderr=self._said, start_new_session=True)
        self._socket = own
        self._answers = own.makefile('rb')
        if self._answers.readline() != b'ready\n':
            self.close()
            raise WorkerError(f'the warm process did not start: {self._last_words()}')

    def run(self, job: Job, target: Optional[str] = None) -> Optional[bytes]:
        """Run the trial of a job; return its outputs as bytes, or None if they are moved to the path ``target``.

        :raises TrialError: if there are no outputs. :raises WorkerError: if the warm process is lost.
        """
        limit = job.wall_limit + _BESIDE_S
        try:
            self._socket.settimeout(limit)  # the warm process, or that of the trial, may be stopped
            self._socket.sendall(pickle.dumps(job))
            line = self._answers.readline()
            answer = json.loads(line) if line else None
            if answer is None:
                raise WorkerError(f'the warm process has gone: {self._last_words()}')
            path = os.path.join(answer['path'], bundle.OUTPUTS)
            has_left = os.path.exists(path)
            content = _taken(path, target) if has_left else None
            text = '' if has_left else _end_of(os.path.join(answer['path'], run_folders.PRINTS))
            self._socket.sendall(b'taken\n')
        except socket.timeout:
            raise WorkerError(f'the trial did not end within {limit:g} s of wall time, not even by its time_limit'
                              ) from None
        except OSError as problem:
            raise WorkerError(f'the warm process was lost: {problem}') from None
        if not has_left:
            raise TrialError(f"the trial's process ended with code {answer['code']}: {text}")
        return content

    def _last_words(self) -> str:
        self._said.seek(0)
        return self._said.read().decode('utf-8', 'replace').strip()[-500:] or 'no text'

    def close(self) -> None:
        """End the process, and with it everything that it has started."""
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()
        try:
            self._process.wait(_END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()


def _python(nodes: str) -> str:
    """Return the Python of a warm process: that of the nodes, or the worker's own if it is a virtual environment of it.

    nodes: the path of the interpreter of this package's nodes, or ''.
    """
    is_over_it = sys.prefix != sys.base_prefix and os.path.realpath(nodes) == os.path.realpath(sys.executable)
    return sys.executable if is_over_it or not nodes else nodes


def _taken(path: str, target: Optional[str]) -> Optional[bytes]:
    """Move a trial's outputs to the path ``target``; if that is None, return them as bytes."""
    if target is not None:
        spool.move(path, target)
        return None
    with open(path, 'rb') as stream:
        return stream.read()


def _end_of(path: str) -> str:
    try:
        with open(path, encoding='utf-8', errors='replace') as stream:
            return ' '.join(stream.read()[-500:].split()) or 'no text'
    except OSError:
        return 'no text'


def carry_out(job: Job, target: Optional[str] = None) -> Tuple[str, Optional[bytes], Optional[str]]:
    """Run a job on this worker; return (the worker's name, the outputs as bytes or None, the error or None).

    target: the path to which the outputs are moved, or None; with a path they are not returned.
    The warm process stays for the next job. If that needs another preparation, other texts of the prepared modules, or
    other imports, the process is replaced, because modules stay imported.
    """
    wanted = job.prepared, job.common.warm
    if getattr(_state, 'warm', None) is not None and _state.wanted != wanted:
        forget(_state.warm)
        _state.warm = None
    if getattr(_state, 'warm', None) is None:
        _state.warm, _state.wanted = WarmProcess(job.common.warm), wanted
        _all.append(_state.warm)
    worker = f'{socket.gethostname()}:{os.getpid()}'
    try:
        return worker, _state.warm.run(job, target), None
    except TrialError as problem:
        return worker, None, str(problem)
    except WorkerError as problem:
        forget(_state.warm)
        _state.warm = None
        return worker, None, str(problem)


def forget(warm: WarmProcess) -> None:
    """End a warm process."""
    with contextlib.suppress(ValueError):
        _all.remove(warm)
    warm.close()


def ends() -> int:
    """Return the number of calls of end_all() on this worker."""
    return _ends[0]


def end_all() -> None:
    """End all warm processes of this worker, and with them their trials. Running batches begin no more trials."""
    _ends[0] += 1
    while _all:
        forget(_all[-1])
