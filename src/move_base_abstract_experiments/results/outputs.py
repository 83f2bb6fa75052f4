"""The folder of an experiment: what is in it, what may be replaced, which trials are complete.

    OUT/.made_by_move_base_abstract      says that this program made the folder; locked while a run writes there
    OUT/.move_base_abstract_experiment   the same, for programs that only read
    OUT/experiment.yaml                  the file as given
    OUT/plan.json                        the trials, factors, metrics, versions
    OUT/trials/ID/                       trial.json, events.jsonl, messages.jsonl, files-*, logs/
    OUT/trials.csv, OUT/trials.parquet   a row per trial

A trial's folder appears under its name when all of it is on the disk.
"""
from __future__ import annotations

import contextlib
import io
import json
import os
import re
import shutil
import tarfile
from pathlib import Path
from typing import IO, Any, Iterable, Iterator, List, Optional, Union

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.json_files import loads_cleaned
from move_base_abstract.common.own_files import FolderKind, new_file, on_disk, whole_file

from .. import records
from ..records import Planned, Result

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

    def __init__(self, path: Union[str, Path]) -> None:
        self.path = Path(os.path.abspath(path))
        self._marker: Optional[int] = None
        self._together: Optional[List[Path]] = None  # names of trials that are to come into their places together

    def __enter__(self) -> OutputFolder:
        self._marker = OUT.make(self.path)
        try:
            self.write(EXPERIMENT_MARKER, b'This folder was made by move_base_abstract, as an experiment.\n')
            os.makedirs(self.path / 'trials', exist_ok=True)
        except BaseException as problem:
            os.close(self._marker)
            if isinstance(problem, FileExistsError):
                raise ConfigurationError(f'{self.path / "trials"}: exists already, and is not a folder') from None
            raise
        return self

    def __exit__(self, *problem: Any) -> None:
        if self._marker is not None:
            os.close(self._marker)

    def write(self, name: str, content: bytes) -> None:
        """Write a file (bytes) as a whole."""
        self.write_pieces(name, [content])

    def write_pieces(self, name: str, pieces: Iterable[bytes]) -> None:
        """As write(), of pieces (bytes) that come one after another."""
        with whole_file(self.path / name, 'wb') as stream:
            stream.writelines(pieces)

    def put(self, content: bytes, worker: str, attempts: int) -> Result:
        """Unpack a trial's outputs (an archive) into its place; return its Result."""
        with opened(content) as archive:
            members = checked_members(archive)
            result = result_in(archive)
            result.worker, result.attempts = worker, attempts
            with self._whole_trial(result) as part:
                for member in members:
                    if member.name != 'trial.json':
                        if member.name.startswith('logs/') and not (part / 'logs').is_dir():
                            LOGS.make_new(part / 'logs')
                        _unpack(archive, member, part / member.name)
        return result

    def put_failure(self, result: Result) -> None:
        """Leave trial.json of a trial that has no outputs."""
        with self._whole_trial(result):
            pass

    @contextlib.contextmanager
    def _whole_trial(self, result: Result) -> Iterator[Path]:
        """Give a trial's new folder to be filled; with trial.json it then takes the place of the old one."""
        final = self.place(result.id)
        part = final.with_name(final.name + UNFINISHED)
        remove_trial(part)
        TRIAL.make_new(part)
        yield part
        with new_file(part / 'trial.json', encoding='utf-8') as stream:
            stream.write(json.dumps(result.written, indent=1, allow_nan=False) + '\n')
        check_trial(final)
        if self._together is None:
            _settle([final])
        else:
            self._together.append(final)

    @contextlib.contextmanager
    def together(self) -> Iterator[None]:
        """Have the trials that are put meanwhile come into their places at the end: the disk is waited for once."""
        self._together = []
        try:
            yield
        finally:
            finals, self._together = self._together or [], None
            try:
                _settle(finals)
            except KeyboardInterrupt:  # these trials are complete
                _settle(finals)
                raise

    def place(self, name: str) -> Path:
        """Return the folder of a trial."""
        if not _ID.match(name):
            raise ConfigurationError(f'{name!r} is no id of a trial')
        return self.path / 'trials' / name


def opened(content: bytes) -> tarfile.TarFile:
    """Return the archive in bytes, opened; it may be compressed (gzip)."""
    mode = 'r:gz' if content[:len(_GZIP)] == _GZIP else 'r:'  # 'r:*' tries all kinds each time
    return tarfile.open(fileobj=io.BytesIO(content), mode=mode)


def result_in(archive: tarfile.TarFile) -> Result:
    """Return the Result in a trial's outputs. :raises ConfigurationError, LookupError, ValueError: if there is none."""
    content: Any = loads_cleaned(opened_member(archive, 'trial.json').read())
    return records.result_of(content, str(content.get('id')), 'trial.json')


def read_planned(path: Union[str, Path], planned: Planned) -> Optional[Result]:
    """As records.read_planned(), but None also where trial.json cannot be understood."""
    try:
        return records.read_planned(str(path), planned)
    except ConfigurationError:
        return None


def remove_trial(path: Path) -> None:
    """Remove a trial's folder of our own, if it is there. :raises ConfigurationError: naming what is not ours in it."""
    logs = path / 'logs'
    if path.is_dir() and not path.is_symlink():
        LOGS.remove(logs)
    TRIAL.remove(path)


def check_trial(path: Path) -> None:
    """Complain of what is not ours in a trial's folder, if it is there. :raises ConfigurationError: naming it."""
    if path.is_dir() and not path.is_symlink():
        LOGS.check(path / 'logs')
    TRIAL.check(path, ('logs',))


def _settle(finals: List[Path]) -> None:
    """Have trials whose folders are filled take their places, once all of them is on the disk."""
    pairs = [(final.with_name(final.name + UNFINISHED), final) for final in finals]
    pairs = [(part, final) for part, final in pairs if part.is_dir()]  # some may have theirs already
    for part, _ in pairs:
        on_disk(part)
    for part, final in pairs:
        with contextlib.suppress(ConfigurationError):  # checked before; what somebody has put there since stays
            remove_trial(final)
            os.rename(part, final)


def checked_members(archive: tarfile.TarFile) -> List[tarfile.TarInfo]:
    """Return an archive's members. :raises ConfigurationError: for what is no plain file with a plain name."""
    members, total = [], 0
    for member in archive:
        total += member.size
        if not member.isreg() or not _MEMBER.match(member.name) or total > _MOST_BYTES:
            raise ConfigurationError(f'the outputs of a trial hold {member.name!r}; allowed: plain files in its '
                                     f'folder, at most {_MOST_BYTES} bytes')
        members.append(member)
    return members


def _unpack(archive: tarfile.TarFile, info: tarfile.TarInfo, path: Path) -> None:
    with new_file(path, 'xb') as stream:  # the folder takes its place only when all of it is on the disk
        shutil.copyfileobj(opened_member(archive, info.name), stream)


def opened_member(archive: tarfile.TarFile, name: str) -> IO[bytes]:
    """Return a member of an archive, opened. :raises KeyError: if there is no plain file of that name."""
    found = archive.extractfile(name)
    if found is None:
        raise KeyError(name)
    return found
