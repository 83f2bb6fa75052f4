"""The ROS part of a warm process. Without ROS, trials that are functions still run."""
from __future__ import annotations

import importlib
import importlib.util
from typing import MutableMapping

from ..description import launch_files


def is_there() -> bool:
    """Return whether ROS and this package's ROS modules are installed."""
    return all(importlib.util.find_spec(name) for name in ('move_base_abstract_ros', 'rospy'))


def launcher() -> str:
    """Return the path of our launcher."""
    from move_base_abstract_ros.loopback import find_executable
    return str(find_executable('lockstep'))


def prepare(environment: MutableMapping[str, str], is_new: bool) -> bool:
    """Add variables to the environment that only a new process can take; return whether one must be started.

    is_new: whether one must be started in any case.
    """
    from move_base_abstract_ros.lockstep.programs import address_layout, native_library
    is_new = address_layout.choose(environment) or is_new
    return bool((is_new or not native_library.is_loaded()) and native_library.preload(environment) or is_new)


def import_all() -> None:
    """Import the modules, and look up the paths, that the processes of trials need."""
    from move_base_abstract_ros.launching import look_ups, warm_nodes
    from move_base_abstract_ros.replacing import replaced
    for name in warm_nodes.MODULES:
        importlib.import_module(name)
    launch_files.core()
    look_ups.remember()
    replaced.look_up()
    warm_nodes.log_settings()
