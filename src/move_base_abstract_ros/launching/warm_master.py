"""A Loopback whose ROS master is a fork of the warm process, if that is there."""
import os

from ..loopback import Loopback


class WarmMaster(Loopback):
    """A Loopback. To be made when the warm process has been started with a ROS master."""

    def __init__(self, warm):
        """warm: a WarmClient, or None."""
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
