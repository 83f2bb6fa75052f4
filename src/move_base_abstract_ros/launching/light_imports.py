"""Import roslaunch without numpy and setuptools, which it brings along and does not need: in half of the time.

genpy asks numpy whether a message's field is an array. rosclean asks distutils, which setuptools replaces by its own,
for one function. Both work without.
"""
import contextlib
import sys


@contextlib.contextmanager
def light():
    """Import without them inside the context. The process must not publish messages with arrays of numpy."""
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
