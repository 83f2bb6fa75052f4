"""What pip builds the package with (PEP 517): setuptools, told that it is pip who asks and not catkin. See setup.py."""
import os

os.environ['MOVE_BASE_ABSTRACT_FOR_PIP'] = '1'

from setuptools.build_meta import *  # noqa: E402, F403 - the backend's functions
