"""Log which node is missing if simulated time stands still for good, for example after a time master was killed."""
from __future__ import annotations

import threading
import time
from typing import List, Optional, Tuple

import rosgraph
import rospy

from .ros_master_watch import is_answering

_PERIOD_S = 1.0  # wall
_STILL_S = 2.0  # wall; if time stands still for so long, its publishers are asked
_TIMEOUT_S = 5.0  # wall


def watch_clock() -> None:
    """Watch /clock from now on, in a thread of its own, if ROS time is simulated. Call this once in a process."""
    if rospy.get_param('/use_sim_time', False):
        threading.Thread(target=_Watch().run, name='clock_watch', daemon=True).start()


class _Watch:
    """Watches simulated time. If it stands still while its publisher answers, that is no fault: it may be paused."""

    def __init__(self) -> None:
        self._publishers: List[Tuple[str, str]] = []  # the publishers of /clock when time began to move last
        self._is_told = False

    def run(self) -> None:
        """Look at the time every second, until ROS shuts down."""
        last_ns, since = 0, time.monotonic()
        while not rospy.is_shutdown():
            time.sleep(_PERIOD_S)
            now_ns = rospy.get_rostime().to_nsec()
            if now_ns != last_ns:
                self._moves(is_first=last_ns == 0)
                last_ns, since = now_ns, time.monotonic()
            elif now_ns and not self._is_told and time.monotonic() - since >= _STILL_S:
                self._stands_still(now_ns)

    def _moves(self, is_first: bool) -> None:
        if self._is_told:
            rospy.logwarn('%s: simulated time moves again', rospy.get_name())
        if self._is_told or is_first:
            self._is_told = False
            self._publishers = _publishers() or []

    def _stands_still(self, now_ns: int) -> None:
        publishers = _publishers()
        if publishers is None:
            gone = 'the ROS master at {} does not answer'.format(rosgraph.get_master_uri())
        elif any(is_answering(uri, rospy.get_name(), _TIMEOUT_S) for _, uri in publishers):
            return
        else:
            names = ' and '.join(name for name, _ in publishers or self._publishers)
            gone = '{}, which published /clock, is gone'.format(names) if names else 'no node publishes /clock any more'
        if not rospy.is_shutdown():
            self._is_told = True
            rospy.logerr('%s: simulated time stands still at %.3f s: %s', rospy.get_name(), now_ns / 1e9, gone)


def _publishers() -> Optional[List[Tuple[str, str]]]:
    """Return [(name, URI of its node)] of all that the ROS master lists for /clock; None if it does not answer."""
    master = rosgraph.Master(rospy.get_name())
    try:
        names = [name for topic, nodes in master.getSystemState()[0] if topic == '/clock' for name in nodes]
    except Exception:  # an error of the network or of the protocol
        return None
    found = []
    for name in names:
        try:
            found.append((name, master.lookupNode(name)))
        except Exception:
            continue  # it has just left
    return found
