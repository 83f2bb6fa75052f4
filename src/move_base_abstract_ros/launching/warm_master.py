"""A Loopback whose ROS master is a fork of the warm process, if there is one."""
import os

from ..loopback import Loopback


class WarmMaster(Loopback):
    """A Loopback with the warm process's ROS master, or with its own if there is none."""

    def __init__(self, warm):
        """warm: a WarmClient that was made with ``has_master``, or None."""
        super().__init__()
        self._warm = warm

    def _start_master(self):
        found = None if self._warm is None else self._warm.master()
        if found is None:
            super()._start_master()
            return
        forked, self.uri = found
        self._child('rosmaster', forked, os.devnull)
        self.set_param('/use_sim_time', True)
