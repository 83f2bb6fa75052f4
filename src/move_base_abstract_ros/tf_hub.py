"""The one publisher of /tf of the process; what belongs to one instant can leave as one message.

Without heartbeats nothing repeats where a robot stands, so that a listener that comes late can be told: then each new
one is sent the latest transforms of all frames, as if /tf were latched.
"""
import threading
from contextlib import contextmanager

import rospy
from tf2_msgs.msg import TFMessage


class _Hub(rospy.SubscribeListener):
    """Publishes transforms, at once or collected."""

    def __init__(self):
        super().__init__()
        self._latest = None
        self._lock = threading.RLock()
        self._publisher = None
        self._collected = None

    def send(self, transforms):
        with self._lock:
            if self._collected is None:
                self._publish(transforms)
            else:
                self._collected.extend(transforms)

    def tell_newcomers(self):
        with self._lock:
            if self._latest is None:
                self._latest = {}

    def forget(self, frame_ids):
        with self._lock:
            for frame_id in frame_ids if self._latest is not None else ():
                self._latest.pop(frame_id, None)

    def peer_subscribe(self, _topic_name, _topic_publish, peer_publish):
        with self._lock:
            if self._latest:
                peer_publish(TFMessage(list(self._latest.values())))

    @contextmanager
    def batch(self):
        with self._lock:
            self._collected = []
            try:
                yield
            finally:
                transforms, self._collected = self._collected, None
                if transforms:
                    self._publish(transforms)

    def _publish(self, transforms):
        if self._publisher is None:
            self._publisher = rospy.Publisher('/tf', TFMessage, queue_size=100, subscriber_listener=self)
        if self._latest is not None:
            self._latest.update((transform.child_frame_id, transform) for transform in transforms)
        self._publisher.publish(TFMessage(transforms))


_HUB = _Hub()


def send(transforms):
    """Publish ``transforms`` (list of TransformStamped), or keep them for the end of the :func:`batch`."""
    _HUB.send(transforms)


def tell_newcomers():
    """Send each new listener the latest transforms of all frames, from now on."""
    _HUB.tell_newcomers()


def forget(frame_ids):
    """Tell newcomers no more of these frames."""
    _HUB.forget(frame_ids)


def batch():
    """Return a context that collects what is sent meanwhile and publishes it as one message."""
    return _HUB.batch()
