"""Finds out whether a file belongs to an installed distribution, in any folder, as ``pip install --target`` makes them.

An installer leaves a folder ``NAME.dist-info`` beside the files that it installs, with a list of them (RECORD).
"""
from __future__ import annotations

import csv
import os
from functools import lru_cache
from typing import FrozenSet, Set

_SHARED = {'', '.', '..', 'bin'}  # folders that do not belong to one distribution alone
_LARGEST = 16 * 1024 * 1024  # the most bytes that are read of a list


def is_installed(path: str) -> bool:
    """Return whether the file or folder ``path`` was installed as a part of a distribution."""
    folder, name = os.path.split(path.rstrip(os.sep))
    while name:
        if name in _tops(folder):
            return True
        folder, name = os.path.split(folder)
    return False


@lru_cache(maxsize=None)
def _tops(folder: str) -> FrozenSet[str]:
    """Return the names of files and folders in ``folder`` that are listed by the distributions in it."""
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
