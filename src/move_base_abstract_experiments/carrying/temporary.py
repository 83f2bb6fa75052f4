"""Temporary folders of this program's own: marked, locked while they are used, removed at the end or by the next run.

A process that is killed leaves its folder. Only a folder that carries our mark, is this user's and that nobody has
locked is ever removed.
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
    """Give a new folder, whose name begins with the prefix, in the system's folder for such; remove it at the end.

    Those by the prefix that killed processes have left are removed first.
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
    """Remove the folders by the prefix that killed processes have left; return their paths."""
    removed = []
    for path in sorted(glob.glob(os.path.join(glob.escape(tempfile.gettempdir()), glob.escape(prefix) + '*'))):
        with contextlib.suppress(SimulatorError, OSError):
            status = os.lstat(os.path.join(path, MARKER))
            if os.path.islink(path) or status.st_size == 0 or status.st_uid != os.getuid():
                continue
            marker = KIND.make(path)  # it is ours, and nobody has it locked, or an error
            try:
                shutil.rmtree(path, ignore_errors=True)
                removed.append(path)
            finally:
                os.close(marker)
    return removed
