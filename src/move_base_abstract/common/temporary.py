"""Temporary folders of our programs. They are locked while they are in use, by their makers or forks of these.

A folder of :func:`make` is for the program's own files. It has our marker, and is removed at the end. If the program is
killed, :func:`remove_left` removes it, which each guard calls: only if it has the marker, belongs to this user and is
not locked; or if it has our name and is empty, because the program was killed before the marker was there.

A :func:`temporary_folder` is for what the programs of one run put into TMPDIR, so that files of one run do not change
the next one. Names of temporary files are functions of the seed, so files of an earlier run have the names that the
next one would take. The folder has the same path in each run, because programs may show it. Runs beside each other have
one folder each, with paths of the same length: the environment lies on a program's stack, where a longer path would
move all addresses. The folder is empty at first. Files that a run has left in it are never deleted: they are moved
aside, and a message says where they are.
"""
from __future__ import annotations

import contextlib
import fcntl
import glob
import os
import re
import shutil
import stat
import tempfile
from typing import Callable, Dict, Iterator, List, Optional

from .errors import SimulatorError
from .own_files import MARKER, FolderKind

KIND = FolderKind('temporary folder')
PREFIX = 'move_base_abstract_'
_MADE = re.compile(PREFIX + '([a-z]+_)*[a-z0-9_]{8}')  # the names that make() gives
_MOST = 64  # runs beside each other; numbers have two digits
_markers: Dict[str, int] = {}  # the descriptors of the markers, by the paths of this process's folders


def make(name: str) -> str:
    """Return the path of a new folder, whose name begins with PREFIX and ``name``."""
    while True:
        path = tempfile.mkdtemp(prefix=PREFIX + name)
        held = _hold(path, fcntl.LOCK_EX)
        if held is not None or os.path.isdir(path):  # folders may have no locks, on some file systems
            break
    try:
        _markers[path] = KIND.make(path)
    finally:
        if held is not None:
            os.close(held)
    return path


def remove(path: str) -> None:
    """Remove a folder of :func:`make`. If a process still writes there, the guard removes it in the end."""
    _delete(path)
    _release(path)


def _delete(path: str) -> None:
    """Delete a folder, its marker last: what cannot be deleted now can be later."""
    with contextlib.suppress(OSError):
        for name in os.listdir(path):
            one = os.path.join(path, name)
            if os.path.isdir(one) and not os.path.islink(one):
                shutil.rmtree(one, ignore_errors=True)
            elif name != MARKER:
                os.unlink(one)
        if os.listdir(path) == [MARKER]:
            os.unlink(os.path.join(path, MARKER))
        os.rmdir(path)


def keep(path: str) -> None:
    """Let a folder of :func:`make` stay for the user, unless it is empty."""
    with contextlib.suppress(OSError):
        os.unlink(os.path.join(path, MARKER))
    _release(path)


def let_go() -> None:
    """Hold no folder of the process whose fork this is."""
    for path in list(_markers):
        _release(path)


def _release(path: str) -> None:
    """Give up the lock of a folder, if this process has it."""
    if path in _markers:
        os.close(_markers.pop(path))


@contextlib.contextmanager
def folder(name: str) -> Iterator[str]:
    """Give a folder of :func:`make` that exists in the context; remove those that killed programs have left before."""
    remove_left()
    path = make(name)
    try:
        yield path
    finally:
        remove(path)


def remove_left() -> List[str]:
    """Remove the folders of :func:`make` that killed programs have left; return their paths."""
    removed = []
    for path in sorted(glob.glob(os.path.join(glob.escape(tempfile.gettempdir()), PREFIX + '*'))):
        with contextlib.suppress(SimulatorError, OSError):
            if os.path.islink(path):
                continue
            if _MADE.fullmatch(os.path.basename(path)) and _has_no_mark(path):
                removed += [path] if _remove_empty(path) else []
                continue
            status = os.lstat(os.path.join(path, MARKER))
            if status.st_size == 0 or status.st_uid != os.getuid():
                continue
            marker = KIND.make(path)  # an error if it is not ours, or is locked
            try:
                _delete(path)
                removed.append(path)
            finally:
                os.close(marker)
    return removed


def _has_no_mark(path: str) -> bool:
    """Return whether a folder is as make() leaves it if its process is killed: empty, or with an empty marker."""
    names = os.listdir(path)
    return not names or (names == [MARKER] and os.path.getsize(os.path.join(path, MARKER)) == 0)


def _remove_empty(path: str) -> bool:
    """Remove a folder without a mark, if it is this user's and make() is not at work there; return whether it was."""
    held = _hold(path)
    if held is None:
        return False
    try:
        if _has_no_mark(path):
            _delete(path)
        return not os.path.isdir(path)
    finally:
        os.close(held)


@contextlib.contextmanager
def temporary_folder(say: Callable[[str], None]) -> Iterator[Optional[str]]:
    """Make a folder for the run; yield its path, or None if it cannot be made. ``say(line)`` prints a message."""
    for path in _paths():
        held = _hold(path)
        if held is None:  # another run may just have removed it
            held = _hold(path)
        if held is not None:
            break
    else:
        yield None
        return
    try:
        _clear(path, say)
        yield path
    finally:
        _leave(path, held, say)


def is_beside_another_run(path: str) -> bool:
    """Return whether ``path`` is a folder of :func:`temporary_folder` that a run has because another one goes on."""
    return re.fullmatch(re.escape(PREFIX) + r'run_\d+_(?!01)\d\d', os.path.basename(path)) is not None


def clear_left(say: Callable[[str], None]) -> None:
    """Do what :func:`temporary_folder` does at its end, for programs that were killed."""
    for path in _paths():
        held = _hold(path) if os.path.isdir(path) else None
        if held is not None:
            _leave(path, held, say)


def _paths() -> List[str]:
    base = os.path.join(tempfile.gettempdir(), '{}run_{}'.format(PREFIX, os.getuid()))
    return ['{}_{:02d}'.format(base, number) for number in range(1, _MOST + 1)]


def _leave(path: str, held: int, say: Callable[[str], None]) -> None:
    _clear(path, say)
    with contextlib.suppress(OSError):  # it is not empty, and a message has said so
        os.rmdir(path)
    os.close(held)


def _hold(path: str, lock: int = fcntl.LOCK_EX | fcntl.LOCK_NB) -> Optional[int]:
    """Make or take the folder and lock it; return its descriptor, or None if it is another run's or somebody else's."""
    held = None
    try:
        with contextlib.suppress(FileExistsError):
            os.mkdir(path, 0o700)
        held = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC)
        fcntl.flock(held, lock)
        found = os.fstat(held)
        is_ours = found.st_uid == os.getuid() and stat.S_IMODE(found.st_mode) == 0o700
        if is_ours and os.path.samestat(found, os.stat(path, follow_symlinks=False)):
            return held
    except OSError:  # another run's, or somebody else's
        pass
    if held is not None:
        os.close(held)
    return None


def _clear(path: str, say: Callable[[str], None]) -> None:
    """Move all files in the folder, in the order of their names, into a new folder beside it."""
    try:
        names = sorted(os.listdir(path))
        if not names:
            return
        aside = tempfile.mkdtemp(prefix=os.path.basename(path) + '_left_', dir=os.path.dirname(path))
        for name in names:
            os.rename(os.path.join(path, name), os.path.join(aside, name))
    except OSError as error:
        say('{}: the files that a run has left there cannot be moved aside: {}'.format(path, error.strerror))
    else:
        say('the files that the programs left in their temporary folder are in {}'.format(aside))
