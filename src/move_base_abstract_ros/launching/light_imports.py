"""Importing roslaunch without what it brings along and never uses: half of the time that it takes.

genpy asks numpy whether a message's field is one of its arrays; rosclean asks distutils, which setuptools replaces by
its own, for one function. Both do without.
"""
import contextlib
import sys


@contextlib.contextmanager
def light():
    """Import without them meanwhile, in a process that publishes no message with arrays."""
    is_hidden = 'numpy' not in sys.modules
    hack = sys.modules.get('_distutils_hack') if sys.version_info < (3, 12) else None
    if is_hidden:
        sys.modules['numpy'] = None
    if hack is not None:
        hack.remove_shim()
    try:
        yield
    finally:
        if is_hidden:
            del sys.modules['numpy']
        if hack is not None:
            hack.add_shim()
