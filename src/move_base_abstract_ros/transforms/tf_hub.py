"""The one publisher of /tf of the process. Transforms of one instant can leave as one message.

Without heartbeats no later message says where a robot stands. A late listener can still learn it: on request, each new
listener gets the latest transforms of all frames, as if /tf were latched.
"""
from __future__ import annotations

import threading
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING, Callable, Dict, Iterator, List, Optional, Sequence, Tuple

from tf2_msgs.msg import TFMessage

from move_base_abstract.engine.series import NOBODY, PARTICIPANTS

from ..lockstep.exchange import playing
from ..messages import packing
from ..messages.outlets import Outlet, Packed

if TYPE_CHECKING:
    from ..messages.outlets import Publish
    from ..messages.packing import Slots

    Make = Callable[[int], List[bytes]]


class _Hub:
    """Publishes transforms, at once or collected."""

    def __init__(self) -> None:
        self._latest: Optional[Dict[str, Tuple[int, Make]]] = None
        self._present: Dict[str, Callable[[], Optional[Tuple[int, Make]]]] = {}
        # {key: (stamp [ns] of what newcomers of an instant were told last of it, that, these newcomers)}
        self._met: Dict[str, Tuple[int, List[bytes], List[int]]] = {}
        self._lock = threading.RLock()
        self._outlet: Optional[Outlet] = None
        self._collected: Optional[List[Callable[[], List[bytes]]]] = None

    def send(self, key: str, stamp_ns: int, make: Make, slots: Slots = None) -> None:
        """Publish the transforms ``make(stamp_ns)``, or keep them for the :meth:`batch`.

        ``make(stamp_ns)`` returns a list of TransformStamped as bytes, dated ``stamp_ns`` [ns]. ``key`` identifies
        their owner, a robot for example. Without a listener ``make`` is not called. ``slots``: those of the whole
        message, as in :class:`.packing.Template`, if it has the pose of a robot.
        """
        with self._lock:
            if self._latest is not None and not playing.is_recording():
                self._latest[key] = stamp_ns, make
            if self._collected is not None:
                self._collected.append(partial(make, stamp_ns))
            elif key in self._met and stamp_ns <= self._met[key][0]:
                playing.refuse()
                self._publish_beside_newcomers(key, stamp_ns, make)
            else:
                self._publish([partial(make, stamp_ns)], slots)

    def _publish_beside_newcomers(self, key: str, stamp_ns: int, make: Make) -> None:
        """Publish the transforms of an instant at which newcomers were told of them. They get only what differs.

        tf takes one pose for an instant, so they get it dated 1 ns after what they were told last.
        """
        told_ns, told, newcomers = self._met[key]
        outlet = self._outlet
        assert outlet is not None  # the newcomers listen to it
        with outlet.sparing(newcomers.__contains__):
            self._publish([partial(make, stamp_ns)])
        if make(told_ns) != told:
            made = make(told_ns + 1)
            self._met[key] = told_ns + 1, made, newcomers
            with outlet.sparing(lambda member: member not in newcomers):
                self._publish([lambda: made])

    def tell_newcomers(self) -> None:
        """Send each new listener the latest transforms of all frames, from now on."""
        with self._lock:
            if self._latest is None:
                self._latest = {}

    def follow(self, key: str, present: Callable[[], Optional[Tuple[int, Make]]]) -> None:
        """Tell new listeners ``present()``, the stamp [ns] and maker of now, if it is later than the latest of ``key``.

        None: there is nothing to tell of now.
        """
        self._present[key] = present

    def forget(self, key: str) -> None:
        """Stop sending the transforms of ``key`` to new listeners."""
        with self._lock:
            self._present.pop(key, None)
            self._met.pop(key, None)
            if self._latest is not None:
                self._latest.pop(key, None)

    def is_heard(self, *others: Callable[[], int]) -> int:
        """Return NOBODY (0), ONLOOKERS or PARTICIPANTS: the kind of nodes that hear /tf, or what ``others`` name."""
        heard = NOBODY if self._outlet is None else self._outlet.is_heard()
        return heard if heard == PARTICIPANTS else max([heard, *[is_heard() for is_heard in others]])

    def hearers(self) -> List[Tuple[str, str]]:
        """Return ('/tf', name) of each node that hears /tf."""
        return [] if self._outlet is None else self._outlet.hearers()

    def _greet(self, peer_publish: Publish) -> None:
        with self._lock:
            if self._latest:
                told = [self._told(key, *latest) for key, latest in self._latest.items()]
                peer_publish(Packed(lambda _seq: packing.transforms([one for made in told for one in made])))

    def _told(self, key: str, stamp_ns: int, make: Make) -> List[bytes]:
        """Return what a newcomer is told of ``key``, which was last published as ``make(stamp_ns)``."""
        present = self._present[key]() if key in self._present else None
        if present is None or present[0] <= stamp_ns:
            return make(stamp_ns)
        now_ns, make = present
        made = make(now_ns)
        met_ns, _, newcomers = self._met.get(key, (None, None, []))
        assert self._outlet is not None
        self._met[key] = now_ns, made, [*(newcomers if met_ns == now_ns else ()), self._outlet.newcomer()]
        return made

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

    def _publish(self, makes: Sequence[Callable[[], List[bytes]]], slots: Slots = None) -> None:
        if self._outlet is None:
            self._outlet = Outlet('/tf', TFMessage, queue_size=100, greet=self._greet)
        self._outlet.send(packing.Template(
            lambda _seq: packing.transforms([transform for make in makes for transform in make()]), slots,
            is_once=slots is not None))  # several series send a robot's pose


_HUB = _Hub()
batch, follow, forget, hearers, is_heard, send, tell_newcomers = (
    _HUB.batch, _HUB.follow, _HUB.forget, _HUB.hearers, _HUB.is_heard, _HUB.send, _HUB.tell_newcomers)
