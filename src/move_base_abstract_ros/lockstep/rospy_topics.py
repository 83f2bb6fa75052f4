"""Where rospy's own topics hand over to :class:`topics.Topics`: its manager and its connections."""
import rospy
from rospy.impl import tcpros_pubsub


def replace(topics, manager):
    """Put a participant's ``topics`` in the place of rospy's connections among participants."""
    _follow_manager(topics, manager)
    _replace_receiving(topics)
    _replace_connecting(topics)
    _count_participants()


def _follow_manager(topics, manager):
    add, remove = manager._add, manager._remove

    def _add(impl, rmap, reg_type):
        add(impl, rmap, reg_type)
        topics.added(impl, reg_type)

    def _remove(impl, rmap, reg_type):
        topics.removed(impl, reg_type)
        remove(impl, rmap, reg_type)

    manager._add, manager._remove = _add, _remove


def _replace_receiving(topics):
    subscriber = rospy.topics._SubscriberImpl
    receive_callback = subscriber.receive_callback

    def _receive(self, messages, connection):
        if topics.is_link(connection):
            receive_callback(self, messages, connection)
        else:
            topics.outside(self, messages, connection, lambda *args: receive_callback(self, *args))

    subscriber.receive_callback = _receive


def _replace_connecting(topics):
    participant = topics._participant
    publisher = rospy.topics._PublisherImpl
    add_connection = publisher.add_connection
    create_transport = tcpros_pubsub.TCPROSHandler.create_transport

    def _add_connection(self, connection):
        if self.resolved_name not in topics.excluded and participant.is_member(connection.endpoint_id):
            connection.close()
            return False
        return add_connection(self, connection)

    def _create_transport(self, resolved_name, pub_uri, protocol_params):
        if resolved_name not in topics.excluded and pub_uri in participant.uris.values():
            return 1, 'through the time master', 0
        return create_transport(self, resolved_name, pub_uri, protocol_params)

    publisher.add_connection = _add_connection
    tcpros_pubsub.TCPROSHandler.create_transport = _create_transport


def _count_participants():
    """Have a topic's one link to all participants count as that many connections."""
    implementation = rospy.topics._TopicImpl
    implementation.get_num_connections = lambda self: sum(getattr(connection, 'count', 1)
                                                          for connection in self.connections)
    implementation.has_connection = lambda self, endpoint_id: any(
        connection.endpoint_id == endpoint_id or getattr(connection, 'has_name', _never)(endpoint_id)
        for connection in self.connections)


def _never(_name):
    return False
