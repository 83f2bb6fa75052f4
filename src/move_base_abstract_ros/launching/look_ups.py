"""Remember what roslaunch looks up, once for a process.

roslaunch walks through all packages each time that it looks for a node's program. Together with the two runs of
`rosversion` for the parameters of ROS's core, this takes several times as long as the rest of reading a launch file.
"""

import functools
import os
from typing import Any, Dict

import rospkg
from roslib import packages as packages_of_ros

from ..replacing.replaced import replace

programs: Dict[Any, Any] = {}  # {(package, type): path} of the programs that were found
_tolerant = [False]  # whether scripts of Python are found, too, that their authors have not made executable


@functools.lru_cache(maxsize=None)
def packages():
    """Return the RosPack of this process. It walks through all packages once."""
    return rospkg.RosPack()


def remember():
    """Make roslib's search for a node's program, in this process, begin with the programs that were found before."""
    replace('roslib.packages.find_node', _begin_with_known)


def tolerate():
    """Make the same search, from now on, find scripts of Python that are not executable. Our launcher runs them."""
    if not _tolerant[0]:
        _tolerant[0] = True
        replace('roslib.packages.find_node', _also_plain)


def _also_plain(search):
    def find_node(package, kind, rospack=None):
        return search(package, kind, rospack) or packages_of_ros.find_resource(
            package, kind, is_plain_script, packages() if rospack is None else rospack)
    return find_node


def is_plain_script(path):
    """Return whether a file is a script of Python, by its first line, that nobody may execute."""
    if os.access(path, os.X_OK) or not os.path.isfile(path):
        return False
    with open(path, 'rb') as stream:
        first = stream.readline(200)
    return first.startswith(b'#!') and b'python' in first


def _begin_with_known(search):
    def find_node(package, kind, rospack=None):
        path = programs.get((package, kind))
        if path is not None and os.access(path, os.X_OK):
            return [path]
        found = search(package, kind, packages() if rospack is None else rospack)
        if len(found) == 1:  # if there are several, the caller chooses one, or complains
            programs[package, kind] = found[0]
        return found
    return find_node
