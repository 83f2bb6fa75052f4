"""The outputs of a trial: an archive of trial.json, the event log, recorded messages and files, and nodes' prints.

Programs of users have made these files, so their names and kinds may be anything; they must not disturb other trials.
Names are escaped as in URLs ('result 0.csv' is files-result%200.csv). Folders are left out. A file that is no plain
file, or cannot be read, is left out, too, and an error names it.
"""
from __future__ import annotations

import fnmatch
import hashlib
import io
import json
import os
import stat
import tarfile
import urllib.parse
from typing import IO, Any, List, Optional, Sequence, Tuple

from ..records import Result
from . import run_folders
from .run_folders import Folders

Members = List[Tuple[str, str]]  # (path, name in the archive)
OUTPUTS = 'outputs.tar'
MOST_BYTES = 512 * 1024 * 1024  # the largest size of a trial's outputs, before they are packed
_COMPRESSED_FROM = 8 * 1024 * 1024  # bytes; less than that travels faster uncompressed
_MOST_LOG_BYTES = 1 << 20  # of the output of a node; the end is kept
_LONGEST_NAME = 200  # bytes of an escaped name; while a file is written, its name has another ending
_LONGEST_END = 20
_CUT = b'... (the beginning is left out)\n'


def safe_name(name: str) -> str:
    """Return a file's name escaped to letters, digits, '_', '.', '-' and '%'; different names stay different."""
    raw = os.fsencode(name)
    safe = urllib.parse.quote(raw, safe='').replace('~', '%7E')
    if safe[0] in '.-':
        safe = f'%{raw[0]:02X}{safe[1:]}'
    if len(safe) <= _LONGEST_NAME:
        return safe
    end = os.path.splitext(safe)[1][-_LONGEST_END:]
    return f'{safe[:_LONGEST_NAME - 60].rstrip("%")}-{hashlib.sha256(raw).hexdigest()[:16]}{end.lstrip("%")}'


def is_plain(path: str) -> bool:
    """Return whether there is a plain file at a path; a link is not followed."""
    try:
        return stat.S_ISREG(os.lstat(path).st_mode)
    except OSError:
        return False


def _is_plain_and_not_empty(path: str) -> bool:
    """Return whether there is a plain file at a path that is not empty. Most nodes print nothing."""
    return is_plain(path) and os.lstat(path).st_size > 0


def pack(path: str, folders: Optional[Folders], patterns: Sequence[str], result: Result, has_all_logs: bool) -> None:
    """Write OUTPUTS into a trial's folder.

    path: the trial's folder. folders: those of the run, or None. patterns: of the names of files to keep. result: goes
    into trial.json; gets an error if something is left out. has_all_logs: whether to add the nodes' log files, and the
    prints of the trial's own process, to the prints of the nodes.
    """
    members = [] if folders is None else _recorded(folders, patterns, result)
    if sum(os.lstat(source).st_size for source, _ in members) > MOST_BYTES:
        result.fail(f'its outputs are more than {MOST_BYTES} bytes, the most that are kept')
        members, has_all_logs = [], True
    members += _prints(path, folders, has_all_logs)
    told = json.dumps(result.written, allow_nan=False).encode()
    size = sum(os.lstat(source).st_size for source, _ in members)
    part = os.path.join(path, OUTPUTS + '.part')
    packing: Any = {'mode': 'w:gz', 'compresslevel': 1} if size > _COMPRESSED_FROM else {'mode': 'w'}
    with tarfile.open(part, **packing, format=tarfile.GNU_FORMAT) as archive:
        _add(archive, 'trial.json', io.BytesIO(told), len(told))
        for source, name in members:
            with open(source, 'rb') as stream:
                _add(archive, name, stream, os.fstat(stream.fileno()).st_size)
    os.rename(part, os.path.join(path, OUTPUTS))


def _add(archive: tarfile.TarFile, name: str, stream: IO[bytes], size: int) -> None:
    about_file = tarfile.TarInfo(name)  # the owner and the time of the file are left out
    about_file.size = size
    archive.addfile(about_file, stream)


def _prints(path: str, folders: Optional[Folders], has_all: bool) -> Members:
    """Return [(path, name in the archive)] for the prints of nodes and of the trial's process."""
    found = []
    if folders is not None:
        ends = ('.txt', '.log') if has_all else ('.txt',)
        found = [(os.path.join(folders.logs, name), 'logs/' + safe_name(name))
                 for name in sorted(os.listdir(folders.logs)) if name.endswith(ends)]
    if has_all and not any(name == 'logs/' + run_folders.PRINTS for _, name in found):
        found.append((os.path.join(path, run_folders.PRINTS), 'logs/' + run_folders.PRINTS))
    return [(source, name) for source, name in found if _is_plain_and_not_empty(source) and _cut(source)]


def _recorded(folders: Folders, patterns: Sequence[str], result: Result) -> Members:
    """Return [(path, name in the archive)] for the recorded files; the result gets an error if some cannot be kept."""
    found = [(os.path.join(folders.own, name), name) for name in (run_folders.LOG, run_folders.MESSAGES)]
    found = [(source, name) for source, name in found if os.path.lexists(source)]
    found += [(os.path.join(folders.files, name), 'files-' + safe_name(name))
              for name in _names_to_keep(folders, patterns)]
    left_out = {name: why for source, name in found for why in [_problem(source)] if why}
    if left_out and result.error is None:
        name, why = sorted(left_out.items())[0]
        result.error = f'{len(left_out)} of its files are not kept; {name}: {why}'
    return [(source, name) for source, name in found if name not in left_out]


def _names_to_keep(folders: Folders, patterns: Sequence[str]) -> List[str]:
    """Return the names of files in the nodes' working folder that match one of the patterns, sorted."""
    return [name for name in sorted(os.listdir(folders.files))
            if any(fnmatch.fnmatchcase(name, pattern) for pattern in patterns)
            and not os.path.isdir(os.path.join(folders.files, name))]


def _problem(path: str) -> Optional[str]:
    """Return why a file cannot be kept, or None."""
    if not is_plain(path):
        return 'it is no plain file'
    try:
        with open(path, 'rb'):
            return None
    except OSError as problem:
        return f'it cannot be read: {problem.strerror}'


def _cut(path: str) -> bool:
    """Cut a long output, so that only its end is left; return whether it can be read."""
    try:
        with open(path, 'rb') as stream:
            size = os.fstat(stream.fileno()).st_size
            stream.seek(max(0, size - _MOST_LOG_BYTES))
            end = stream.read(_MOST_LOG_BYTES) if size > _MOST_LOG_BYTES else None
        if end is not None:
            with open(path, 'wb') as stream:
                stream.write(_CUT + end)
    except OSError:
        return False
    return True
