"""What the tests of all folders share: the sources on the path, and by day those of the night are left out."""
import sys
from pathlib import Path

from night import pytest_collection_modifyitems

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'src'))  # pytest of Debian 11 has no `pythonpath`

__all__ = ['pytest_collection_modifyitems']

LONGEST_ID = 60  # characters of one value; a name of millions can neither be typed nor read


def pytest_make_parametrize_id(val, argname):
    """Return a short id for a long text, None for pytest's own."""
    if isinstance(val, (str, bytes)) and len(val) > LONGEST_ID:
        return '{}_of_{}_characters'.format(argname, len(val))
    return None
