"""The ingredients of a trial, besides the experiment's file: files, by their content, and parameters.

They are the programs of all nodes, the modules that they import, the libraries that they link, the launch file with all
files that it includes, its parameters, files that parameters and arguments name, inputs, and this package. Each is read
once, when an experiment starts. A worker checks the files again before and after each trial.
"""
from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import shlex
import shutil
import socket
import subprocess
from functools import lru_cache
from pathlib import Path
from typing import Any, Dict, FrozenSet, Iterable, List, Match, NamedTuple, Optional, Set, Tuple

from move_base_abstract.common.errors import ConfigurationError, SimulatorError
from move_base_abstract.common.input_files import open_input
from move_base_abstract.common.options import of_words, words_of
from move_base_abstract.lockstep.run_options import RunOptions
from move_base_abstract.radio import network

from . import launch_files, program_files
from .experiment import Experiment
from .trial import Trial

PACKAGE, PARAMETERS = 'move_base_abstract', 'parameters'
_PARTS = ('time_master',)
_IMAGE = re.compile(r'^\s*image:\s*["\']?([^"\'\s#]+)', re.MULTILINE)
_PATH = re.compile(r'/[^\s\'",:;\])}]+')
_MOST_NAMES = 3
_GIT_S = 5.0  # wall
Made = Dict[str, str]  # {path, PACKAGE or PARAMETERS: digest}
Stamp = Tuple[int, int, int, int]


class ChangedError(SimulatorError):
    """A file on which trials depend has changed since the experiment started."""


def of_trial(trial: Trial) -> Made:
    """Return the ingredients of a trial: {path, PACKAGE or PARAMETERS: digest}.

    Launch files are read with the arguments of the first replication. Files that arguments name are those of the trial
    itself.
    """
    experiment, first, found = trial.experiment, trial.first, {PACKAGE: _own()}
    if experiment.launch:
        found.update(_of_launch(first.launch, tuple(first.arguments), experiment.folder,
                                tuple(words_of(first.run_options))))
    paths = {os.path.join(experiment.folder, name) for name in experiment.inputs}
    paths |= set(network.files_of(trial.network, experiment.folder))
    for word, after in zip(experiment.command, [*experiment.command[1:], '']):
        paths |= _of_word(word, after, experiment.folder)
    for name in experiment.functions.values():
        paths |= _of_module(name.partition(':')[0], experiment.folder)
    paths |= _named([word.partition(':=')[2] for word in trial.arguments], experiment.folder)
    found.update((path, digest(path)) for path in paths)
    return found


@lru_cache(maxsize=None)
def _of_launch(launch: str, arguments: Tuple[str, ...], folder: str, words: Tuple[str, ...]) -> Made:
    """Return {path or PARAMETERS: digest} of a launch file with arguments; {} if only the workers have the file.

    ``words``: those of the run's options.
    """
    from move_base_abstract_ros.launching import given, plan, roles
    try:
        path = launch_files.find(launch, folder)
    except ConfigurationError:
        return {}
    plan.name_anonymous_ones_alike()  # their counter starts again, so each reading gives the same names
    try:
        options = plan.launch_options(of_words(RunOptions, words))
        config = launch_files.read([(path, arguments)], options.adopt or options.tolerant)
        options = launch_files.adopted(config, options) if options.adopt else options
        given.add_to(config, options)
    except ConfigurationError:
        return {one: digest(one) for one in launch_files.with_includes(path)}  # the check or the worker complains
    paths: Set[str] = {os.path.realpath(one) for one in [*launch_files.with_includes(path), *config.roslaunch_files]}
    named = [str(param.value) for param in config.params.values() if isinstance(param.value, str)]
    for node in config.nodes:
        if roles.name_of(node) not in options.leave_out:
            kind = roles.kind_of(node)
            paths |= _of_node(*options.replace.get(kind, kind).split('/'))
            named += [*_split(node.args), *_split(node.launch_prefix)]
    values = sorted((key, repr(param.value)) for key, param in config.params.items())
    found = {one: digest(one) for one in paths | _named(named, folder)}
    return {**found, PARAMETERS: hashlib.sha256(json.dumps(values).encode('utf-8', 'surrogatepass')).hexdigest()}


@lru_cache(maxsize=None)
def parameters(launch: str, arguments: Tuple[str, ...], folder: str,
               is_tolerant: bool = False) -> Tuple[Tuple[str, str], ...]:
    """Return ((name, value as text), ...) of a launch file's parameters, without the folders of files in them.

    They are () if the launch file is not on this computer, or cannot be read.
    """
    try:
        config = launch_files.read([(launch_files.find(launch, folder), arguments)], is_tolerant)
    except ConfigurationError:
        return ()
    return tuple(sorted((key, _PATH.sub(_without_folder, repr(param.value))) for key, param in config.params.items()))


def _without_folder(found: Match[str]) -> str:
    return os.path.basename(found.group()) if os.path.exists(found.group()) else found.group()


def names_from_elsewhere(experiment: Experiment) -> Set[str]:
    """Return the names of packages of others that the modules of an experiment's functions import.

    They are neither the experiment's own nor in Python's standard library.
    """
    modules = {name.partition(':')[0] for name in experiment.functions.values()}
    return program_files.names_from_elsewhere({path for one in modules for path in _of_module(one, experiment.folder)})


def _split(text: Optional[str]) -> List[str]:
    from roslaunch.substitution_args import resolve_args
    try:
        return shlex.split(resolve_args(text or '', resolve_anon=False))
    except Exception:  # the start of the node reports it
        return []


@lru_cache(maxsize=None)
def _of_node(package: str, kind: str) -> FrozenSet[str]:
    from roslib import packages
    try:
        found = packages.find_node(package, kind)
    except Exception:  # the start of the node reports it
        return frozenset()
    return frozenset(one for path in found[:1] for one in program_files.files_of(path))


@lru_cache(maxsize=None)
def _of_module(name: str, folder: str) -> FrozenSet[str]:
    first = name.partition('.')[0]
    places = [folder, *program_files.python_path()]
    files: Tuple[str, ...] = next(filter(None, (program_files.files_of_module(place, first) for place in places)), ())
    return frozenset(one for path in files for one in {path, *program_files.modules_of(path, (folder,))})


@lru_cache(maxsize=None)
def _of_word(word: str, after: str, folder: str) -> Set[str]:
    """Return the files of the program that a word of a command names, by itself or, as PACKAGE TYPE, with the next."""
    path = word if os.path.isabs(word) else shutil.which(word) or ''
    found: Set[str] = set()
    if os.path.isfile(path) and not program_files.is_of_system(path):
        found |= program_files.files_of(path, (folder,))
    if re.fullmatch(r'[A-Za-z][\w-]*', word) and re.fullmatch(r'\w[\w.-]*', after):
        found |= _of_node(word, after)
    return found


def _named(words: List[str], folder: str) -> Set[str]:
    """Return the files that values name by a path, such as maps, worlds and tables; and the image of each map."""
    found: Set[str] = set()
    for word in words:
        path = os.path.join(folder, word) if os.sep in word and '\0' not in word and len(word) < 4096 else ''
        if path and os.path.isfile(path):
            found.add(os.path.realpath(path))
            if path.endswith(('.yaml', '.yml')):
                with contextlib.suppress(OSError, ValueError), open(path, encoding='utf-8') as stream:
                    image = _IMAGE.search(stream.read(1 << 16))
                    beside = os.path.join(os.path.dirname(path), image.group(1)) if image else ''
                    found |= {os.path.realpath(beside)} if os.path.isfile(beside) else set()
    return found


@lru_cache(maxsize=None)
def _own() -> str:
    """Return a digest of this package: the time master, the shim, and all Python modules but those of the report."""
    root, paths = Path(__file__).resolve().parents[2], []
    for name in program_files.OWN_FOLDERS:
        paths += sorted(path for path in (root / name).rglob('*.py') if 'report' not in path.parts)
    content = [[str(path.relative_to(root)), digest(str(path))] for path in paths]
    with contextlib.suppress(Exception):  # without a sourced workspace there are no such programs
        from move_base_abstract_ros.lockstep.programs.binary import find_shim
        from move_base_abstract_ros.loopback import find_executable
        content += [[name, digest(find_executable(name))] for name in _PARTS]
        content += [['shim', digest(find_shim(os.environ))]]
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()


@lru_cache(maxsize=None)
def digest(path: str) -> str:
    """Return the digest of a file's content, '' if it cannot be read; each file is read once."""
    return _look(path)


def _look(path: str) -> str:
    try:
        with open_input(path) as stream:
            return hashlib.sha256(stream.read()).hexdigest()
    except ConfigurationError:
        return ''


@lru_cache(maxsize=None)
def _stamp(path: str) -> Optional[Stamp]:
    return _stat(path)


def _stat(path: str) -> Optional[Stamp]:
    try:
        about = os.stat(path)
    except OSError:
        return None
    return about.st_mtime_ns, about.st_ctime_ns, about.st_ino, about.st_size


class Files(NamedTuple):
    """The files on which a trial depends, as a worker gets them. ``files``: (path, digest, stamp) for each."""

    host: str
    files: Tuple[Tuple[str, str, Optional[Stamp]], ...]


def files_of(made: Made) -> Files:
    """Return the Files among the ingredients of a trial, as of_trial() returns them."""
    return _files_of(tuple(sorted(made.items())))


@lru_cache(maxsize=None)
def _files_of(made: Tuple[Tuple[str, str], ...]) -> Files:
    return Files(socket.gethostname(), tuple((path, found, _stamp(path)) for path, found in made if os.sep in path))


def check(files: Files) -> None:
    """Check that files are still those of files_of().

    On another computer, files that do not exist there are not checked.

    :raises ChangedError: naming the first that is not.
    """
    is_here = files.host == socket.gethostname()
    for path, wanted, stamp in files.files:
        if is_here and stamp is not None and _stat(path) == stamp:
            continue
        if (is_here or os.path.exists(path)) and _look(path) != wanted:
            where = 'since the experiment was started' if is_here else f'on {socket.gethostname()}'
            raise ChangedError(f'{path} is another file {where}')


def changed(before: Made, now: Made) -> str:
    """Return in words what differs between two results of of_trial(): 'a.py, b.py and 3 more', or ''."""
    names = sorted(os.path.basename(path) for path in {*before, *now} if before.get(path) != now.get(path))
    more = len(names) - _MOST_NAMES
    return ', '.join(names[:_MOST_NAMES]) + (f' and {more} more' if more > 0 else '')


def name_of(made: Made) -> str:
    """Return a digest of the ingredients of a trial, as of_trial() returns them."""
    return hashlib.sha256(json.dumps(sorted(made.items())).encode('utf-8', 'surrogateescape')).hexdigest()[:16]


def by_content(made: Made) -> List[List[str]]:
    """Return the ingredients of a trial without the folders of files, because a workspace may be moved."""
    return sorted([os.path.basename(path), found] for path, found in made.items())


def repositories(paths: Iterable[str]) -> List[Dict[str, Any]]:
    """Return [{folder, commit, dirty}] for the git repositories of files; commit and dirty are None if git fails."""
    roots = sorted(filter(None, {_root(os.path.dirname(path)) for path in paths if os.sep in path}))
    words = ['git', '-c', 'core.fsmonitor=false', '--no-optional-locks', 'status', '--porcelain=v2', '--branch']
    found = []
    for root in roots:
        commit, is_dirty = None, None
        with contextlib.suppress(OSError, subprocess.SubprocessError):
            said = subprocess.run([*words[:1], '-C', root, *words[1:]], stdin=subprocess.DEVNULL, check=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, timeout=_GIT_S).stdout
            lines = said.decode('utf-8', 'replace').splitlines()
            commit = next((line.split()[-1] for line in lines if line.startswith('# branch.oid ')), None)
            is_dirty = any(not line.startswith('#') for line in lines)
        found.append({'folder': root, 'commit': commit, 'dirty': is_dirty})
    return found


@lru_cache(maxsize=None)
def _root(folder: str) -> Optional[str]:
    return next((str(one) for one in (Path(folder), *Path(folder).parents) if (one / '.git').exists()), None)


def forget() -> None:
    """Forget all files and parameters, so that they are read again; otherwise a process reads each once."""
    program_files.forget()
    for known in (_of_launch, parameters, _of_node, _of_module, _of_word, _own, digest, _stamp, _root, _files_of):
        known.cache_clear()
