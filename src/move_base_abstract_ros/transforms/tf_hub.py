"""The one publisher of /tf of the process; what belongs to one instant can leave as one message.

Without heartbeats nothing repeats where a robot stands, so that a listener that comes late can be told: then each new
one is sent the latest transforms of all frames, as if /tf were latched.
"""
import threading
from contextlib import contextmanager

from tf2_msgs.msg import TFMessage

from move_base_abstract.engine.event_queue import NOBODY

from ..lockstep.exchange import rollback
from ..messages import packing
from ..messages.outlets import Outlet, Packed


class _TfOutlet(Outlet):
    """The publisher of /tf; ``greet``: how newcomers are."""

    def __init__(self, greet):
        self.greet = greet
        super().__init__('/tf', TFMessage, queue_size=100)


class _Hub:
    """Publishes transforms, at once or collected."""

    def __init__(self):
        self._latest = None
        self._lock = threading.RLock()
        self._outlet = None
        self._collected = None

    def send(self, key, make):
        with self._lock:
            if self._latest is not None:
                rollback.changes_entry(self._latest, key)
                self._latest[key] = make
            if self._collected is None:
                self._publish([make])
            else:
                self._collected.append(make)

    def tell_newcomers(self):
        with self._lock:
            if self._latest is None:
                self._latest = {}

    def forget(self, key):
        with self._lock:
            if self._latest is not None:
                self._latest.pop(key, None)

    def is_heard(self):
        return NOBODY if self._outlet is None else self._outlet.is_heard()

    def hearers(self):
        return [] if self._outlet is None else self._outlet.hearers()

    def _greet(self, peer_publish):
        with self._lock:
            if self._latest:
                peer_publish(Packed(_packer(list(self._latest.values()))))

    @contextmanager
    def batch(self):
        with self._lock:
            self._collected = []
            try:
                yield
            finally:
                collected, self._collected = self._collected, None
                if collected:
                    self._publish(collected)

    def _publish(self, makes):
        if self._outlet is None:
            self._outlet = _TfOutlet(self._greet)
        self._outlet.send(_packer(makes))


_HUB = _Hub()


def _packer(makes):
    return lambda _seq: packing.transforms([transform for make in makes for transform in make()])


def send(key, make):
    """Publish the transforms ``make()`` (TransformStamped as bytes, in a list), or keep them for the :func:`batch`.

    ``key``: whose they are. Nothing is made where nobody listens.
    """
    _HUB.send(key, make)


def is_heard():
    """Return who listens to /tf: 0 is nobody."""
    return _HUB.is_heard()


def hearers():
    """Return ('/tf', name) of each node that listens to it."""
    return _HUB.hearers()


def tell_newcomers():
    """Send each new listener the latest transforms of all frames, from now on."""
    _HUB.tell_newcomers()


def forget(key):
    """Tell newcomers no more of these transforms."""
    _HUB.forget(key)


def batch():
    """Return a context that collects what is sent meanwhile and publishes it as one message."""
    return _HUB.batch()
