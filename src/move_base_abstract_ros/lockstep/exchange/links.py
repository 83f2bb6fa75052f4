"""The connections between participants' publishers and subscribers, which replace rospy's.

rospy's own topic objects stay in use. A publisher has one connection for all participants that listen, which writes
into the report. A subscriber has one connection for each participant that publishes.
"""
from __future__ import annotations

import threading
from collections import deque
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple

import rospy

from move_base_abstract.lockstep import wire

if TYPE_CHECKING:
    from move_base_abstract.lockstep.wire import Delivery

    from ..participation.taking_part import Participant

_local = threading.local()


class sender:  # noqa: N801 - it is called like a function
    """A context in which all that is created or published belongs to the robot ``index``, which gives its order.

    Of messages of one instant whose senders have the same rank, those of the lowest index come first.
    """

    __slots__ = ('_index', '_before')

    def __init__(self, index: Optional[int]) -> None:
        self._index = index
        self._before = None

    def __enter__(self) -> None:
        self._before = getattr(_local, 'index', None)
        _local.index = self._index

    def __exit__(self, *_error: Any) -> None:
        _local.index = self._before


@contextmanager
def repetition() -> Iterator[None]:
    """Give a context in which messages say nothing new, and go only to subscriptions that hear all messages."""
    _local.least = wire.Delivery.ALL
    try:
        yield
    finally:
        _local.least = wire.Delivery.NEWS


def creating_index() -> int:
    """Return the index of the robot to which objects belong that are created now; 0 outside of :class:`sender`."""
    return getattr(_local, 'index', None) or 0


class MemberLinks:
    """The connection of a publisher to all participants that listen to it, with the attributes that rospy expects."""

    direction, transport_type = 'o', 'LOCKSTEP'
    done = False
    cleanup_cb: Any = None
    latch: Any = None
    is_latched = False
    stat_bytes = 0
    stat_num_msg = 0
    id = 0
    endpoint_id = callerid_pub = 'lockstep'

    def __init__(self, participant: Participant, topic: int, sub: int, impl: Any = None) -> None:
        self._impl = impl
        self._participant = participant
        self._topic = topic
        self.sub = sub
        self.target = 0
        self.members: List[int] = []
        self._delivery: Dict[int, Delivery] = {}  # {member: Delivery} of members that do not hear all messages
        self.spared: Sequence[int] = ()  # members to which nothing that is sent now goes

    def is_latching(self) -> bool:
        """Return whether the publisher's last message is kept for later listeners."""
        return self.target == 0 and self._impl is not None and self._impl.is_latch

    def for_one(self, member: int) -> MemberLinks:
        """Return a connection to one of the participants."""
        link = MemberLinks(self._participant, self._topic, self.sub, self._impl)
        link.target = member
        link.members = [member]
        return link

    def add(self, member: int) -> None:
        """Add a participant that begins to listen."""
        self.members = self.members + [member]

    def remove(self, member: int) -> None:
        """Remove a participant that stops listening."""
        self.members = [other for other in self.members if other != member]
        self._delivery.pop(member, None)

    def choose(self, member: int, what: Delivery) -> None:
        """Note which messages (wire.Delivery) have any effect at ``member``."""
        self._delivery[member] = what

    def _hear(self, least: Delivery) -> List[int]:
        """Return the members whose Delivery is at least ``least``."""
        return [member for member in self.members if self._delivery.get(member, wire.Delivery.ALL) >= least]

    @property
    def hearers(self) -> List[str]:
        """The names of the nodes on which messages have any effect."""
        return [self._participant.members.names.get(member, '') for member in self._hear(wire.Delivery.NEWS)]

    @property
    def hearers_of_repetition(self) -> List[str]:
        """The names of the nodes on which messages that say nothing new have any effect."""
        return [self._participant.members.names.get(member, '') for member in self._hear(wire.Delivery.ALL)]

    @property
    def is_heard(self) -> bool:
        """Whether a message that is sent now has any effect on any participant."""
        if not self._delivery:
            return bool(self.members)
        return bool(self._hear(getattr(_local, 'least', wire.Delivery.NEWS)))

    @property
    def is_heard_again(self) -> bool:
        """Whether a message that says nothing new has any effect on any participant."""
        return bool(self._hear(wire.Delivery.ALL))

    @property
    def count(self) -> int:
        """The number of participants that listen."""
        return len(self.members)

    def has_name(self, name: str) -> bool:
        """Return whether the node ``name`` is one of the participants that listen."""
        return any(self._participant.members.names.get(member) == name for member in self.members)

    def write_data(self, data: bytes) -> bool:
        """Add a serialised message, which begins with its length, to the report."""
        self.write_message(data[4:])
        return True

    def write_message(self, data: bytes) -> None:
        """Add a serialised message to the report."""
        self.stat_bytes += len(data)
        self.stat_num_msg += 1
        topic, sub, targets = self.address()
        for target in targets:
            self._participant.add(wire.send(topic, sub, target, data))

    def address(self) -> Tuple[int, int, Sequence[int]]:
        """Return (topic, sub, targets) of a message that is sent now, as in SEND."""
        index = getattr(_local, 'index', None)
        # A node that begins to listen in this round gets the latched message when this publisher is told of the node.
        return self._topic, self.sub if index is None else index, self._targets()

    def _targets(self) -> Sequence[int]:
        if self._delivery or self.spared:
            heard = self._hear(getattr(_local, 'least', wire.Delivery.NEWS))
            return [member for member in heard if member not in self.spared]
        return self.members if self.is_latching() else (self.target,)

    def fileno(self) -> None:
        """Return None, since there is no file."""

    def set_cleanup_callback(self, callback: Any) -> None:
        """Do nothing, since the connection is never closed from the other side."""

    def get_transport_info(self) -> str:
        """Return the text that rosnode shows."""
        return 'lockstep, through the time master'

    def close(self) -> None:
        """Do nothing, since nothing is open."""


class PublisherLink(MemberLinks):
    """The connection of a subscriber to one participant that publishes. The callbacks run one after the other."""

    direction = 'i'

    def __init__(self, participant: Participant, topic: int, impl: Any, member: int, header: Mapping[str, str]) -> None:
        super().__init__(participant, topic, 0, impl)
        self.members = [member]
        self.endpoint_id = participant.members.uris.get(header['callerid'], header['callerid'])
        self.callerid_pub = header['callerid']
        self.header = header
        self.is_latched = header['latching'] == '1'
        self._backlog: Any = deque()
        self._is_busy = False

    def take(self, data: bytes) -> None:
        """Call the callbacks with a serialised message, after the callbacks of earlier messages have returned."""
        if self._is_busy:
            self._backlog.append(data)
            self._trim()
            return
        self._is_busy = True
        try:
            self._deliver(data)
            while self._backlog:
                self._deliver(self._backlog.popleft())
        finally:
            self._is_busy = False

    def _trim(self) -> None:
        """Keep the newest messages, as many as the subscriber's queue_size, as rospy does when it reads a socket."""
        size = self._impl.queue_size
        while size is not None and len(self._backlog) > size:
            self._backlog.popleft()

    def _deliver(self, data: bytes) -> None:
        impl = self._impl
        if impl.closed:
            return
        self.stat_bytes += len(data)
        self.stat_num_msg += 1
        message = impl.data_class()
        try:
            message.deserialize(data)
        except Exception as error:
            rospy.logerr('%s: a message on %s from %s cannot be read: %s', rospy.get_name(), impl.resolved_name,
                         self.callerid_pub, error)
            return
        message._connection_header = self.header
        if self.is_latched:
            self.latch = message
        impl.receive_callback([message], self)
