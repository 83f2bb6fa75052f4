"""The preloaded library that stands in front of libc for the C libraries that a Python program loads.

Its source is src/python_shim. It takes itself out of the environment, so that programs that this one starts do not
have it. :mod:`native` is its Python side.
"""
from __future__ import annotations

import ctypes
import os
from typing import Dict

from . import binary

LIBRARY = 'libmove_base_abstract_python_shim.so'
_PRELOAD = 'LD_PRELOAD'
_CELLS = 'move_base_abstract_native_cells'


def is_loaded() -> bool:
    """Return whether this process has the library."""
    return hasattr(ctypes.PyDLL(None), _CELLS)


def preload(environment: Dict[str, str]) -> bool:
    """Add the library to the environment of a Python that is about to start; return whether that is a change."""
    words = environment.get(_PRELOAD, '').replace(':', ' ').split()
    if any(os.path.basename(word) == LIBRARY for word in words):
        return False  # the system has not loaded it into this process, so it will not load it into the next one
    try:
        path = binary.find_shim(environment, LIBRARY)
    except ValueError:
        return False
    environment[_PRELOAD] = ' '.join([path, *words])
    return True
