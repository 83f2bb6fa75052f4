"""Publishers to which a message is bytes, made once for all who listen, and not at all where nobody does.

A robot has a dozen topics that tell where it is and what it does; most of them have no listener most of the time, and
making a message costs more than all the rest of an event. What is to be sent is a packer, see :mod:`packing`.
"""
import threading
from contextlib import contextmanager

import rospy

from move_base_abstract.engine.event_queue import NOBODY, ONLOOKERS, PARTICIPANTS

from ..lockstep.exchange import rollback


class _Header:
    """What rospy writes a message's number into."""

    seq = 0
    frame_id = ''


class _Listeners:
    """Who is told, before anything else, that somebody begins to listen, or ends; whether what is sent is for none."""

    came = staticmethod(lambda: None)
    left = staticmethod(lambda: None)
    is_quiet = False
    changes = 0  # how often who hears what has changed


_listeners = _Listeners()


def follow_listeners(came, left):
    """Have ``came()`` called whenever somebody begins to hear a robot's topic, ``left()`` at the end."""
    _listeners.came = came
    _listeners.left = left


def changes():
    """Return how often it has changed, in this process, who hears what: as long as it is the same, so are they."""
    return _listeners.changes


def _came():
    _listeners.changes += 1
    _listeners.came()


def _left():
    _listeners.changes += 1
    _listeners.left()


@contextmanager
def nobody_hears():
    """Give a context in which what is sent reaches nobody; what is shown is kept for those who come later."""
    _listeners.is_quiet = True
    try:
        yield
    finally:
        _listeners.is_quiet = False


class Packed:
    """A packer in the form in which rospy's own publishers take a message."""

    _has_header = True

    def __init__(self, pack):
        self.header = _Header()
        self._pack = pack

    def serialize(self, buffer):
        """Write the message."""
        buffer.write(self._pack(self.header.seq))


class Outlet(rospy.SubscribeListener):
    """A publisher of packers. Threading: as of rospy's."""

    def __init__(self, topic, message_type, queue_size, tcp_nodelay=False, latch=False):
        super().__init__()
        self._publisher = rospy.Publisher(topic, message_type, subscriber_listener=self, latch=latch,
                                          queue_size=queue_size, tcp_nodelay=tcp_nodelay)
        self._impl = self._publisher.impl

    def is_heard(self):
        """Return who listens, and not only seems to, see :meth:`.links.MemberLinks.is_heard`: 0 is nobody."""
        connections = self._impl.connections
        return _heard_by(connections, 'is_heard') if connections else NOBODY

    def peer_subscribe(self, _topic_name, _topic_publish, peer_publish):
        """Somebody begins to listen."""
        _came()
        self.greet(peer_publish)

    def peer_unsubscribe(self, _topic_name, _num_peers):
        """A listener has gone."""
        _left()

    @staticmethod
    def begins_to_hear():
        """Somebody who listened without any effect hears from now on."""
        _came()

    @staticmethod
    def hears_less():
        """Of what somebody listens to, less has an effect than before."""
        _left()

    def greet(self, peer_publish):
        """Tell a newcomer, or have rospy tell it, what it has missed."""

    def is_heard_again(self):
        """Return on whom, of those who listen, repeating what was said has any effect: 0 is nobody."""
        return _heard_by(self._impl.connections, 'is_heard_again')

    def hearers(self):
        """Return (topic, name) of each node that listens to it."""
        return self._names('hearers')

    def hearers_of_repetition(self):
        """Return (topic, name) of each node on which repeating what was said has any effect."""
        return self._names('hearers_of_repetition')

    def _names(self, attribute):
        return [(self._impl.resolved_name, name) for connection in self._impl.connections
                for name in getattr(connection, attribute, (connection.endpoint_id,))]

    def send(self, pack):
        """Send what ``pack`` makes to all who listen.

        :raises rospy.ROSException: if the topic has been closed while the node goes on.
        """
        impl = self._impl
        if _listeners.is_quiet or not self.is_heard():
            return
        impl.acquire()
        try:
            connections = impl.connections
            if len(connections) == 1 and hasattr(connections[0], 'write_message') and not impl.closed:
                rollback.changes(impl, 'seq')
                impl.seq += 1
                data = pack(impl.seq)
                impl.message_data_sent += len(data)
                connections[0].write_message(data)
            elif rollback.is_recording():
                raise rollback.NotForeseeable(impl.resolved_name)
            else:
                impl.publish(Packed(pack))
        finally:
            impl.release()

    def latch(self, pack):
        """Have rospy send what ``pack`` makes to those who come from now on."""
        self._impl.latch = Packed(pack)

    def unregister(self):
        """Leave the graph."""
        self._publisher.unregister()


def _heard_by(connections, attribute):
    heard = NOBODY
    for connection in connections:
        is_heard = getattr(connection, attribute, None)
        if is_heard:
            return PARTICIPANTS
        if is_heard is None:  # one of rospy's own
            heard = ONLOOKERS
    return heard


class LatchedOutlet(Outlet):
    """A latched publisher. Who comes late gets what was shown or sent last; what was shown is made at that moment.

    ``make(*shown)`` returns the packer of what was shown. It is called in the caller's thread, or in the one in which
    rospy connects a listener.
    """

    def __init__(self, topic, message_type, make, queue_size=10, tcp_nodelay=False):
        self._make = make
        self._kept = None, None  # what was shown, or the packer of what was sent
        self._greeting = threading.Lock()  # onlookers come in threads of rospy's
        super().__init__(topic, message_type, queue_size, tcp_nodelay, latch=True)

    def show(self, *shown):
        """Send ``make(*shown)`` if anybody listens, and keep it for those who come later."""
        self._keep(shown, None)
        if self.is_heard():
            super().send(self._make(*shown))

    def send(self, pack):
        """Send what ``pack`` makes, and keep it for those who come later."""
        self._keep(None, pack)
        super().send(pack)

    def _keep(self, shown, pack):
        rollback.changes(self, '_kept')
        self._kept = shown, pack

    def greet(self, _peer_publish):
        """Make the latched message, which rospy is about to send to a new listener."""
        with self._greeting:  # what was made for one who came before must not take the place of this
            shown, pack = self._kept
            if pack is not None:
                self.latch(pack)
            elif shown is not None:
                self.latch(self._make(*shown))


class LatchedOutlets:
    """Latched publishers that show the same at the same time, each in its own way."""

    def __init__(self):
        self._outlets = ()
        self.shown = None  # last
        self._is_heard = False
        self._lock = threading.Lock()  # listeners come and go in threads of rospy's

    def add(self, topic, message_type, make, queue_size=10):
        """Have a topic; ``make(*shown)`` as of :class:`LatchedOutlet`."""
        self._outlets += (_Member(self, topic, message_type, make, queue_size),)

    def show(self, *shown):
        """Send what was shown to those who listen, in the order in which the topics came, and keep it for others."""
        rollback.changes(self, 'shown')
        self.shown = shown
        if self._is_heard:
            for outlet in self._outlets:
                if outlet.is_heard():
                    outlet.send(outlet.make(*shown))

    def is_heard(self):
        """Return who listens to any of them: 0 is nobody."""
        heard = NOBODY
        for outlet in self._outlets:
            if outlet._impl.connections:
                heard = max(heard, outlet.is_heard())
        return heard

    def hearers(self):
        """Return (topic, name) of each node that listens to one of them."""
        return [hearer for outlet in self._outlets for hearer in outlet.hearers()]

    def begin(self, outlet):
        """Make what a newcomer to ``outlet`` gets."""
        with self._lock:  # what was made for one who came before must not take the place of this
            self._is_heard = True
            if self.shown is not None:
                outlet.latch(outlet.make(*self.shown))

    def end(self):
        """Look whether anybody is left, now that somebody has gone."""
        with self._lock:
            self._is_heard = bool(self.is_heard())

    def unregister(self):
        """Leave the graph."""
        for outlet in self._outlets:
            outlet.unregister()


class _Member(Outlet):
    """One of several topics that show the same."""

    def __init__(self, group, topic, message_type, make, queue_size):
        self._group = group
        self.make = make
        super().__init__(topic, message_type, queue_size, latch=True)

    def greet(self, _peer_publish):
        """Make the latched message, which rospy is about to send to a new listener."""
        self._group.begin(self)

    def peer_unsubscribe(self, topic_name, num_peers):
        """A listener has gone."""
        super().peer_unsubscribe(topic_name, num_peers)
        self._group.end()
