"""Maps from topics. A process has one subscription and one copy of the map per topic, for any number of robots."""
from __future__ import annotations

import threading
import time
from typing import Any, Callable, Dict, List

import numpy
import rospy
from nav_msgs.msg import OccupancyGrid
from rospy.numpy_msg import numpy_msg

from move_base_abstract.maps.occupancy import OccupancyMap

from ..messages import conversions

_REMINDER_SECONDS = 5.0  # wall


class MapListener:
    """Receives the maps of one topic. Use :meth:`on` to get the process's listener of a topic.

    Threading: any thread may call ``follow`` and ``leave``. Followers are called in the thread that receives maps, one
    at a time, while ``follow`` and ``leave`` do not block; the first call may be in the thread that calls ``follow``.
    """

    _listeners: Dict[str, MapListener] = {}
    _listeners_lock = threading.Lock()

    def __init__(self, topic: str) -> None:
        self.topic = topic
        self._lock = threading.RLock()
        self._turn = threading.Lock()  # for the threads that receive maps, one for each publisher
        self._followers: List[Callable[[Any, OccupancyMap], object]] = []
        self._latest: Any = None
        self._came = threading.Event()
        # With numpy_msg the cells stay the received bytes; a list would take eight times as much memory.
        self._subscriber = rospy.Subscriber(topic, numpy_msg(OccupancyGrid), self._on_map, queue_size=1)

    @classmethod
    def on(cls, topic: str) -> MapListener:
        """Return the process's listener of ``topic`` (an absolute name)."""
        with cls._listeners_lock:
            if topic not in cls._listeners:
                cls._listeners[topic] = cls(topic)
            return cls._listeners[topic]

    @property
    def has_come(self) -> bool:
        """Whether a map has come."""
        return self._came.is_set()

    def wait(self) -> bool:
        """Wait for the first map, with a warning every 5 s; return False if ROS shuts down meanwhile."""
        reminded = time.monotonic()
        while not self._came.wait(0.1):
            if rospy.is_shutdown():
                return False
            if time.monotonic() - reminded > _REMINDER_SECONDS:
                reminded = time.monotonic()
                rospy.logwarn('%s: no map has come on %s yet, and robots need it: is a map server running?',
                              rospy.get_name(), self.topic)
        return True

    def follow(self, follower: Callable[[Any, OccupancyMap], object]) -> None:
        """Call ``follower(message, occupancy)`` with the latest map, if there is one, and with each new map."""
        with self._lock:
            self._followers.append(follower)
            if self._latest is not None:
                follower(*self._latest)

    def leave(self, follower: Callable[[Any, OccupancyMap], object]) -> None:
        """Stop calling ``follower``."""
        with self._lock:
            self._followers.remove(follower)

    def _on_map(self, message: Any) -> None:
        try:
            occupancy = to_occupancy(message)
        except ValueError as error:
            rospy.logerr('%s: the map on %s is not used: %s', rospy.get_name(), self.topic, error)
            return
        with self._turn:
            with self._lock:
                self._latest = message, occupancy
                followers = list(self._followers)
            for follower in followers:
                if follower in self._followers:  # it may have left meanwhile
                    follower(message, occupancy)
        self._came.set()
        rospy.loginfo('%s: map on %s: %d x %d cells of %g m in the frame %s', rospy.get_name(), self.topic,
                      occupancy.width, occupancy.height, occupancy.resolution, message.header.frame_id)


def occupancy_in(message: Any) -> OccupancyMap:
    """Return the OccupancyMap of a nav_msgs/OccupancyGrid whose data is a list or bytes; see :func:`to_occupancy`."""
    message.data = numpy.array(message.data, numpy.int8)
    return to_occupancy(message)


def to_occupancy(message: Any) -> OccupancyMap:
    """Return the OccupancyMap of a nav_msgs/OccupancyGrid whose data is a numpy array; the cells are not copied.

    :raises ValueError: if the number of cells does not fit the size, or the resolution or the origin is not allowed.
    """
    info = message.info
    if len(message.data) != info.width * info.height:
        raise ValueError('got {} cells; allowed: {} x {}, as its info says'.format(
            len(message.data), info.width, info.height))
    if not any(conversions.quaternion_tuple(info.origin.orientation)):
        info.origin.orientation.w = 1.0  # in maps drawn by hand the orientation is often left out
    return OccupancyMap(message.data.reshape(info.height, info.width), info.resolution,
                        conversions.from_pose(info.origin))
