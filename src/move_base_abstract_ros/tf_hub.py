"""The one publisher of /tf of the process; what belongs to one instant can leave as one message."""
import threading
from contextlib import contextmanager

import rospy
from tf2_msgs.msg import TFMessage


class _Hub:
    """Publishes transforms, at once or collected."""

    def __init__(self):
        self._lock = threading.RLock()
        self._publisher = None
        self._collected = None

    def send(self, transforms):
        with self._lock:
            if self._collected is None:
                self._publish(transforms)
            else:
                self._collected.extend(transforms)

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
            self._publisher = rospy.Publisher('/tf', TFMessage, queue_size=100)
        self._publisher.publish(TFMessage(transforms))


_HUB = _Hub()


def send(transforms):
    """Publish ``transforms`` (list of TransformStamped), or keep them for the end of the :func:`batch`."""
    _HUB.send(transforms)


def batch():
    """Return a context that collects what is sent meanwhile and publishes it as one message."""
    return _HUB.batch()
