"""Check a trial's files where it runs, if the worker sees other files than the program that started the experiment.

On another computer, in another workspace or in another Python environment, the same names may lead to other programs.
So the worker finds the trial's ingredients again, and compares their content with that at the start of the experiment.
"""
from __future__ import annotations

import os
import socket
import sys
from functools import lru_cache
from pathlib import Path
from typing import Collection, Dict, List, Tuple

from move_base_abstract.common.shown import first_of

from . import ingredients
from .job import Job
from .trial import Trial

_WHERE = ('ROS_PACKAGE_PATH', 'CMAKE_PREFIX_PATH', 'PYTHONPATH', 'LD_LIBRARY_PATH', 'PATH')
_BINARY = b'\x7fELF'
_MOST_NAMES = 5


def view() -> Tuple[str, ...]:
    """Return all that decides where programs are found. Two processes with equal views find the same files."""
    return (socket.gethostname(), sys.prefix, _own_folder(), *(os.environ.get(name, '') for name in _WHERE))


@lru_cache(maxsize=None)
def _own_folder() -> str:
    return str(Path(__file__).resolve().parents[1])


def parameters(trial: Trial) -> Tuple[Tuple[str, str], ...]:
    """Return ((name, value), ...) for the parameters of a trial's launch file, without the folders of files."""
    first = trial.first
    experiment = trial.experiment
    return ingredients.parameters(first.launch, tuple(first.arguments), experiment.folder,
                                  experiment.adopt or experiment.tolerant) if first.launch else ()


def check(job: Job) -> List[str]:
    """Compare the files here with those where the experiment was started; return labels for what cannot be decided.

    :raises ChangedError: naming the first file, or a parameter, that is different here.
    """
    if job.common.view == view():
        return []
    ingredients.forget()
    _check_parameters(job)
    here = {path: found for path, found in ingredients.of_trial(job.trial).items() if os.sep in path and found}
    known: Dict[str, List[str]] = {}
    travels = set(map(os.path.basename, job.common.sources))
    for path, found, _ in job.files.files:
        if os.path.basename(path) not in travels:
            known.setdefault(os.path.basename(path), []).append(found)
    labels, apart, own = [], set(), set()
    for path, found in sorted(here.items()):
        name = os.path.basename(path)
        if name in travels or found in known.get(name, ()):
            continue
        if name not in known:
            own.add(name)
        elif _is_binary(path):
            apart.add(name)
        else:
            raise ingredients.ChangedError(f'{path} is another file on {socket.gethostname()} than where the '
                                           'experiment was started')
    missing = set(known) - {os.path.basename(path) for path in here}
    if apart:
        labels.append(f'built on the worker, so that it is not known whether they are the same: {_listed(apart)}')
    if own:
        labels.append(f'of its program only the worker has {_listed(own)} (digest {ingredients.name_of(here)})')
    if missing:
        labels.append(f'of its files the worker has no {_listed(missing)}')
    return labels


def _check_parameters(job: Job) -> None:
    wanted, here = job.parameters, parameters(job.trial)
    if wanted and wanted != here:
        name = min(name for name, _ in {*wanted} ^ {*here})
        raise ingredients.ChangedError(f'the parameter {name} is another one on {socket.gethostname()} than where the '
                                       'experiment was started')


def _is_binary(path: str) -> bool:
    try:
        with open(path, 'rb') as stream:
            return stream.read(len(_BINARY)) == _BINARY
    except OSError:
        return False


def _listed(names: Collection[str]) -> str:
    return first_of(sorted(names), _MOST_NAMES)
