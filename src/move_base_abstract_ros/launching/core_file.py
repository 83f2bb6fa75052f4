"""The file of ROS's core, which roslaunch reads before each launch file, without its two programs (`rosversion`)."""
import os

import rospkg
from roslaunch.loader import convert_value
from roslaunch.xmlloader import XmlLoader

from ..adopting.reading import Tolerant
from . import look_ups


class Loader(XmlLoader):
    """roslaunch's loader, that knows without a program what `rosversion` says in the file of ROS's core."""

    def param_value(self, verbose, name, ptype, value, textfile, binfile, command):
        """As roslaunch's."""
        known = _answer(command) if value is None and textfile is None and binfile is None else ''
        if known:
            return convert_value(known + '\n', ptype)
        return super().param_value(verbose, name, ptype, value, textfile, binfile, command)


class TolerantLoader(Tolerant, Loader):
    """The same of files of others, which may name what is not here."""


def _answer(command):
    """Return what a command of the file of ROS's core prints, or '' where that is not known."""
    if command == 'rosversion -d':
        return os.environ.get('ROS_DISTRO', '')
    if command == 'rosversion roslaunch':
        try:
            return look_ups.packages().get_manifest('roslaunch').version or ''
        except (rospkg.ResourceNotFound, rospkg.InvalidManifest):
            return ''
    return ''
