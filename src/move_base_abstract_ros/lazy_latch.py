"""A latched topic whose messages are made only for those who listen.

A robot has half a dozen topics that tell where it is; most of them have no listener most of the time, and making a
message costs more than all the rest of an event.
"""
import rospy


class LazyLatch(rospy.SubscribeListener):
    """A latched publisher. Who comes late gets what was offered or published last, made at that moment.

    Threading: ``make`` functions are called in the caller's thread, or in the one in which rospy connects a listener.
    """

    def __init__(self, topic, message_type, queue_size=10, tcp_nodelay=False):
        super().__init__()
        self._make = None
        self._publisher = rospy.Publisher(topic, message_type, subscriber_listener=self, queue_size=queue_size,
                                          latch=True, tcp_nodelay=tcp_nodelay)

    def is_heard(self):
        """Return whether anybody listens."""
        return self._publisher.get_num_connections() > 0

    def offer(self, make):
        """Publish ``make()`` if anybody listens, and keep it for those who come later."""
        self._make = make
        if self.is_heard():
            self._publisher.publish(make())

    def publish(self, message):
        """Publish a message."""
        self._make = lambda: message
        self._publisher.publish(message)

    def unregister(self):
        """Leave the graph."""
        self._publisher.unregister()

    def peer_subscribe(self, _topic_name, _topic_publish, _peer_publish):
        """Make the latched message, which rospy is about to send the latched message to a new listener."""
        impl = self._publisher.impl
        if impl is not None and self._make is not None:
            impl.latch = self._make()
