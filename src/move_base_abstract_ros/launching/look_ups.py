"""What roslaunch looks up again and again, each time with a walk through all packages or by a program: once a process.

The parameters of ROS's core need two programs (`rosversion`), and where a node's program is needs a walk: together
several times as long as all the rest of reading a launch file.
"""
import functools
import os

import rospkg

from ..replacing.replaced import replace

programs = {}  # (package, type): path, of what has been found


@functools.lru_cache(maxsize=None)
def packages():
    """Return rospkg's RosPack of this process, which walks once."""
    return rospkg.RosPack()


def remember():
    """Have roslib's search for a node's program, in this process, begin with what was found before."""
    replace('roslib.packages.find_node', _begin_with_known)


def _begin_with_known(search):
    def find_node(package, kind, rospack=None):
        path = programs.get((package, kind))
        if path is not None and os.access(path, os.X_OK):
            return [path]
        found = search(package, kind, packages() if rospack is None else rospack)
        if len(found) == 1:  # of several, whoever asks makes its own choice, or an error
            programs[package, kind] = found[0]
        return found
    return find_node
