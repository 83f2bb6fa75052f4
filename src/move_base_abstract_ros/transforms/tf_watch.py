"""A warning if another node publishes a robot's frames in tf.

tf uses the latest transform of a frame, whichever node sent it. So two publishers of one frame make it jump to and fro,
and tf does not say so. A permanent listener of /tf would take time for each message of every robot. So this listens
only to new publishers of tf, each for a short while. It looks for them at the start, soon after it, and then once a
minute.
"""
from __future__ import annotations

import itertools
import threading
from typing import AbstractSet, Any, Dict, Sequence, Set, Tuple

import rosgraph
import rospy
from tf2_msgs.msg import TFMessage

from ..replacing import bulk_registration

TOPICS = ('/tf', '/tf_static')
_LISTENING_SECONDS = 2.0  # wall
_FIRST_PAUSES, _PAUSE = (1.0, 5.0, 20.0), 60.0  # s, wall


class _Watch:
    """The watch of one process. Its thread starts with the first claim."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._claims: Dict[str, str] = {}  # {frame: robot}
        self._known: Set[str] = set()  # nodes
        self._warned: Set[Tuple[str, str]] = set()  # (frame, node)
        self._end = threading.Event()
        self._thread: Any = None

    def claim(self, robot: str, frames: Sequence[str]) -> None:
        """Warn from now on if another node publishes one of ``frames``, the frames of ``robot`` in tf."""
        with self._lock:
            self._claims.update(dict.fromkeys(frames, robot))
            if self._thread is None:
                self._thread = threading.Thread(target=self._run, name='tf_watch', daemon=True)
                rospy.on_shutdown(self._end.set)
                self._thread.start()

    def release(self, frames: Sequence[str]) -> None:
        """Stop watching ``frames``."""
        with self._lock:
            for frame in frames:
                self._claims.pop(frame, None)

    def _run(self) -> None:
        for pause in itertools.chain(_FIRST_PAUSES, itertools.repeat(_PAUSE)):
            if self._end.wait(pause):
                return
            new = publishers(*TOPICS) - self._known
            if new:
                self._known |= new
                self._listen(new)

    def _listen(self, nodes: AbstractSet[str]) -> None:
        with bulk_registration.at_once:
            subscribers = [rospy.Subscriber(topic, TFMessage, self._on_message, nodes) for topic in TOPICS]
        self._end.wait(_LISTENING_SECONDS)
        with bulk_registration.at_once:
            for subscriber in subscribers:
                subscriber.unregister()

    def _on_message(self, message: Any, nodes: AbstractSet[str]) -> None:
        node = message._connection_header['callerid']
        if node not in nodes:
            return
        for transform in message.transforms:
            frame = transform.child_frame_id.lstrip('/')
            with self._lock:
                robot = self._claims.get(frame)
                is_new = robot is not None and (frame, node) not in self._warned
                self._warned.update([(frame, node)] if is_new else [])
            if is_new:
                rospy.logwarn("%s: %s also publishes the frame '%s' in tf (below '%s'): look-ups jump between the two. "
                              'Only one node may publish it; tf_prefix gives the frames of each robot their own names',
                              robot, node, frame, transform.header.frame_id)


def publishers(*topics: str) -> Set[str]:
    """Return the names of the other nodes that publish ``topics``; an empty set if the ROS master does not answer."""
    try:
        published = rosgraph.Master(rospy.get_name()).getSystemState()[0]
    except (OSError, rosgraph.MasterException):
        return set()
    return {node for topic, nodes in published if topic in topics for node in nodes} - {rospy.get_name()}


_WATCH = _Watch()
claim, release = _WATCH.claim, _WATCH.release
