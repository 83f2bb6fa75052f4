"""The hooks by which rospy's own topics hand over to :class:`topics.Topics`: in its manager and its connections."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, List, Mapping, Optional, Sequence, Tuple, Union

import rospy

from ...replacing.replaced import replace

if TYPE_CHECKING:
    from .links import MemberLinks
    from .topics import Topics

_OWN = ('move_base_abstract_ros.', 'soil_mapping.')


def install(topics: Topics) -> None:
    """Replace rospy's connections among participants by a participant's ``topics`` (Topics)."""
    _follow_manager(topics)
    _replace_receiving(topics)
    _replace_connecting(topics)
    _replace_publishing(topics)
    _count_participants(topics)


def _follow_manager(topics: Topics) -> None:
    def adding(add: Callable[..., Any]) -> Callable[..., Any]:
        def _add(self: Any, impl: Any, rmap: Mapping[str, Any], reg_type: str) -> None:
            add(self, impl, rmap, reg_type)
            topics.added(impl, reg_type)
        return _add

    def removing(remove: Callable[..., Any]) -> Callable[..., Any]:
        def _remove(self: Any, impl: Any, rmap: Mapping[str, Any], reg_type: str) -> None:
            topics.removed(impl, reg_type)
            remove(self, impl, rmap, reg_type)
        return _remove

    replace('rospy.topics._TopicManager._add', adding)
    replace('rospy.topics._TopicManager._remove', removing)


def _replace_receiving(topics: Topics) -> None:
    def receiving(receive_callback: Callable[..., Any]) -> Callable[..., Any]:
        def _receive(self: Any, messages: Sequence[Any], connection: Any) -> None:
            if topics.is_link(connection):
                receive_callback(self, messages, connection)
            else:
                topics.outside(self, messages, connection, lambda *args: receive_callback(self, *args))
        return _receive

    replace('rospy.topics._SubscriberImpl.receive_callback', receiving)


def _replace_connecting(topics: Topics) -> None:
    participant = topics._participant

    def adding(add_connection: Callable[..., Any]) -> Callable[..., Any]:
        def _add_connection(self: Any, connection: Any) -> bool:
            if self.resolved_name not in topics.excluded and participant.members.is_member(connection.endpoint_id):
                connection.close()
                return False
            if not _is_onlooker(self, topics, connection):
                return add_connection(self, connection)
            return _add_onlooker(self, connection)
        return _add_connection

    def removing(remove_connection: Callable[..., Any]) -> Callable[..., Any]:
        def _remove_connection(self: Any, connection: Any) -> None:
            if not _is_onlooker(self, topics, connection):
                remove_connection(self, connection)
            else:
                _remove_onlooker(self, connection)
        return _remove_connection

    def creating(create_transport: Callable[..., Any]) -> Callable[..., Any]:
        def _create_transport(self: Any, resolved_name: str, pub_uri: str,
                              protocol_params: Sequence[Union[int, str]]) -> Tuple[int, str, int]:
            if resolved_name not in topics.excluded and pub_uri in participant.members.uris.values():
                return 1, 'through the time master', 0
            return create_transport(self, resolved_name, pub_uri, protocol_params)
        return _create_transport

    replace('rospy.topics._PublisherImpl.add_connection', adding)
    replace('rospy.topics._PublisherImpl.remove_connection', removing)
    replace('rospy.impl.tcpros_pubsub.TCPROSHandler.create_transport', creating)


def _replace_publishing(topics: Topics) -> None:
    def publishing(publish: Callable[..., Any]) -> Callable[..., Any]:
        def _publish(self: Any, message: Any, connection_override: Optional[MemberLinks] = None) -> Optional[bool]:
            receivers = self.connections if connection_override is None else (connection_override,)
            lock = self.publock  # None when the topic is closed; rospy then raises its own error
            is_heard = any(topics.is_link(receiver) and receiver.is_heard for receiver in receivers)
            is_greeting = connection_override is not None and bool(_own_listeners(self))
            if lock is None or is_heard and not is_greeting:
                return publish(self, message, connection_override)
            with lock:
                number = self.seq
                if is_heard:
                    self.seq = number - 1  # a newcomer gets the number of the latest message; others notice nothing
                try:
                    return publish(self, message, connection_override)
                finally:
                    self.seq = number
        return _publish

    replace('rospy.topics._PublisherImpl.publish', publishing)


def _is_onlooker(impl: Any, topics: Topics, connection: Any) -> bool:
    takes_part = topics.is_link(connection) or impl.resolved_name in topics.excluded
    return not takes_part and not topics._participant.scheduler.is_closed


def _add_onlooker(impl: Any, connection: Any) -> bool:
    """Add the connection of a node that does not take part, without telling the program, which might act upon it.

    Only this package's own listeners are told, since they show something to onlookers.
    """
    if impl.queue_size is not None:
        connection = rospy.topics.QueuedConnection(connection, impl.queue_size)
    rospy.topics._TopicImpl.add_connection(impl, connection)
    greet(impl, connection, _own_listeners(impl))
    return True


def greet(impl: Any, connection: Any, listeners: Sequence[Any]) -> None:
    """Tell a publisher's ``listeners`` of a new connection, and send the latched message over it, if there is one."""
    def publish_single(data: bytes) -> None:
        impl.publish(data, connection_override=connection)
    for listener in listeners:
        listener.peer_subscribe(impl.resolved_name, impl.publish, publish_single)
    if impl.is_latch and impl.latch is not None:
        with impl.publock:
            impl.publish(impl.latch, connection_override=connection)


def _remove_onlooker(impl: Any, connection: Any) -> None:
    rospy.topics._TopicImpl.remove_connection(impl, connection)
    for listener in _own_listeners(impl):
        listener.peer_unsubscribe(impl.resolved_name, impl.get_num_connections())


def _own_listeners(impl: Any) -> List[Any]:
    return [one for one in impl.subscriber_listeners if type(one).__module__.startswith(_OWN)]


def _count_participants(topics: Topics) -> None:
    """Count a topic's one link to all participants as that many connections, and do not count onlookers."""
    def counting(_original: Callable[..., Any]) -> Callable[..., Any]:
        def _get_num_connections(self: Any) -> int:
            with_onlookers = (self.resolved_name in topics.excluded or not hasattr(self, 'subscriber_listeners')
                              or not topics._participant.scheduler.is_mine())
            return sum(getattr(connection, 'count', 1) for connection in self.connections
                       if with_onlookers or topics.is_link(connection))
        return _get_num_connections

    def seeking(_original: Callable[..., Any]) -> Callable[..., Any]:
        return lambda self, endpoint_id: any(
            connection.endpoint_id == endpoint_id or getattr(connection, 'has_name', _never)(endpoint_id)
            for connection in self.connections)

    replace('rospy.topics._TopicImpl.get_num_connections', counting)
    replace('rospy.topics._TopicImpl.has_connection', seeking)


def _never(_name: str) -> bool:
    return False
