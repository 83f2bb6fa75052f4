"""The map as one robot uses it, between the process's map listener and the core."""
import threading

import rospy

from move_base_abstract.map_check import MapCheck


class RobotMap:
    """The map as one robot uses it: ``check`` judges its goals, or is None where the robot uses no map."""

    def __init__(self, names, settings):
        values = settings.values
        self.check = None
        self._followers = []
        self._came = threading.Event()
        if not values['use_map']:
            return
        self._global_frame = values['global_frame']
        self._timeout = values['frame_timeout']
        # Only who uses a map pays for numpy: some 0.1 s and 15 MB a process.
        from .map_listener import MapListener
        self._listener = MapListener.on(rospy.resolve_name(values['map_topic'], names.private))
        self.check = MapCheck(None, values['allow_unknown'], values['allow_occupied_goals'],
                              "No map has come on '{}' yet (~use_map is true). Is a map server running?".format(
                                  self._listener.topic))
        self.follow(self._take)

    def follow(self, follower):
        """Call ``follower(message, occupancy)`` with the latest map and with each that comes, until :meth:`close`."""
        if self.check is not None:
            self._followers.append(follower)
            self._listener.follow(follower)

    def wait(self):
        """Wait for the first map, up to frame_timeout [s, wall]. May block; must not be called with a lock held."""
        if self.check is not None:
            self._came.wait(self._timeout)

    def close(self):
        """Follow the map no more."""
        for follower in self._followers:
            self._listener.leave(follower)
        self._followers = []

    def _take(self, message, occupancy):
        frame_id = message.header.frame_id.lstrip('/')
        if frame_id == self._global_frame:
            self.check.occupancy = occupancy
        else:
            self.check.lacking = ("The map on '{}' cannot be used: it is given in the frame '{}', the robot's global "
                                  "frame is '{}'".format(self._listener.topic, frame_id, self._global_frame))
            self.check.occupancy = None
        self._came.set()
