"""The build backend of pip (PEP 517): setuptools, with a variable that tells setup.py that pip calls, not catkin."""
import os

os.environ['MOVE_BASE_ABSTRACT_FOR_PIP'] = '1'

from setuptools.build_meta import *  # noqa: E402, F403 - the backend's functions
