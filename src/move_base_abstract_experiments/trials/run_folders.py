"""The folders in which a run leaves what it leaves."""
from __future__ import annotations

import os
import stat
from typing import Any, NamedTuple

LOG, MESSAGES = 'events.jsonl', 'messages.jsonl'  # the names of files in a run's own folder
PRINTED = OUTPUT, PRINTS = 'function.txt', 'trial.txt'  # what a trial's function, and its process, print
_OWNERS = stat.S_IRUSR | stat.S_IWUSR
RUN = 'run'  # the name of the folder below a trial's own


class Folders(NamedTuple):
    """Where a run leaves what: its event log and messages, the nodes' own files, what they print."""

    own: str
    files: str
    logs: str

    @property
    def log(self) -> str:
        """The path of the event log."""
        return os.path.join(self.own, LOG)

    @property
    def messages(self) -> str:
        """The path of recorded messages."""
        return os.path.join(self.own, MESSAGES)


def make_folders(path: str) -> Folders:
    """Make the Folders of a run, below a folder in which nothing is but perhaps these, empty."""
    folders = _below(path)
    for one in folders:
        os.makedirs(one, exist_ok=True)
    return folders


def _below(path: str) -> Folders:
    return Folders(path, os.path.join(path, 'files'), os.path.join(path, 'logs'))


def is_as_new(entry: Any) -> bool:
    """Return whether an entry of a folder is a file in which nothing was printed: the next trial may print into it."""
    about = entry.stat(follow_symlinks=False)
    return (entry.name in PRINTED and stat.S_ISREG(about.st_mode) and about.st_size == 0 and about.st_nlink == 1
            and stat.S_IMODE(about.st_mode) & _OWNERS == _OWNERS)


def empty_again(path: str) -> bool:
    """Empty a folder in which make_folders() has made others; return whether all is as it was when they were new.

    For the next trial: three folders that are made and removed cost more than the files in them. Of what was printed
    empty files stay.
    """
    folders = _below(path)
    own = os.lstat(path)
    try:
        for folder in folders:
            about = os.lstat(folder)
            if not stat.S_ISDIR(about.st_mode) or (about.st_mode, about.st_uid) != (own.st_mode, own.st_uid):
                return False
            with os.scandir(folder) as entries:
                for entry in entries:
                    if entry.path not in folders and not (folder == folders.logs and is_as_new(entry)):
                        os.unlink(entry.path)
    except OSError:  # a folder in it, for one
        return False
    return True
