"""The folder of an experiment: what is in it, what may be replaced, which trials are complete.

    OUT/.made_by_move_base_abstract      says that this program made the folder; locked while a run writes there
    OUT/.move_base_abstract_experiment   the same, for programs that only read
    OUT/experiment.yaml                  the file as given
    OUT/plan.json                        the trials, factors, metrics, versions
    OUT/trials/ID/                       trial.json, events.jsonl, messages.jsonl, files-*, logs/
    OUT/trials.csv, OUT/trials.parquet   a row per trial

A trial's folder appears under its name when all of it is on the disk.
"""
import contextlib
import io
import json
import os
import re
import shutil
import tarfile
from pathlib import Path

from move_base_abstract.errors import ConfigurationError
from move_base_abstract.json_files import cleaned
from move_base_abstract.own_files import FolderKind, whole_file

from . import records

EXPERIMENT_MARKER = '.move_base_abstract_experiment'
UNFINISHED = '.unfinished'
OUT = FolderKind('folder of an experiment')
TRIAL = FolderKind('trial of an experiment', ('trial.json', 'events.jsonl', 'messages.jsonl', 'files-*'))
LOGS = FolderKind("folder of a trial's logs", ('*.txt', '*.log'))
_MEMBER = re.compile(r'(logs/)?[\w%][\w.%-]{0,239}\Z', re.ASCII)
_MOST_BYTES = 4 << 30  # of a trial, unpacked
_ID = re.compile(r'[0-9]{4,7}-[0-9a-f]{6}\Z')


class OutputFolder:
    """OUT; a context manager that holds its lock. :raises ConfigurationError: if it is not ours, or in use."""

    def __init__(self, path):
        self.path = Path(os.path.abspath(path))
        self._marker = None

    def __enter__(self):
        self._marker = OUT.make(self.path)
        try:
            self.write(EXPERIMENT_MARKER, b'This folder was made by move_base_abstract, as an experiment.\n')
            os.makedirs(self.path / 'trials', exist_ok=True)
        except BaseException as problem:
            os.close(self._marker)
            if isinstance(problem, FileExistsError):
                raise ConfigurationError(f'{self.path / "trials"}: is there already, and is no folder') from None
            raise
        return self

    def __exit__(self, *problem):
        os.close(self._marker)
        return False

    def write(self, name, content):
        """Write a file (bytes) as a whole."""
        with whole_file(self.path / name, 'wb') as stream:
            stream.write(content)

    def put(self, content, worker, attempts):
        """Unpack a trial's outputs (bytes of an archive) into its place; return trial.json's content."""
        with tarfile.open(fileobj=io.BytesIO(content), mode='r:*') as archive:
            members = checked_members(archive)
            about = cleaned(json.load(archive.extractfile('trial.json')))
            records.checked_trial(about, str(about.get('id')), 'trial.json')
            about.update(worker=worker, attempts=attempts)
            with self._whole_trial(about) as part:
                for member in members:
                    if member.name != 'trial.json':
                        _unpack(archive, member, part / member.name)
        return about

    def put_failure(self, about):
        """Leave trial.json of a trial that has no outputs."""
        with self._whole_trial(about):
            pass

    @contextlib.contextmanager
    def _whole_trial(self, about):
        """Give a trial's new folder to be filled; with trial.json it then takes the place of the old one."""
        final = self.place(about['id'])
        part = final.with_name(final.name + UNFINISHED)
        remove_trial(part)
        with _marked(TRIAL, part), _marked(LOGS, part / 'logs'):
            yield part
            _write_json(part / 'trial.json', about)
        remove_trial(final)
        os.rename(part, final)

    def place(self, name):
        """Return the folder of a trial."""
        if not _ID.match(name):
            raise ConfigurationError(f'{name!r} is no id of a trial')
        return self.path / 'trials' / name


def read_trial(path, name):
    """Return trial.json of a trial of an experiment's folder, or None if it is not there, or cannot be understood."""
    try:
        return records.read_trial(path, name)
    except ConfigurationError:
        return None


def read_planned(path, planned):
    """As read_trial, of an entry of a plan: None also if what is there is made of something else."""
    try:
        return records.read_planned(path, planned)
    except ConfigurationError:
        return None


def remove_trial(path):
    """Remove a trial's folder of our own, if it is there. :raises ConfigurationError: naming what is not ours in it."""
    logs = path / 'logs'
    if path.is_dir() and not path.is_symlink():
        LOGS.remove(logs)
    TRIAL.remove(path)


@contextlib.contextmanager
def _marked(kind, path):
    marker = kind.make(path)
    try:
        yield
    finally:
        os.close(marker)


def checked_members(archive):
    """Return an archive's members. :raises ConfigurationError: for what is no plain file with a plain name."""
    members, total = [], 0
    for member in archive:
        total += member.size
        if not member.isreg() or not _MEMBER.match(member.name) or total > _MOST_BYTES:
            raise ConfigurationError(f'the outputs of a trial hold {member.name!r}; allowed: plain files in its '
                                     f'folder, at most {_MOST_BYTES} bytes')
        members.append(member)
    return members


def _unpack(archive, member, path):
    with whole_file(path, 'wb') as stream:
        shutil.copyfileobj(archive.extractfile(member), stream)


def _write_json(path, content):
    with whole_file(path, 'w', encoding='utf-8') as stream:
        json.dump(content, stream, indent=1, allow_nan=False)
        stream.write('\n')
