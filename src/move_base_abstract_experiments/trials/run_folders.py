"""The folders into which a run writes its files."""
from __future__ import annotations

import os
import stat
from typing import Any, NamedTuple

LOG, MESSAGES = 'events.jsonl', 'messages.jsonl'  # the names of files in a run's own folder
PRINTED = OUTPUT, PRINTS = 'function.txt', 'trial.txt'  # the prints of a trial's function and of its process
_OWNERS = stat.S_IRUSR | stat.S_IWUSR
RUN = 'run'  # the name of a run's folder, in that of its trial


class Folders(NamedTuple):
    """The folders of a run, as paths."""

    own: str  # for the event log and recorded messages
    files: str  # the nodes' working folder
    logs: str  # for the nodes' prints and logs

    @property
    def log(self) -> str:
        """The path of the event log."""
        return os.path.join(self.own, LOG)

    @property
    def messages(self) -> str:
        """The path of recorded messages."""
        return os.path.join(self.own, MESSAGES)


def make_folders(path: str) -> Folders:
    """Make the Folders of a run in a folder that holds nothing, or these folders, empty."""
    folders = _below(path)
    for one in folders:
        os.makedirs(one, exist_ok=True)
    return folders


def _below(path: str) -> Folders:
    return Folders(path, os.path.join(path, 'files'), os.path.join(path, 'logs'))


def is_as_new(entry: Any) -> bool:
    """Return whether an entry of a folder is an empty file for prints, which the next trial can use."""
    about = entry.stat(follow_symlinks=False)
    return (entry.name in PRINTED and stat.S_ISREG(about.st_mode) and about.st_size == 0 and about.st_nlink == 1
            and stat.S_IMODE(about.st_mode) & _OWNERS == _OWNERS)


def empty_again(path: str) -> bool:
    """Empty the folders that make_folders() has made for the next trial; return whether they are as new.

    To make and remove three folders takes longer than to remove the files in them. Empty files for prints stay.
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
    except OSError:  # for example because there is a folder in it
        return False
    return True
