"""The preloaded library that stands in front of libc for the C libraries that a Python program loads.

Its source is src/python_shim. It takes itself out of the environment, so that programs that this one starts do not
have it. :mod:`native` is its Python side.
"""
from __future__ import annotations

import ctypes
from typing import Dict

from . import binary

LIBRARY = 'libmove_base_abstract_python_shim.so'
_CELLS = 'move_base_abstract_native_cells'


def is_loaded() -> bool:
    """Return whether this process has the library."""
    return hasattr(ctypes.PyDLL(None), _CELLS)


def preload(environment: Dict[str, str]) -> bool:
    """Add the library to the environment of a Python that is about to start; return whether that is a change."""
    if LIBRARY in environment.get(binary.PRELOAD, ''):
        return False  # the system has not loaded it into this process, so it will not load it into the next one
    try:
        environment[binary.PRELOAD] = binary.preloaded(LIBRARY, environment)
    except ValueError:
        return False
    return True
