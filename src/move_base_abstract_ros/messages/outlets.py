"""Publishers that take packers: a message is made as bytes, once for all listeners, and not at all without a listener.

A robot has a dozen topics that say where it is and what it does. Most of them have no listener most of the time, and
making a message costs more than the rest of an event. For packers see :mod:`packing`.
"""
from __future__ import annotations

import threading
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, BinaryIO, Callable, Iterator, List, Optional, Sequence, Tuple, Type

import rospy

from move_base_abstract.engine.series import NOBODY, ONLOOKERS, PARTICIPANTS

from ..lockstep.exchange import playing

if TYPE_CHECKING:
    from .packing import Pack

    #: publishes a message
    Publish = Callable[[Any], None]


class _Header:
    """The header into which rospy writes a message's number."""

    seq = 0
    frame_id = ''


class _Listeners:
    """The functions to call before all else when a listener comes or goes; ``is_quiet``: nothing reaches a listener."""

    came = staticmethod(lambda: None)
    left = staticmethod(lambda: None)
    is_quiet = False
    changes = 0  # number of changes of the listeners, or of what has an effect on them


_listeners = _Listeners()


def follow_listeners(came: Callable[[], None], left: Callable[[], None]) -> None:
    """Call ``came()`` from now on when a node begins to hear a robot's topic, and ``left()`` when one stops."""
    _listeners.came = came
    _listeners.left = left


def changes() -> int:
    """Return how often the listeners of this process's outlets have changed. An equal number means equal listeners."""
    return _listeners.changes


def _came() -> None:
    _listeners.changes += 1
    _listeners.came()


def _left() -> None:
    _listeners.changes += 1
    _listeners.left()


@contextmanager
def nobody_hears() -> Iterator[None]:
    """Give a context in which :meth:`Outlet.send` reaches nobody. Shown values are still kept for later listeners."""
    _listeners.is_quiet = True
    try:
        yield
    finally:
        _listeners.is_quiet = False


class Packed:
    """A packer as a message that rospy's own publishers take."""

    _has_header = True

    def __init__(self, pack: Pack) -> None:
        self.header = _Header()
        self._pack = pack

    def serialize(self, buffer: BinaryIO) -> None:
        """Write the message's bytes into ``buffer``."""
        buffer.write(self._pack(self.header.seq))


class Outlet(rospy.SubscribeListener):
    """A publisher of packers. It may be used from the same threads as rospy's publishers."""

    def __init__(self, topic: str, message_type: Type[Any], queue_size: int, tcp_nodelay: bool = False,
                 latch: bool = False, greet: Optional[Callable[[Publish], None]] = None) -> None:
        """``greet``: takes the place of :meth:`greet`."""
        super().__init__()
        if greet is not None:
            self.greet = greet  # type: ignore[assignment,method-assign]
        self._publisher = rospy.Publisher(topic, message_type, subscriber_listener=self, latch=latch,
                                          queue_size=queue_size, tcp_nodelay=tcp_nodelay)
        self._impl = self._publisher.impl

    def is_heard(self) -> int:
        """Return NOBODY (0), ONLOOKERS or PARTICIPANTS: the kind of nodes on which a message has any effect now.

        A participant may be connected without any effect, see :meth:`.links.MemberLinks.is_heard`.
        """
        connections = self._impl.connections
        return _heard_by(connections, 'is_heard') if connections else NOBODY

    def peer_subscribe(self, _topic_name: str, _topic_publish: Publish, peer_publish: Publish) -> None:
        """Note that a node begins to listen, and greet it."""
        _came()
        self.greet(peer_publish)

    def peer_unsubscribe(self, _topic_name: str, _num_peers: int) -> None:
        """Note that a listener has gone."""
        _left()

    @staticmethod
    def begins_to_hear() -> None:
        """Note that messages have an effect from now on at a listener at which they had none."""
        _came()

    @staticmethod
    def hears_less() -> None:
        """Note that fewer messages than before have an effect at a listener."""
        _left()

    def greet(self, peer_publish: Publish) -> None:
        """Send a new listener what it has missed, or have rospy do so. By default do nothing."""

    def is_heard_again(self) -> int:
        """Return NOBODY (0), ONLOOKERS or PARTICIPANTS: the kind of listeners on which a repetition has any effect."""
        return _heard_by(self._impl.connections, 'is_heard_again')

    def hearers(self) -> List[Tuple[str, str]]:
        """Return (topic, name) of each node that hears this topic."""
        return self._names('hearers')

    def hearers_of_repetition(self) -> List[Tuple[str, str]]:
        """Return (topic, name) of each node on which a repetition has any effect."""
        return self._names('hearers_of_repetition')

    def _names(self, attribute: str) -> List[Tuple[str, str]]:
        return [(self._impl.resolved_name, name) for connection in self._impl.connections
                for name in getattr(connection, attribute, (connection.endpoint_id,))]

    def send(self, pack: Pack) -> None:
        """Send the message that ``pack`` makes to all listeners.

        :raises rospy.ROSException: if the topic has been closed while the node goes on.
        :raises NotPlayable: if :mod:`.playing` records, and the message cannot be played.
        """
        impl = self._impl
        if _listeners.is_quiet or not self.is_heard():
            return
        if playing.is_recording():
            playing.note(impl, pack)
            return
        impl.acquire()
        try:
            connections = impl.connections
            if len(connections) == 1 and hasattr(connections[0], 'write_message') and not impl.closed:
                impl.seq += 1
                data = pack(impl.seq)
                impl.message_data_sent += len(data)
                connections[0].write_message(data)
            else:
                impl.publish(Packed(pack))
        finally:
            impl.release()

    def newcomer(self) -> int:
        """Return the participant that has begun to listen last. There is one."""
        return next(link.members[-1] for link in self._impl.connections if hasattr(link, 'members'))

    @contextmanager
    def sparing(self, are_spared: Callable[[int], bool]) -> Iterator[None]:
        """Give a context in which nothing reaches participants for which ``are_spared(participant)``."""
        links = [link for link in self._impl.connections if hasattr(link, 'members')]
        for link in links:
            link.spared = [member for member in link.members if are_spared(member)]
        try:
            yield
        finally:
            for link in links:
                link.spared = ()

    def latch(self, pack: Pack) -> None:
        """Make rospy send the message that ``pack`` makes to nodes that begin to listen from now on."""
        self._impl.latch = Packed(pack)

    def unregister(self) -> None:
        """Stop publishing: leave the ROS graph."""
        self._publisher.unregister()


def _heard_by(connections: Sequence[Any], attribute: str) -> int:
    heard = NOBODY
    for connection in connections:
        is_heard = getattr(connection, attribute, None)
        if is_heard:
            return PARTICIPANTS
        if is_heard is None:  # a connection of rospy's own
            heard = ONLOOKERS
    return heard


class LatchedOutlet(Outlet):
    """A latched publisher. A late listener gets the message last sent, or one made of the values last shown.

    ``make(*shown)`` returns the packer of the shown values. It is called when a message is needed: in the caller's
    thread, or in the thread in which rospy connects a listener.
    """

    def __init__(self, topic: str, message_type: Type[Any], make: Callable[..., Pack], queue_size: int = 10,
                 tcp_nodelay: bool = False) -> None:
        self._make = make
        self._kept: Any = None, None  # the values last shown, or the packer last sent
        self._greeting = threading.Lock()  # rospy connects onlookers in threads of its own
        super().__init__(topic, message_type, queue_size, tcp_nodelay, latch=True)

    def show(self, *shown: Any) -> None:
        """Send ``make(*shown)`` if a node hears the topic, and keep the values for later listeners."""
        self._keep(shown, None)
        if self.is_heard():
            super().send(self._make(*shown))

    def send(self, pack: Pack) -> None:
        """Send the message that ``pack`` makes, and keep the packer for later listeners."""
        self._keep(None, pack)
        super().send(pack)

    def _keep(self, shown: Any, pack: Optional[Pack]) -> None:
        # The last value shown is its instant. What is made up for, because it was slept through, may be an older one.
        is_old = _listeners.is_quiet and shown and self._kept[0] and shown[-1] < self._kept[0][-1]
        if not (is_old or playing.is_recording()):
            self._kept = shown, pack

    def greet(self, _peer_publish: Optional[Publish]) -> None:
        """Make the latched message, which rospy is about to send to a new listener."""
        with self._greeting:  # so that an older message, made for an earlier listener, does not replace this one
            shown, pack = self._kept
            if pack is not None or shown is not None:
                self.latch(pack or self._make(*shown))


class LatchedOutlets:
    """Latched publishers that show the same values at the same time, each as a message of its own type."""

    def __init__(self) -> None:
        self._outlets: Any = ()
        self.shown: Any = None  # the values last shown
        #: returns the values of now for a new listener; None: those that were shown last
        self.present: Callable[[], Any] = lambda: None
        self._is_heard = False
        self._lock = threading.Lock()  # listeners come and go in threads of rospy's own

    def add(self, topic: str, message_type: Type[Any], make: Callable[..., Pack], queue_size: int = 10) -> None:
        """Add a topic. ``make(*shown)`` is as in :class:`LatchedOutlet`."""
        self._outlets += (_Member(self, topic, message_type, make, queue_size),)

    def show(self, *shown: Any) -> None:
        """Send the values to all listeners, in the order in which the topics were added; keep them for later ones."""
        if not playing.is_recording():
            self.shown = shown
        if self._is_heard:
            for outlet in self._outlets:
                if outlet.is_heard():
                    outlet.send(outlet.make(*shown))

    def is_heard(self) -> int:
        """Return NOBODY (0), ONLOOKERS or PARTICIPANTS: the kind of nodes that hear any of the topics."""
        heard = NOBODY
        for outlet in self._outlets:
            if outlet._impl.connections:
                heard = max(heard, outlet.is_heard())
        return heard

    def hearers(self) -> List[Tuple[str, str]]:
        """Return (topic, name) of each node that hears one of the topics."""
        return [hearer for outlet in self._outlets for hearer in outlet.hearers()]

    def begin(self, outlet: _Member) -> None:
        """Make the message that a new listener of ``outlet`` gets."""
        present = self.present()
        with self._lock:  # so that an older message, made for an earlier listener, does not replace this one
            self._is_heard = True
            shown = self.shown if present is None else present
            if shown is not None:
                outlet.latch(outlet.make(*shown))

    def end(self) -> None:
        """Note whether any listener is left, after one has gone."""
        with self._lock:
            self._is_heard = bool(self.is_heard())

    def unregister(self) -> None:
        """Stop publishing all topics: leave the ROS graph."""
        for outlet in self._outlets:
            outlet.unregister()


class _Member(Outlet):
    """One of several topics that show the same values."""

    def __init__(self, group: LatchedOutlets, topic: str, message_type: Type[Any], make: Callable[..., Pack],
                 queue_size: int) -> None:
        self._group = group
        self.make = make
        super().__init__(topic, message_type, queue_size, latch=True)

    def greet(self, _peer_publish: Publish) -> None:
        """Make the latched message, which rospy is about to send to a new listener."""
        self._group.begin(self)

    def peer_unsubscribe(self, topic_name: str, num_peers: int) -> None:
        """Note that a listener has gone."""
        super().peer_unsubscribe(topic_name, num_peers)
        self._group.end()
