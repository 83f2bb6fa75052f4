"""The warm process of a worker. It has imported all modules that trials need, and forks a process for each trial.

    python3 -m move_base_abstract_experiments.carrying.warm [ros] [numpy] SOCKET_DESCRIPTOR

It has one thread. A request on the socket is a pickled Job. When the trial has ended, the answer is a line of JSON:
{"code": 0, "path": ...}. The outputs of the trial are in this folder. If the worker ends, in whatever way, the other
end of the socket is closed. Then the trial is ended, and its folder is removed.

Trials that are functions share one process that carries them out (see carriers.py). Their own code does not run in it,
because each function has a process of its own.
"""
from __future__ import annotations

import gc
import importlib
import json
import os
import pickle
import shutil
import signal
import socket
import sys
from typing import Dict, List, Optional, Sequence

from move_base_abstract.common import guard, processes, temporary
from move_base_abstract.common.errors import ConfigurationError

from ..description import launch_files
from ..description.job import NUMPY, ROS, Job
from ..trials import functions, run_folders
from . import carriers, warm_ros

_HASH_SEED = 'PYTHONHASHSEED'
READY = b'ready\n'


def main(words: List[str]) -> None:
    """Serve until the socket is closed."""
    is_new = _wants_start()
    if is_new or any(os.environ.get(name) != value for name, value in processes.ONE_THREAD.items()):
        os.environ.update(processes.ONE_THREAD)
        os.execv(sys.executable, [sys.executable, '-m', __spec__.name, *words])
    guard.stand('trials')
    processes.keep_memory()
    _import(words[:-1])
    from ..trials import execution  # noqa: F401 - so that the forks have it
    _share()
    processes.adopt_orphans()
    with temporary.folder('trials_') as folder:
        try:
            with socket.socket(fileno=int(words[-1])) as client:
                _serve(client, folder)
        finally:
            processes.end_all_children()


def _wants_start() -> bool:
    """Return whether this Python must be started again, once, with what is in the environment now, as nodes are."""
    if warm_ros.is_there():
        from move_base_abstract_ros.launching.warm_nodes import wants_start
        return bool(wants_start(os.environ))
    is_new = _HASH_SEED not in os.environ
    os.environ.setdefault(_HASH_SEED, '0')
    return is_new


def _import(wanted: Sequence[str]) -> None:
    """Import what the trials need, as Common.warm says. More would make each fork slower."""
    if ROS in wanted and warm_ros.is_there():
        from move_base_abstract_ros.launching import warm_nodes
        warm_nodes.import_all()
        warm_ros.launcher()  # so that not each trial looks it up
    if NUMPY in wanted:
        importlib.import_module('numpy.random')  # from 2.3 on, numpy imports it only when it is used


def _serve(client: socket.socket, folder: str) -> None:
    wake, woken = os.pipe()
    os.set_blocking(wake, False)
    os.set_blocking(woken, False)
    signal.signal(signal.SIGCHLD, lambda _number, _frame: None)
    signal.set_wakeup_fd(woken, warn_on_full_buffer=False)
    client.sendall(READY)
    count = 0
    problems: Dict[str, Optional[str]] = {}
    path: Optional[str] = None
    carrier = carriers.Carrier((client.fileno(), wake, woken))
    with client.makefile('rb') as requests:
        while requests.peek(1):
            if path is None:
                count += 1
                path = os.path.join(folder, f'{count:06d}')
                os.mkdir(path)
            job = functions.place(pickle.load(requests), folder)
            known = len(problems)
            problem = _prepare(job, problems)
            if len(problems) > known or not job.trial.experiment.function:
                carrier.end()  # it lacks what was imported since; and a trial of a graph has a process of its own
            code = carrier.run(job, path, problem, client, wake)
            if code != 0:  # the process has died, and may have left children; or the worker has ended
                processes.end_all_children()
            if code is None:
                return
            if not job.trial.experiment.function:
                carrier.end()
                processes.end_all_children()
            client.sendall(json.dumps({'code': code, 'path': path}).encode() + b'\n')
            if requests.readline() != b'taken\n':
                return
            launch_files.load_programs(path)
            if not (job.trial.experiment.function and _is_emptied(path)):
                shutil.rmtree(path, ignore_errors=True)
                path = None


def _is_emptied(path: str) -> bool:
    """Empty a trial's folder for the next trial; return whether it is as new."""
    shutil.rmtree(os.path.join(path, 'again'), ignore_errors=True)
    with os.scandir(path) as entries:
        for entry in entries:
            if entry.name != run_folders.RUN and not run_folders.is_as_new(entry):
                os.unlink(entry.path)
    return run_folders.empty_again(os.path.join(path, run_folders.RUN))


def _prepare(job: Job, problems: Dict[str, Optional[str]]) -> Optional[str]:
    """Call the function that prepares this process for a job, once; return its error, or None."""
    if not job.prepared:
        return None
    key = json.dumps([*job.prepared[:3], job.modules])
    if key not in problems:
        problems[key] = None
        try:
            functions.prepare(job.trial.experiment, job.modules)
        except ConfigurationError as problem:
            problems[key] = str(problem)
        _share()
    return problems[key]


def _share() -> None:
    """Keep the garbage collector of forks away from the present objects, so that their memory is not copied."""
    gc.collect()
    gc.freeze()


if __name__ == '__main__':
    main(sys.argv[1:])
