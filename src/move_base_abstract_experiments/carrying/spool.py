"""The spool: the folder for outputs of trials of workers on this computer, so that they survive if a worker dies.

    SPOOL/KEY/0003.tar    the complete outputs of the trial with this number in the batch KEY
    SPOOL/KEY/begun       the number of the trial that was begun last

The spool is a temporary folder of the client. If a worker dies in a batch, the next one finds here which of the batch's
trials are complete, and which one was under way.
"""
from __future__ import annotations

import contextlib
import errno
import os
import shutil
from typing import Optional

_BEGUN = 'begun'


class Notes:
    """The notes about one batch; ``path``: its folder."""

    def __init__(self, path: str) -> None:
        self.path = path

    def begin(self, number: int) -> None:
        """Note that the trial of this number begins."""
        os.makedirs(self.path, exist_ok=True)
        with open(os.path.join(self.path, _BEGUN), 'w', encoding='utf-8') as stream:
            stream.write(f'{number}\n')

    def begun(self) -> Optional[int]:
        """Return the number of the trial that was begun last, or None."""
        try:
            with open(os.path.join(self.path, _BEGUN), encoding='utf-8') as stream:
                return int(stream.read())
        except (FileNotFoundError, ValueError):
            return None

    def place(self, number: int) -> str:
        """Return the path of a trial's outputs."""
        return os.path.join(self.path, f'{number:04d}.tar')

    def has(self, number: int) -> bool:
        """Return whether a trial has left outputs, as a failed one does, too."""
        return os.path.exists(self.place(number))

    def take(self, number: int) -> Optional[bytes]:
        """Return the outputs of a trial (bytes) and remove them here; None if there are none."""
        try:
            with open(self.place(number), 'rb') as stream:
                content = stream.read()
        except FileNotFoundError:
            return None
        os.unlink(self.place(number))
        return content

    def remove(self, count: int) -> None:
        """Remove everything that a batch of ``count`` trials may have left."""
        with contextlib.suppress(FileNotFoundError):
            names = set(os.listdir(self.path))
            for path in (os.path.join(self.path, _BEGUN), *map(self.place, range(count))):
                for one in (path, path + '.part'):
                    if os.path.basename(one) in names:
                        os.unlink(one)
            os.rmdir(self.path)


def move(source: str, target: str) -> None:
    """Move a file so that it appears as a whole, also between file systems."""
    try:
        os.rename(source, target)
    except OSError as problem:
        if problem.errno != errno.EXDEV:
            raise
        shutil.copyfile(source, target + '.part')
        os.rename(target + '.part', target)
