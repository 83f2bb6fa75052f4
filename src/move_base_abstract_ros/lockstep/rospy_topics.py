"""Where rospy's own topics hand over to :class:`topics.Topics`: its manager and its connections."""
from ..replaced import replace


def install(topics):
    """Put a participant's ``topics`` in the place of rospy's connections among participants."""
    _follow_manager(topics)
    _replace_receiving(topics)
    _replace_connecting(topics)
    _count_participants()


def _follow_manager(topics):
    def adding(add):
        def _add(self, impl, rmap, reg_type):
            add(self, impl, rmap, reg_type)
            topics.added(impl, reg_type)
        return _add

    def removing(remove):
        def _remove(self, impl, rmap, reg_type):
            topics.removed(impl, reg_type)
            remove(self, impl, rmap, reg_type)
        return _remove

    replace('rospy.topics._TopicManager._add', adding)
    replace('rospy.topics._TopicManager._remove', removing)


def _replace_receiving(topics):
    def receiving(receive_callback):
        def _receive(self, messages, connection):
            if topics.is_link(connection):
                receive_callback(self, messages, connection)
            else:
                topics.outside(self, messages, connection, lambda *args: receive_callback(self, *args))
        return _receive

    replace('rospy.topics._SubscriberImpl.receive_callback', receiving)


def _replace_connecting(topics):
    participant = topics._participant

    def adding(add_connection):
        def _add_connection(self, connection):
            if self.resolved_name not in topics.excluded and participant.is_member(connection.endpoint_id):
                connection.close()
                return False
            return add_connection(self, connection)
        return _add_connection

    def publishing(publish):
        def _publish(self, message, connection_override=None):
            receivers = self.connections if connection_override is None else (connection_override,)
            if any(map(topics.is_link, receivers)):
                return publish(self, message, connection_override)
            with self.publock:
                number = self.seq
                try:
                    return publish(self, message, connection_override)
                finally:
                    self.seq = number
        return _publish

    def creating(create_transport):
        def _create_transport(self, resolved_name, pub_uri, protocol_params):
            if resolved_name not in topics.excluded and pub_uri in participant.uris.values():
                return 1, 'through the time master', 0
            return create_transport(self, resolved_name, pub_uri, protocol_params)
        return _create_transport

    replace('rospy.topics._PublisherImpl.add_connection', adding)
    replace('rospy.topics._PublisherImpl.publish', publishing)
    replace('rospy.impl.tcpros_pubsub.TCPROSHandler.create_transport', creating)


def _count_participants():
    """Have a topic's one link to all participants count as that many connections."""
    def counting(_original):
        return lambda self: sum(getattr(connection, 'count', 1) for connection in self.connections)

    def seeking(_original):
        return lambda self, endpoint_id: any(
            connection.endpoint_id == endpoint_id or getattr(connection, 'has_name', _never)(endpoint_id)
            for connection in self.connections)

    replace('rospy.topics._TopicImpl.get_num_connections', counting)
    replace('rospy.topics._TopicImpl.has_connection', seeking)


def _never(_name):
    return False
