"""Where a result comes from: the versions of what computed it, and the machine."""

import functools
import importlib.metadata
import os
import platform
import re
from pathlib import Path

LIBRARIES = ('numpy', 'scipy', 'PyKrige', 'gstools', 'Mesa', 'matplotlib')


@functools.lru_cache(maxsize=1)
def package_version():
    """Return the version of this package as its package.xml says, in the source tree or installed; or 'unknown'."""
    for folder in Path(__file__).resolve().parents[2:6]:
        for file in (folder / 'package.xml', folder / 'share' / 'move_base_abstract' / 'package.xml'):
            if file.is_file():
                found = re.search(r'<version>\s*([^<\s]+)\s*</version>', file.read_text(encoding='utf-8'))
                return found.group(1) if found else 'unknown'
    return 'unknown'


@functools.lru_cache(maxsize=1)
def versions():
    """Return the versions of Python and of the libraries that are installed, by name."""
    found = {'python': platform.python_version()}
    for name in LIBRARIES:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    return found


@functools.lru_cache(maxsize=1)
def machine():
    """Return what is known of the machine: system, processor, number of usable cores."""
    return {'system': platform.platform(), 'processor': _processor(), 'cores': len(os.sched_getaffinity(0))}


def _processor():
    try:
        with open('/proc/cpuinfo', encoding='utf-8') as stream:
            names = [line.split(':', 1)[1].strip() for line in stream if line.startswith('model name')]
    except OSError:
        names = []
    return names[0] if names else platform.machine()
