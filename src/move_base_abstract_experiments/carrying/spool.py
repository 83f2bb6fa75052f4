"""Where workers on this computer leave the outputs of trials, so that one that dies takes none with it.

    SPOOL/KEY/0003.tar    the outputs of the trial of this number of the batch KEY, complete
    SPOOL/KEY/begun       the number of the trial that was begun last

The spool is a temporary folder of the client's own. Whoever runs a batch after a worker has died in it finds there
which of its trials are complete, and which one was under way.
"""
from __future__ import annotations

import contextlib
import errno
import os
import shutil
from typing import Optional

_BEGUN = 'begun'


class Notes:
    """What is known of one batch; ``path``: its folder."""

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
        """Return whether a trial is complete, that is, has left outputs, as a failed one does."""
        return os.path.exists(self.place(number))

    def take(self, number: int) -> Optional[bytes]:
        """Return the outputs of a trial (bytes), which then are here no more; None if there are none."""
        try:
            with open(self.place(number), 'rb') as stream:
                content = stream.read()
        except FileNotFoundError:
            return None
        os.unlink(self.place(number))
        return content

    def remove(self, count: int) -> None:
        """Remove all that a batch of so many trials may have left."""
        with contextlib.suppress(FileNotFoundError):
            names = set(os.listdir(self.path))
            for path in (os.path.join(self.path, _BEGUN), *map(self.place, range(count))):
                for one in (path, path + '.part'):
                    if os.path.basename(one) in names:
                        os.unlink(one)
            os.rmdir(self.path)


def move(source: str, target: str) -> None:
    """Move a file, which appears as a whole."""
    try:
        os.rename(source, target)
    except OSError as problem:
        if problem.errno != errno.EXDEV:
            raise
        shutil.copyfile(source, target + '.part')
        os.rename(target + '.part', target)
