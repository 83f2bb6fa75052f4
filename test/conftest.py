"""What the tests of all folders share: the sources on the path, and by day those of the night are left out."""
import sys
from pathlib import Path

from night import pytest_collection_modifyitems

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'src'))  # pytest of Debian 11 has no `pythonpath`

__all__ = ['pytest_collection_modifyitems']
