"""Whether this process has the library that stands in front of libc, for what Python loads of libraries in C.

It is preloaded (src/python_shim), and sees to it that the programs that this one starts do not have it. What it is
told and asks is in :mod:`native`.
"""
import ctypes
import os

from . import binary

LIBRARY = 'libmove_base_abstract_python_shim.so'
_PRELOAD = 'LD_PRELOAD'
_CELLS = 'move_base_abstract_native_cells'


def is_loaded():
    """Return whether this process has it."""
    return hasattr(ctypes.PyDLL(None), _CELLS)


def preload(environment):
    """Add it to an environment in which a Python is about to be started; return whether that makes a difference."""
    words = environment.get(_PRELOAD, '').replace(':', ' ').split()
    if any(os.path.basename(word) == LIBRARY for word in words):
        return False  # the system did not load it here, and so will not
    try:
        path = binary.find_shim(environment, LIBRARY)
    except ValueError:
        return False
    environment[_PRELOAD] = ' '.join([path, *words])
    return True
