"""Temporary folders of this program: marked, locked while they are in use, removed at the end or by the next run.

A process that is killed leaves its folder. A folder is removed only if it has our marker, belongs to this user and is
not locked.
"""
from __future__ import annotations

import contextlib
import glob
import os
import shutil
import tempfile
from typing import Iterator, List

from move_base_abstract.common.errors import SimulatorError
from move_base_abstract.common.own_files import MARKER, FolderKind

KIND = FolderKind('temporary folder')


@contextlib.contextmanager
def folder(prefix: str) -> Iterator[str]:
    """Give a new temporary folder, whose name begins with the prefix; remove it at the end.

    Folders with the prefix that killed processes have left are removed first.
    """
    remove_left(prefix)
    path = tempfile.mkdtemp(prefix=prefix)
    marker = KIND.make(path)
    try:
        yield path
    finally:
        shutil.rmtree(path, ignore_errors=True)  # made above, by this process
        os.close(marker)


def remove_left(prefix: str) -> List[str]:
    """Remove the temporary folders with the prefix that killed processes have left; return their paths."""
    removed = []
    for path in sorted(glob.glob(os.path.join(glob.escape(tempfile.gettempdir()), glob.escape(prefix) + '*'))):
        with contextlib.suppress(SimulatorError, OSError):
            status = os.lstat(os.path.join(path, MARKER))
            if os.path.islink(path) or status.st_size == 0 or status.st_uid != os.getuid():
                continue
            marker = KIND.make(path)  # an error if it is not ours, or is locked
            try:
                shutil.rmtree(path, ignore_errors=True)
                removed.append(path)
            finally:
                os.close(marker)
    return removed
