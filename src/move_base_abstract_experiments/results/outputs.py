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

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.json_files import loads_cleaned
from move_base_abstract.common.own_files import FolderKind, new_file, on_disk, whole_file

from .. import records

EXPERIMENT_MARKER = '.move_base_abstract_experiment'
UNFINISHED = '.unfinished'
OUT = FolderKind('folder of an experiment')
TRIAL = FolderKind('trial of an experiment', ('trial.json', 'events.jsonl', 'messages.jsonl', 'files-*'))
LOGS = FolderKind("folder of a trial's logs", ('*.txt', '*.log'))
_MEMBER = re.compile(r'(logs/)?[\w%][\w.%-]{0,239}\Z', re.ASCII)
_GZIP = b'\x1f\x8b'
_MOST_BYTES = 4 << 30  # of a trial, unpacked
_ID = re.compile(r'[0-9]{4,7}-[0-9a-f]{6}\Z')


class OutputFolder:
    """OUT; a context manager that holds its lock. :raises ConfigurationError: if it is not ours, or in use."""

    def __init__(self, path):
        self.path = Path(os.path.abspath(path))
        self._marker = None
        self._together = None  # names of trials that are to come into their places together

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
        self.write_pieces(name, [content])

    def write_pieces(self, name, pieces):
        """As write(), of pieces (bytes) that come one after another."""
        with whole_file(self.path / name, 'wb') as stream:
            stream.writelines(pieces)

    def put(self, content, worker, attempts):
        """Unpack a trial's outputs (bytes of an archive) into its place; return trial.json's content."""
        with opened(content) as archive:
            members = checked_members(archive)
            about = loads_cleaned(archive.extractfile('trial.json').read())
            records.checked_trial(about, str(about.get('id')), 'trial.json')
            about.update(worker=worker, attempts=attempts)
            with self._whole_trial(about) as part:
                for member in members:
                    if member.name != 'trial.json':
                        if member.name.startswith('logs/') and not (part / 'logs').is_dir():
                            LOGS.make_new(part / 'logs')
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
        TRIAL.make_new(part)
        yield part
        with new_file(part / 'trial.json', encoding='utf-8') as stream:
            stream.write(json.dumps(about, indent=1, allow_nan=False) + '\n')
        check_trial(final)
        if self._together is None:
            _settle([final])
        else:
            self._together.append(final)

    @contextlib.contextmanager
    def together(self):
        """Have the trials that are put meanwhile come into their places at the end: the disk is waited for once."""
        self._together = []
        try:
            yield
        finally:
            finals, self._together = self._together, None
            try:
                _settle(finals)
            except KeyboardInterrupt:  # these trials are complete
                _settle(finals)
                raise

    def place(self, name):
        """Return the folder of a trial."""
        if not _ID.match(name):
            raise ConfigurationError(f'{name!r} is no id of a trial')
        return self.path / 'trials' / name


def opened(content):
    """Return the archive in bytes, opened; it may be compressed (gzip)."""
    mode = 'r:gz' if content[:len(_GZIP)] == _GZIP else 'r:'  # 'r:*' tries all kinds each time
    return tarfile.open(fileobj=io.BytesIO(content), mode=mode)


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


def check_trial(path):
    """Complain of what is not ours in a trial's folder, if it is there. :raises ConfigurationError: naming it."""
    if path.is_dir() and not path.is_symlink():
        LOGS.check(path / 'logs')
    TRIAL.check(path, ('logs',))


def _settle(finals):
    """Have trials whose folders are filled take their places, once all of them is on the disk."""
    pairs = [(final.with_name(final.name + UNFINISHED), final) for final in finals]
    pairs = [(part, final) for part, final in pairs if part.is_dir()]  # some may have theirs already
    for part, _ in pairs:
        on_disk(part)
    for part, final in pairs:
        with contextlib.suppress(ConfigurationError):  # checked before; what somebody has put there since stays
            remove_trial(final)
            os.rename(part, final)


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
    with new_file(path, 'xb') as stream:  # the folder takes its place only when all of it is on the disk
        shutil.copyfileobj(archive.extractfile(member), stream)
