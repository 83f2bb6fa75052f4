"""The one publisher of /tf of the process. Transforms of one instant can leave as one message.

Without heartbeats no later message says where a robot stands. A late listener can still learn it: on request, each new
listener gets the latest transforms of all frames, as if /tf were latched.
"""
from __future__ import annotations

import threading
from contextlib import contextmanager
from typing import TYPE_CHECKING, Callable, Dict, Iterator, List, Optional, Sequence, Tuple

from tf2_msgs.msg import TFMessage

from move_base_abstract.engine.event_queue import NOBODY

from ..lockstep.exchange import rollback
from ..messages import packing
from ..messages.outlets import Outlet, Packed

if TYPE_CHECKING:
    from ..messages.outlets import Publish
    from ..messages.packing import Pack

    Make = Callable[[], List[bytes]]


class _TfOutlet(Outlet):
    """The publisher of /tf; ``greet(peer_publish)`` is called for each new listener."""

    def __init__(self, greet: Callable[[Publish], None]) -> None:
        self.greet = greet  # type: ignore[assignment,method-assign]
        super().__init__('/tf', TFMessage, queue_size=100)


class _Hub:
    """Publishes transforms, at once or collected."""

    def __init__(self) -> None:
        self._latest: Optional[Dict[str, Make]] = None
        self._lock = threading.RLock()
        self._outlet: Optional[_TfOutlet] = None
        self._collected: Optional[List[Make]] = None

    def send(self, key: str, make: Make) -> None:
        """Publish the transforms ``make()`` (a list of TransformStamped as bytes), or keep them for the :meth:`batch`.

        ``key`` identifies their owner, a robot for example. Without a listener ``make`` is not called.
        """
        with self._lock:
            if self._latest is not None:
                rollback.changes_entry(self._latest, key)
                self._latest[key] = make
            if self._collected is None:
                self._publish([make])
            else:
                self._collected.append(make)

    def tell_newcomers(self) -> None:
        """Send each new listener the latest transforms of all frames, from now on."""
        with self._lock:
            if self._latest is None:
                self._latest = {}

    def forget(self, key: str) -> None:
        """Stop sending the transforms of ``key`` to new listeners."""
        with self._lock:
            if self._latest is not None:
                self._latest.pop(key, None)

    def is_heard(self) -> int:
        """Return NOBODY (0), ONLOOKERS or PARTICIPANTS: the kind of nodes that hear /tf."""
        return NOBODY if self._outlet is None else self._outlet.is_heard()

    def hearers(self) -> List[Tuple[str, str]]:
        """Return ('/tf', name) of each node that hears /tf."""
        return [] if self._outlet is None else self._outlet.hearers()

    def _greet(self, peer_publish: Publish) -> None:
        with self._lock:
            if self._latest:
                peer_publish(Packed(_packer(list(self._latest.values()))))

    @contextmanager
    def batch(self) -> Iterator[None]:
        """Give a context that collects all transforms sent meanwhile, and publishes them as one message."""
        with self._lock:
            self._collected = []
            try:
                yield
            finally:
                collected, self._collected = self._collected, None
                if collected:
                    self._publish(collected)

    def _publish(self, makes: Sequence[Make]) -> None:
        if self._outlet is None:
            self._outlet = _TfOutlet(self._greet)
        self._outlet.send(_packer(makes))


def _packer(makes: Sequence[Make]) -> Pack:
    return lambda _seq: packing.transforms([transform for make in makes for transform in make()])


_HUB = _Hub()
batch, forget, hearers, is_heard, send, tell_newcomers = (
    _HUB.batch, _HUB.forget, _HUB.hearers, _HUB.is_heard, _HUB.send, _HUB.tell_newcomers)
