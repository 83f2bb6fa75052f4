"""What a trial is made of where it runs, if that sees other files than who has started the experiment.

Another computer, another workspace or another environment of Python finds other programs by the same names. So there it
is looked up anew what the trial is made of, and compared by content with what the experiment was started with.
"""
import os
import re
import socket
import sys
from functools import lru_cache
from pathlib import Path
from types import SimpleNamespace

from . import ingredients

_WHERE = ('ROS_PACKAGE_PATH', 'CMAKE_PREFIX_PATH', 'PYTHONPATH', 'LD_LIBRARY_PATH', 'PATH')
_BINARY = b'\x7fELF'
_PATH = re.compile(r'/[^\s\'",:;\])}]+')
_MOST_NAMES = 5


def view():
    """Return what says where programs are found, as plain values: two processes that see the same have the same."""
    return [socket.gethostname(), sys.prefix, _own_folder(),
            *(os.environ.get(name, '') for name in _WHERE)]


@lru_cache(maxsize=None)
def _own_folder():
    return str(Path(__file__).resolve().parents[1])


def told(experiment, asked):
    """Return by which a worker looks up what a trial is made of, as plain values. asked: of plan.asked_of()."""
    return {'view': view(), 'asked': list(asked), 'inputs': list(experiment.inputs),
            'command': list(experiment.command), 'parameters': _parameters(asked, experiment.folder)}


def _parameters(asked, folder):
    """Return [[name, value]] of the parameters of a launch file, without the places of files and folders."""
    arguments, launch, _ = asked
    found = ingredients.parameters(launch, tuple(arguments), folder) if launch else ()
    return [[name, _PATH.sub(lambda path: os.path.basename(path.group()) if os.path.exists(path.group()) else
                             path.group(), value)] for name, value in found]


def check(job):
    """Complain of files that are others here than where the experiment was started; return labels for what is unsure.

    :raises ChangedError: naming the first.
    """
    if job['look']['view'] == view():
        return []
    ingredients.forget()
    _check_parameters(job)
    here = _made_here(job)
    known, travels = {}, set(map(os.path.basename, job['sources']))
    for path, found, _ in job['files']['files']:
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
    missing = sorted(set(known) - {os.path.basename(path) for path in here})
    if apart:
        labels.append(f'built on the worker, so that it is not known whether they are the same: {_listed(apart)}')
    if own:
        labels.append(f'of its program only the worker has {_listed(own)} (digest {ingredients.name_of(here)})')
    if missing:
        labels.append(f'of its files the worker has no {_listed(missing)}')
    return labels


def _check_parameters(job):
    wanted = job['look']['parameters']
    here = _parameters(job['look']['asked'], job['folder'])
    if wanted and wanted != here:
        name = min(name for name, _ in [one for one in wanted if one not in here] + [one for one in here if one not in
                                                                                     wanted])
        raise ingredients.ChangedError(f'the parameter {name} is another one on {socket.gethostname()} than where the '
                                       'experiment was started')


def _made_here(job):
    """Return {path: digest} of the files of which the trial is made here."""
    look = job['look']
    experiment = SimpleNamespace(folder=job['folder'], leave_out=tuple(job['leave_out']), inputs=look['inputs'],
                                 replace=dict(map(tuple, job['replace'])), command=look['command'])
    made = ingredients.of_trial(experiment, *look['asked'])
    made.update(ingredients.of_arguments(job['arguments'], job['folder']))
    return {path: found for path, found in made.items() if os.sep in path and found}


def _is_binary(path):
    try:
        with open(path, 'rb') as stream:
            return stream.read(len(_BINARY)) == _BINARY
    except OSError:
        return False


def _listed(names):
    names = sorted(names)
    more = len(names) - _MOST_NAMES
    return ', '.join(names[:_MOST_NAMES]) + (f' and {more} more' if more > 0 else '')
