"""Where a result comes from: the versions of programs and libraries, and the machine."""
from __future__ import annotations

import ctypes
import functools
import importlib.metadata
import os
import platform
from typing import Dict, List, Union

KERNEL_NAMES = ('openblas_get_corename', 'openblas_get_corename64_', 'scipy_openblas_get_corename',
                'scipy_openblas_get_corename64_')  # OpenBLAS's names of the function, by the way of its build
LIBRARIES = ('numpy', 'scipy', 'PyKrige', 'gstools', 'Mesa', 'matplotlib')


@functools.lru_cache(maxsize=1)
def versions() -> Dict[str, str]:
    """Return {name: version} of Python and of the installed libraries."""
    found = {'python': platform.python_version()}
    for name in LIBRARIES:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    return found


@functools.lru_cache(maxsize=1)
def machine() -> Dict[str, Union[int, str]]:
    """Return a description of the machine: system, processor, number of usable cores, kernels of its BLAS.

    A trial does not depend on these (interpolation/arithmetic.py), but studies that it is compared with may.
    """
    return {'system': platform.platform(), 'processor': _processor(), 'cores': len(os.sched_getaffinity(0)),
            'blas': ', '.join(blas_kernels()) or 'unknown'}


def blas_kernels() -> List[str]:
    """Return the names of the loaded OpenBLAS libraries, each with the kernel that it chose for this processor."""
    try:
        with open('/proc/self/maps', encoding='utf-8') as stream:
            paths = {line.split(maxsplit=5)[-1].strip() for line in stream}
    except OSError:
        return []
    return [f'{os.path.basename(path)} {kernel}'
            for path in sorted(paths) if 'openblas' in os.path.basename(path) for kernel in _kernel_of(path)]


def _kernel_of(path: str) -> List[str]:
    """Return a list with the kernel of a loaded library; empty if it is no OpenBLAS."""
    try:
        library = ctypes.CDLL(path)
    except OSError:
        return []
    for name in KERNEL_NAMES:
        ask = getattr(library, name, None)
        if ask is not None:
            ask.argtypes, ask.restype = [], ctypes.c_char_p
            return [ask().decode('ascii', 'replace')]
    return []


def _processor() -> str:
    try:
        with open('/proc/cpuinfo', encoding='utf-8') as stream:
            names = [line.split(':', 1)[1].strip() for line in stream if line.startswith('model name')]
    except OSError:
        names = []
    return names[0] if names else platform.machine()
