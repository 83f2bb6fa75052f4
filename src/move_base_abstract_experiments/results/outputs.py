"""The folder of an experiment: its content, and what may be replaced in it.

    OUT/.made_by_move_base_abstract      says that this program made the folder; locked while a run writes there
    OUT/.move_base_abstract_experiment   the same, for programs that only read
    OUT/experiment.yaml                  the file as given
    OUT/plan.json                        the trials, factors, metrics, versions
    OUT/trials/ID/                       trial.json, events.jsonl, messages.jsonl, files-*, logs/
    OUT/trials.csv, OUT/trials.parquet   a row per trial

A trial's folder gets its name when all of it is on the disk.
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
from ..records import Plan, Planned, Result

EXPERIMENT_MARKER = '.move_base_abstract_experiment'
UNFINISHED = '.unfinished'
OUT = FolderKind('folder of an experiment')
TRIAL = FolderKind('trial of an experiment', ('trial.json', 'events.jsonl', 'messages.jsonl', 'files-*'))
LOGS = FolderKind("folder of a trial's logs", ('*.txt', '*.log'))
_MEMBER = re.compile(r'(logs/)?[\w%][\w.%-]{0,239}\Z', re.ASCII)
_GZIP = b'\x1f\x8b'
_MOST_BYTES = 4 << 30  # the largest size of a trial's outputs, unpacked
_ID = re.compile(r'[0-9]{4,7}-[0-9a-f]{6}\Z')


class OutputFolder:
    """The folder OUT; a context manager that holds its lock.

    :raises ConfigurationError: when entered, if this program did not make the folder, or the folder is in use.
    """

    def __init__(self, path: Union[str, Path]) -> None:
        self.path = Path(os.path.abspath(path))
        self._marker: Optional[int] = None
        self._together: Optional[List[Path]] = None  # the folders of trials that wait to get their names

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
        """Write a file as a whole, from pieces (bytes) that come one after another."""
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
        """Write the folder of a trial that has no outputs: only trial.json."""
        with self._whole_trial(result):
            pass

    @contextlib.contextmanager
    def _whole_trial(self, result: Result) -> Iterator[Path]:
        """Give a new folder for a trial. Afterwards it gets trial.json, and replaces the trial's old folder."""
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
        """Give the trials of this context their names at its end, so that they wait for the disk only once."""
        self._together = []
        try:
            yield
        finally:
            finals, self._together = self._together or [], None
            try:
                _settle(finals)
            except KeyboardInterrupt:  # the trials are complete, so they are kept
                _settle(finals)
                raise

    def place(self, name: str) -> Path:
        """Return the path of a trial's folder. :raises ConfigurationError: if ``name`` is no ID of a trial."""
        if not _ID.match(name):
            raise ConfigurationError(f'{name!r} is no id of a trial')
        return self.path / 'trials' / name


def opened(content: bytes) -> tarfile.TarFile:
    """Return the archive in these bytes, opened. It may be compressed by gzip."""
    mode = 'r:gz' if content[:len(_GZIP)] == _GZIP else 'r:'  # 'r:*' tries all kinds each time
    return tarfile.open(fileobj=io.BytesIO(content), mode=mode)


def result_in(archive: tarfile.TarFile) -> Result:
    """Return the Result in a trial's outputs. :raises ConfigurationError, LookupError, ValueError: if there is none."""
    content: Any = loads_cleaned(opened_member(archive, 'trial.json').read())
    return records.result_of(content, str(content.get('id')), 'trial.json')


def read_planned(path: Union[str, Path], plan: Plan, planned: Planned) -> Optional[Result]:
    """Return what records.read_planned() returns, but None also if trial.json cannot be understood."""
    try:
        return records.read_planned(str(path), plan, planned)
    except ConfigurationError:
        return None


def remove_trial(path: Path) -> None:
    """Remove a trial's folder that this program made, if it exists.

    :raises ConfigurationError: naming a file in it that this program has not made.
    """
    logs = path / 'logs'
    if path.is_dir() and not path.is_symlink():
        LOGS.remove(logs)
    TRIAL.remove(path)


def check_trial(path: Path) -> None:
    """Check that a trial's folder, if it exists, holds only files of this program.

    :raises ConfigurationError: naming another one.
    """
    if path.is_dir() and not path.is_symlink():
        LOGS.check(path / 'logs')
    TRIAL.check(path, ('logs',))


def _settle(finals: List[Path]) -> None:
    """Give the filled folders of trials their names, when all of them are on the disk."""
    pairs = [(final.with_name(final.name + UNFINISHED), final) for final in finals]
    pairs = [(part, final) for part, final in pairs if part.is_dir()]  # others may have their names already
    for part, _ in pairs:
        on_disk(part)
    for part, final in pairs:
        with contextlib.suppress(ConfigurationError):  # checked before; files of others that came since stay
            remove_trial(final)
            os.rename(part, final)


def checked_members(archive: tarfile.TarFile) -> List[tarfile.TarInfo]:
    """Return an archive's members. :raises ConfigurationError: for one that is no plain file with a plain name."""
    members, total = [], 0
    for member in archive:
        total += member.size
        if not member.isreg() or not _MEMBER.match(member.name) or total > _MOST_BYTES:
            raise ConfigurationError(f'the outputs of a trial hold {member.name!r}; allowed: plain files in its '
                                     f'folder, at most {_MOST_BYTES} bytes')
        members.append(member)
    return members


def _unpack(archive: tarfile.TarFile, info: tarfile.TarInfo, path: Path) -> None:
    with new_file(path, 'xb') as stream:  # the folder gets its name only when all of it is on the disk
        shutil.copyfileobj(opened_member(archive, info.name), stream)


def opened_member(archive: tarfile.TarFile, name: str) -> IO[bytes]:
    """Return a member of an archive, opened. :raises KeyError: if there is no plain file of that name."""
    found = archive.extractfile(name)
    if found is None:
        raise KeyError(name)
    return found


def member(archive: tarfile.TarFile, name: str) -> Optional[bytes]:
    """Return the content of a member of an archive; None if there is none of that name."""
    return opened_member(archive, name).read() if name in archive.getnames() else None
