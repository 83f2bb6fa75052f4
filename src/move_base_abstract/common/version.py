"""The version of this package."""
from __future__ import annotations

import functools
import importlib.metadata
import re
from pathlib import Path


@functools.lru_cache(maxsize=None)
def package_version() -> str:
    """Return the version of this package, from its package.xml or from pip, or 'unknown'."""
    for folder in list(Path(__file__).resolve().parents)[2:7]:
        for file in (folder / 'package.xml', folder / 'share' / 'move_base_abstract' / 'package.xml'):
            if file.is_file():
                found = re.search(r'<version>\s*([^<\s]+)\s*</version>', file.read_text(encoding='utf-8'))
                return found.group(1) if found else 'unknown'
    try:
        return importlib.metadata.version('move_base_abstract')  # installed by pip
    except importlib.metadata.PackageNotFoundError:
        return 'unknown'
