"""What the tests of all folders share: by day those of the night are left out."""
from night import pytest_collection_modifyitems

__all__ = ['pytest_collection_modifyitems']
