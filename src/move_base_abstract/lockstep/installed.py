"""Which files belong to an installed distribution, wherever it lies: ``pip install --target`` makes such folders.

An installer leaves a folder ``NAME.dist-info`` beside what it installs, with a list of the files (RECORD). No ROS.
"""
from __future__ import annotations

import csv
import os
from functools import lru_cache
from typing import TYPE_CHECKING, FrozenSet, Set

if TYPE_CHECKING:
    pass

_SHARED = {'', '.', '..', 'bin'}  # folders that are nobody's alone
_LARGEST = 16 * 1024 * 1024  # bytes of a list that are looked at


def is_installed(path: str) -> bool:
    """Return whether a file or a folder has been installed as a part of a distribution."""
    folder, name = os.path.split(path.rstrip(os.sep))
    while name:
        if name in _tops(folder):
            return True
        folder, name = os.path.split(folder)
    return False


@lru_cache(maxsize=None)
def _tops(folder: str) -> FrozenSet[str]:
    """Return the names of files and folders in ``folder`` that distributions beside them list as theirs."""
    try:
        infos = sorted(name for name in os.listdir(folder) if name.endswith('.dist-info'))
    except OSError:
        return frozenset()
    return frozenset(name for info in infos for name in _listed(os.path.join(folder, info, 'RECORD')))


def _listed(path: str) -> Set[str]:
    try:
        with open(path, encoding='utf-8', errors='replace', newline='') as stream:
            rows = csv.reader(stream.read(_LARGEST).splitlines())
            return {row[0].partition('/')[0] for row in rows if row} - _SHARED
    except (OSError, csv.Error):
        return set()
