"""The one publisher of /tf of the process; what belongs to one instant can leave as one message."""
import threading
from contextlib import contextmanager

import rospy
from tf2_msgs.msg import TFMessage

_lock = threading.RLock()
_publisher = None
_collected = None


def send(transforms):
    """Publish ``transforms`` (list of TransformStamped), or keep them for the end of the :func:`batch`."""
    with _lock:
        if _collected is None:
            _publish(transforms)
        else:
            _collected.extend(transforms)


@contextmanager
def batch():
    """Collect what is sent meanwhile and publish it as one message."""
    global _collected
    with _lock:
        _collected = []
        try:
            yield
        finally:
            transforms, _collected = _collected, None
            if transforms:
                _publish(transforms)


def _publish(transforms):
    global _publisher
    if _publisher is None:
        _publisher = rospy.Publisher('/tf', TFMessage, queue_size=100)
    _publisher.publish(TFMessage(transforms))
