"""A folder for the temporary files of one run, so that files of one run do not change the next one.

Names of temporary files are functions of the seed, so that the files of an earlier run have the names that the next
one would take. The folder has the same path in each run, since programs may show it; runs beside each other have one
each, whose paths are equally long: the environment lies on a program's stack, so that a longer one moves all addresses
there. It is empty at first. What a run has left in it is never deleted: it is moved aside, and told.
"""
from __future__ import annotations

import contextlib
import fcntl
import os
import stat
import tempfile
from typing import Callable, Iterator, Optional

_MOST = 64  # runs beside each other; two digits


@contextlib.contextmanager
def temporary_folder(say: Callable[[str], None]) -> Iterator[Optional[str]]:
    """Have a folder of the run's own; its path is yielded, or None where none can be had. ``say`` takes a line."""
    base = os.path.join(tempfile.gettempdir(), 'move_base_abstract_run_{}'.format(os.getuid()))
    for number in range(1, _MOST + 1):
        path = '{}_{:02d}'.format(base, number)
        held = _hold(path)
        if held is None:  # the run that had it may have removed it just now
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
        _clear(path, say)
        with contextlib.suppress(OSError):  # it is not empty: that was told
            os.rmdir(path)
        os.close(held)


def _hold(path: str) -> Optional[int]:
    """Return a descriptor of this folder of ours while no other run has it; None if that cannot be."""
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
    """Move aside what is in the folder, by name, into a new one."""
    try:
        names = sorted(os.listdir(path))
        if not names:
            return
        aside = tempfile.mkdtemp(prefix=os.path.basename(path) + '_left_', dir=os.path.dirname(path))
        for name in names:
            os.rename(os.path.join(path, name), os.path.join(aside, name))
    except OSError as error:
        say('{}: what a run has left there cannot be moved aside: {}'.format(path, error.strerror))
    else:
        say('what the programs left in their temporary folder is in {}'.format(aside))
