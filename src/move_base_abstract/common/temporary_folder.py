"""A folder for the temporary files of one run, so that files of one run do not change the next one.

Names of temporary files are functions of the seed, so files of an earlier run have the names that the next one would
take. The folder has the same path in each run, because programs may show it. Runs beside each other have one folder
each, with paths of the same length: the environment lies on a program's stack, where a longer path would move all
addresses. The folder is empty at first. Files that a run has left in it are never deleted: they are moved aside, and a
message says where they are.
"""
from __future__ import annotations

import contextlib
import fcntl
import os
import stat
import tempfile
from typing import Callable, Iterator, Optional

_MOST = 64  # runs beside each other; numbers have two digits


@contextlib.contextmanager
def temporary_folder(say: Callable[[str], None]) -> Iterator[Optional[str]]:
    """Make a folder for the run; yield its path, or None if it cannot be made. ``say(line)`` prints a message."""
    base = os.path.join(tempfile.gettempdir(), 'move_base_abstract_run_{}'.format(os.getuid()))
    for number in range(1, _MOST + 1):
        path = '{}_{:02d}'.format(base, number)
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


def clear_left(path: str, say: Callable[[str], None]) -> None:
    """Do what :func:`temporary_folder` does at its end, for a process that was killed, unless another run has it."""
    held = _hold(path) if os.path.isdir(path) else None
    if held is not None:
        _leave(path, held, say)


def _leave(path: str, held: int, say: Callable[[str], None]) -> None:
    _clear(path, say)
    with contextlib.suppress(OSError):  # it is not empty, and a message has said so
        os.rmdir(path)
    os.close(held)


def _hold(path: str) -> Optional[int]:
    """Make or take the folder and lock it; return its descriptor, or None if it is another run's or somebody else's."""
    held = None
    try:
        with contextlib.suppress(FileExistsError):
            os.mkdir(path, 0o700)
        held = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC)
        fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
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
