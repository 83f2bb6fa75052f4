"""Topics between participants, which replace rospy's connections.

rospy's own topic objects stay in use. Between participants they have connections of another kind, see :mod:`links`.
Connections to all other nodes are rospy's own.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Dict, List, Sequence, Set, Tuple

from rospy.impl import registration
from rospy.impl.registration import Registration

from move_base_abstract.lockstep import wire

from . import rospy_topics
from .delivery import Deliveries
from .links import MemberLinks, PublisherLink, creating_index

if TYPE_CHECKING:
    from ..participation.taking_part import Participant


class Topics:
    """The topics of a participant. The protocol has a number for each topic of a participant, not its name.

    ``excluded`` are the names of topics that are not part of lockstep, ``constants`` those of
    :meth:`.Participant.constant`.
    """

    def __init__(self, participant: Participant) -> None:
        self._participant = participant
        self.excluded: Set[str] = set()
        self.constants: Set[str] = set()
        self._numbers: Dict[str, int] = {}
        self._names: List[str] = []
        self._links: Dict[int, MemberLinks] = {}
        self._publisher_links: Dict[Tuple[int, int], PublisherLink] = {}
        self._told_types: Set[str] = set()
        self._since: Dict[str, int] = {}  # {topic: when this node began to listen to it [ns]}
        self.deliveries = Deliveries(self)

    def choose(self, impl: Any, what: wire.Delivery) -> None:
        """Report which messages (wire.Delivery) have any effect on the subscription ``impl``."""
        number = self._numbers.get(impl.resolved_name)
        if number is not None:
            self._participant.add(wire.choose_delivery(number, what))

    def install(self) -> None:
        """Take over rospy's present and future topics."""
        manager = registration.get_topic_manager()
        rospy_topics.install(self)
        self.deliveries.install()
        for reg_type, topics in ((Registration.PUB, manager.pubs), (Registration.SUB, manager.subs)):
            for impl in topics.values():
                self.added(impl, reg_type)

    def _number(self, name: str) -> int:
        if name not in self._numbers:
            self._numbers[name] = len(self._names)
            self._names.append(name)
        return self._numbers[name]

    # --- what this node does ----------------------------------------------------------------------------------------

    def added(self, impl: Any, reg_type: str) -> None:
        """Report a new publisher or subscriber, unless its topic is excluded."""
        name = impl.resolved_name
        if name in self.excluded:
            return
        number, sub = self._number(name), creating_index()
        if reg_type == Registration.SUB:
            self._since[name] = self._participant.now_ns
            self._participant.add(wire.subscribe(number, sub, name, impl.data_class._md5sum))
            return
        self._links[number] = MemberLinks(self._participant, number, sub, impl)
        # A function, since rospy says only after this whether the publisher is latched.
        self._participant.add(lambda: self._advertise(number, sub, impl))

    def _advertise(self, number: int, sub: int, impl: Any) -> bytes:
        """Return the item. It has the definition of the message type, some kilobytes, only the first time."""
        kind = impl.data_class
        md5 = kind._md5sum if kind else ''  # rospy forgets the class of a topic that has been closed again
        definition = kind._full_text if kind and md5 not in self._told_types else ''
        self._told_types.add(md5)
        return wire.advertise(number, sub, impl.resolved_name, impl.type or '', md5, impl.is_latch, definition)

    def removed(self, impl: Any, reg_type: str) -> None:
        """Report that a publisher or subscriber is gone."""
        number = self._numbers.get(impl.resolved_name)
        if number is None:
            return
        if reg_type == Registration.SUB:
            self.deliveries.forget(impl)
            self._participant.add(wire.unsubscribe(number))
            for key in [key for key in self._publisher_links if key[0] == number]:
                del self._publisher_links[key]
        else:
            self._participant.add(wire.unadvertise(number))
            self._links.pop(number, None)

    # --- items of grants --------------------------------------------------------------------------------------------

    def handlers(self) -> Dict[int, Callable[..., None]]:
        """Return {kind of a grant's item: function of its values, to be called in the turn}."""
        return {wire.PUBLISHER: self._connect_publisher, wire.NO_PUBLISHER: self._disconnect_publisher,
                wire.SUBSCRIBER: self._connect_subscriber, wire.NO_SUBSCRIBER: self._disconnect_subscriber,
                wire.DELIVER: self._deliver, wire.DELIVERY_CHOSEN: self._note_delivery}

    def _connect_publisher(self, number: int, member: int, type_name: str, md5: str, latched: bool,
                           definition: str) -> None:
        impl = registration.get_topic_manager().get_subscriber_impl(self._names[number])
        if impl is not None and (number, member) not in self._publisher_links:
            link = PublisherLink(self._participant, number, impl, member, {
                'callerid': self._participant.members.names.get(member, ''), 'topic': self._names[number],
                'type': type_name, 'md5sum': md5, 'latching': '1' if latched else '0',
                'message_definition': definition})
            self._publisher_links[number, member] = link
            with impl.c_lock:
                impl.connections = impl.connections + [link]

    def _disconnect_publisher(self, number: int, member: int) -> None:
        link = self._publisher_links.pop((number, member), None)
        if link is not None and not link._impl.closed:
            with link._impl.c_lock:
                link._impl.connections = [other for other in link._impl.connections if other is not link]

    def _connect_subscriber(self, number: int, member: int) -> None:
        link = self._links.get(number)
        impl = registration.get_topic_manager().get_publisher_impl(self._names[number])
        if link is None or impl is None or impl.closed:
            return
        link.add(member)
        with impl.c_lock:
            if link not in impl.connections:
                impl.connections = impl.connections + [link]
        rospy_topics.greet(impl, link.for_one(member), impl.subscriber_listeners)

    def _disconnect_subscriber(self, number: int, member: int) -> None:
        link = self._links.get(number)
        impl = registration.get_topic_manager().get_publisher_impl(self._names[number])
        if link is None or impl is None or impl.closed:
            return
        link.remove(member)
        if not link.members:
            with impl.c_lock:
                impl.connections = [other for other in impl.connections if other is not link]
        count = impl.get_num_connections()
        for listener in impl.subscriber_listeners:
            listener.peer_unsubscribe(impl.resolved_name, count)

    def _note_delivery(self, number: int, member: int, what: wire.Delivery) -> None:
        """Note which of this node's messages on a topic (wire.Delivery) have an effect on a participant."""
        link = self._links.get(number)
        impl = registration.get_topic_manager().get_publisher_impl(self._names[number])
        if link is None or impl is None or impl.closed or member not in link.members:
            return
        link.choose(member, what)
        for listener in impl.subscriber_listeners:
            if hasattr(listener, 'begins_to_hear'):
                listener.hears_less() if what == wire.Delivery.NOTHING else listener.begins_to_hear()

    def listens_since_now(self) -> List[str]:
        """Return the topics to which this node began to listen at the present instant."""
        now_ns = self._participant.now_ns
        return [name for name, since_ns in self._since.items() if since_ns == now_ns]

    def has_heard(self, name: str) -> bool:
        """Return whether a message of a participant on the topic ``name`` has come."""
        return any(link.stat_num_msg for (number, _), link in self._publisher_links.items()
                   if self._names[number] == name)

    def is_of_participants(self, name: str) -> bool:
        """Return whether a participant publishes on a topic to which this node listens."""
        return any(self._names[number] == name for number, _member in self._publisher_links)

    def _deliver(self, number: int, member: int, data: bytes) -> None:
        link = self._publisher_links.get((number, member))
        if link is not None:
            link.take(data)

    # --- other nodes ------------------------------------------------------------------------------------------------

    def drop_connections_to(self, name: str) -> None:
        """Close rospy's connections to a node that has joined: its messages go through the time master from now on."""
        manager = registration.get_topic_manager()
        with manager.lock:
            impls = list(manager.pubs.values())
        for impl in impls:
            if impl.resolved_name not in self.excluded:
                for connection in impl.connections:
                    if connection.endpoint_id == name:
                        connection.close()

    @staticmethod
    def is_link(connection: Any) -> bool:
        """Return whether ``connection`` is one to participants, and not one of rospy's."""
        return isinstance(connection, MemberLinks)

    def outside(self, impl: Any, messages: Sequence[Any], connection: Any, deliver: Callable[..., Any]) -> None:
        """Take messages that have come over a connection of rospy's own.

        On an excluded topic, or a constant one in the first round, they are delivered at once. Those of other nodes
        are delivered in the next round, and label the run. Those of participants are dropped: they come in grants.
        """
        participant = self._participant
        is_free = impl.resolved_name in self.excluded or (participant.rounds.is_starting
                                                          and impl.resolved_name in self.constants)
        if participant.scheduler.is_closed or is_free:
            deliver(messages, connection)
            return
        if participant.members.is_member(connection.callerid_pub):
            return

        def take() -> None:
            if participant.members.is_member(connection.callerid_pub):
                return  # it has joined in the meantime
            participant.label('a message on {} came from {}, which does not take part'.format(
                impl.resolved_name, connection.callerid_pub))
            deliver(messages, connection)
        participant.scheduler.from_outside(take)
