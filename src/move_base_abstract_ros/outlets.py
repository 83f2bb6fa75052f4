"""Publishers to which a message is bytes, made once for all who listen, and not at all where nobody does.

A robot has a dozen topics that tell where it is and what it does; most of them have no listener most of the time, and
making a message costs more than all the rest of an event. What is to be sent is a packer, see :mod:`packing`.
"""
import threading

import rospy

from . import beforehand


class _Header:
    """What rospy writes a message's number into."""

    seq = 0
    frame_id = ''


class Packed:
    """A packer in the form in which rospy's own publishers take a message."""

    _has_header = True

    def __init__(self, pack):
        self.header = _Header()
        self._pack = pack

    def serialize(self, buffer):
        """Write the message."""
        buffer.write(self._pack(self.header.seq))


class Outlet:
    """A publisher of packers. Threading: as of rospy's."""

    def __init__(self, topic, message_type, queue_size, tcp_nodelay=False, latch=False, subscriber_listener=None):
        self._publisher = rospy.Publisher(topic, message_type, subscriber_listener=subscriber_listener, latch=latch,
                                          queue_size=queue_size, tcp_nodelay=tcp_nodelay)
        self._impl = self._publisher.impl

    def is_heard(self):
        """Return whether anybody listens."""
        return bool(self._impl.connections)

    def send(self, pack):
        """Send what ``pack`` makes to all who listen.

        :raises rospy.ROSException: if the topic has been closed while the node goes on.
        """
        impl = self._impl
        if not impl.connections:
            return
        impl.acquire()
        try:
            connections = impl.connections
            if len(connections) == 1 and hasattr(connections[0], 'write_message') and not impl.closed:
                beforehand.changes(impl, 'seq')
                impl.seq += 1
                data = pack(impl.seq)
                impl.message_data_sent += len(data)
                connections[0].write_message(data)
            elif beforehand.is_now():
                raise beforehand.NotForeseeable(impl.resolved_name)
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


class LatchedOutlet(rospy.SubscribeListener):
    """A latched publisher. Who comes late gets what was shown or sent last; what was shown is made at that moment.

    ``make(*shown)`` returns the packer of what was shown. It is called in the caller's thread, or in the one in which
    rospy connects a listener.
    """

    def __init__(self, topic, message_type, make, queue_size=10, tcp_nodelay=False):
        super().__init__()
        self._make = make
        self._shown = None
        self._sent = None
        self._outlet = Outlet(topic, message_type, queue_size, tcp_nodelay, latch=True, subscriber_listener=self)
        self.is_heard = self._outlet.is_heard
        self.unregister = self._outlet.unregister

    def show(self, *shown):
        """Send ``make(*shown)`` if anybody listens, and keep it for those who come later."""
        beforehand.changes(self, '_shown')
        beforehand.changes(self, '_sent')
        self._shown, self._sent = shown, None
        if self.is_heard():
            self._outlet.send(self._make(*shown))

    def send(self, pack):
        """Send what ``pack`` makes, and keep it for those who come later."""
        beforehand.changes(self, '_sent')
        self._sent = pack
        self._outlet.send(pack)

    def peer_subscribe(self, _topic_name, _topic_publish, _peer_publish):
        """Make the latched message, which rospy is about to send to a new listener."""
        if self._sent is not None:
            self._outlet.latch(self._sent)
        elif self._shown is not None:
            self._outlet.latch(self._make(*self._shown))


class LatchedOutlets:
    """Latched publishers that show the same at the same time, each in its own way."""

    def __init__(self):
        self._outlets = ()
        self._shown = None
        self._is_heard = False
        self._lock = threading.Lock()  # listeners come and go in threads of rospy's

    def add(self, topic, message_type, make, queue_size=10):
        """Have a topic; ``make(*shown)`` as of :class:`LatchedOutlet`."""
        self._outlets += (_Member(self, topic, message_type, make, queue_size),)

    def show(self, *shown):
        """Send what was shown to those who listen, in the order in which the topics came, and keep it for others."""
        beforehand.changes(self, '_shown')
        self._shown = shown
        if self._is_heard:
            for outlet in self._outlets:
                if outlet.is_heard():
                    outlet.send(outlet.make(*shown))

    def begin(self, outlet):
        """Make what a newcomer to ``outlet`` gets."""
        with self._lock:
            self._is_heard = True
        if self._shown is not None:
            outlet.latch(outlet.make(*self._shown))

    def end(self):
        """Look whether anybody is left, now that somebody has gone."""
        with self._lock:
            self._is_heard = any(outlet.is_heard() for outlet in self._outlets)

    def unregister(self):
        """Leave the graph."""
        for outlet in self._outlets:
            outlet.unregister()


class _Member(Outlet, rospy.SubscribeListener):
    """One of several topics that show the same."""

    def __init__(self, group, topic, message_type, make, queue_size):
        super().__init__(topic, message_type, queue_size, latch=True, subscriber_listener=self)
        self._group = group
        self.make = make

    def peer_subscribe(self, _topic_name, _topic_publish, _peer_publish):
        """Make the latched message, which rospy is about to send to a new listener."""
        self._group.begin(self)

    def peer_unsubscribe(self, _topic_name, _num_peers):
        """A listener has gone."""
        self._group.end()
