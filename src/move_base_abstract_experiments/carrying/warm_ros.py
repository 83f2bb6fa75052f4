"""The ROS part of a warm process. Without ROS, trials that are functions still run."""
from __future__ import annotations

import functools
import importlib.util


def is_there() -> bool:
    """Return whether ROS and this package's ROS modules are installed."""
    return all(importlib.util.find_spec(name) for name in ('move_base_abstract_ros', 'rospy'))


@functools.lru_cache(maxsize=None)
def launcher() -> str:
    """Return the path of our launcher. The search walks through all packages, so it is made only once."""
    from move_base_abstract_ros.loopback import find_executable
    return str(find_executable('lockstep'))
