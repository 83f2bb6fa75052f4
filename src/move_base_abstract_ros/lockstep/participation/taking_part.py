"""A participant of lockstep: how its process says hello, which calls it offers to the program, and how it leaves."""
from __future__ import annotations

import json
import os
import threading
import time
from math import isfinite
from typing import TYPE_CHECKING, Any, Callable, Dict, NoReturn, Optional, Sequence, Set

import rospy

from move_base_abstract.common.units import seconds_to_ns
from move_base_abstract.lockstep import wire
from move_base_abstract.lockstep.task import TurnLost, _make_lock

from ..exchange.access import secret
from ..exchange.services import Services
from ..exchange.topics import Topics
from . import finish, silence
from .rounds import Rounds

if TYPE_CHECKING:
    from ...clocks.lockstep_clock import LockstepClock
    from ..exchange.connection import Connection
    from ..ros_master.parameters import Parameters

_LOOK_SECONDS = 0.05  # wall; a thread that waits for something else notices the end of lockstep within this time
_encode = json.JSONEncoder(separators=(',', ':')).encode
_encode_text = json.encoder.encode_basestring_ascii


class Participant:
    """A participant, made by :func:`join`. The calling thread must have the turn, unless a method says otherwise.

    ``rank`` is the node's rank, and ``has_radio`` says whether the run has a radio, so that robots report how they
    move; both are known when :func:`join` returns.
    """

    def __init__(self, connection: Connection, charge: Any) -> None:
        self.connection = connection
        self.charge = charge
        self.rounds = Rounds(self, connection, charge)
        self.scheduler = self.rounds.scheduler
        self.members = Members()
        #: those of Rounds
        self.add, self.add_aside, self.last_words = self.rounds.add, self.rounds.add_aside, self.rounds.last_words
        self.rank, self.has_radio = 0, False
        self._leave_seconds = 0.0  # wall
        self.parameters: Optional[Parameters] = None
        #: whether the node has been told to end, at some moment of the wall clock
        self.is_told_to_end = False
        #: whether a thread stands at a debugger's prompt, so that no limit of wall time counts
        self.is_looked_at = False
        self.topics = Topics(self)
        self.services = Services(self)

    # --- for the program --------------------------------------------------------------------------------------------

    @property
    def now_ns(self) -> int:
        """The simulated time of the present grant [ns]."""
        return self.scheduler.now_ns

    def log(self, robot: str, kind: str, values: Sequence[Any] = (), sub: int = 0) -> None:
        """Add a line to the run's event log: a name, the kind of event, and details (numbers and texts).

        ``sub`` is the index of the robot in this process, by which lines of one instant are put in order.
        """
        self.add(wire.log(sub, robot, kind, _to_json(values)))

    def label(self, text: str) -> None:
        """Label the run as not repeatable; ``text`` is the reason."""
        self.add(wire.note(wire.NoteKind.NOT_REPEATABLE, text))

    def be_strict(self) -> None:
        """Make the run end with an error at the first label of any participant."""
        self.add(wire.note(wire.NoteKind.STRICT, ''))

    def constant(self, topic: str) -> None:
        """Treat what non-participants publish on ``topic`` as there from the beginning.

        In this node's first round, while time stands still, a message on it is delivered at once, in rospy's own
        thread, without a label. Later messages are input from outside, and label the run.
        """
        self.topics.constants.add(rospy.resolve_name(topic))

    def exclude(self, topic: str) -> None:
        """Leave ``topic`` out of lockstep: it goes over rospy's own connections, at moments of the wall clock."""
        self.topics.excluded.add(rospy.resolve_name(topic))

    def wait_until(self, condition: Callable[[], object], timeout: Optional[float] = None,
                   what: str = 'something') -> bool:
        """Let others go on until ``condition()`` holds, or ``timeout`` [s, simulated] is over; return whether it holds.

        The condition is checked whenever something has happened in this process. ``what`` names it where ``why``
        shows what the node waits for.

        :raises rospy.ROSInterruptException: if the run ends meanwhile.
        """
        wake_ns = wire.NEVER if timeout is None else self.now_ns + seconds_to_ns(timeout)
        try:
            return bool(self.scheduler.wait_until(condition, wake_ns, what))
        except TurnLost:
            raise rospy.ROSInterruptException('lockstep has ended') from None

    def set_source(self, source: LockstepClock) -> None:
        """Drive the events of ``source`` by the grants.

        ``source.next_due_ns()`` returns the next instant [ns] or None, and ``source.run(now_ns)`` runs what is due. A
        source with output that can be played also has what :class:`.Player` asks for.
        """
        self.rounds.set_source(source, lambda: rospy.get_param('~play_output', True) is not False)

    def serve(self) -> None:
        """Give the turn away for good: callbacks and events go on, and the calling thread takes no more turns."""
        self.scheduler.finish()

    def leave(self, reason: str = 'it has left') -> None:
        """Leave the run. Simulated time stands still in this process from then on, so call this at its end only.

        Any thread may call it.
        """
        if self.scheduler.is_closed:
            return
        holds_turn = self.scheduler.is_mine()
        if not holds_turn and self.scheduler.has_outside:
            self._leave_in_turn(reason)
            if self.scheduler.is_closed:
                return
        if self.parameters is not None and (self.is_told_to_end or not (holds_turn and self.rounds.is_granted)):
            self.parameters.flush()
        if holds_turn and self.rounds.is_granted:
            last = wire.report(self.rounds.number, True, wire.NEVER, 0, self.rounds.take_items())
        else:
            last = wire.leave(reason)
        self.connection.try_to_send(last)
        self.scheduler.close()
        self.connection.close(self.is_told_to_end)
        self.charge.close()
        if self.is_told_to_end:
            finish.end_what_is_stuck()

    def interrupted(self, reason: str) -> None:
        """Tell the time master that the node has been told to end, before that has any effect. For any thread."""
        if self.scheduler.is_closed or self.is_told_to_end:
            return
        self.is_told_to_end = True
        self.scheduler.beside.clear()  # who was let go ends without another turn
        self.connection.try_to_send(wire.stopping(reason))

    def crashing(self) -> None:
        """Tell the time master that the process ends at once, by its own doing. For any thread."""
        if not self.scheduler.is_closed:
            self.connection.try_to_send(wire.crashing())

    def _leave_in_turn(self, reason: str) -> None:
        """Leave in a round, after the last messages of shutdown hooks. Do not wait longer than the leave limit."""
        over = _make_lock()
        over.acquire()

        def leave() -> None:
            self.leave(reason)
            over.release()
        self.scheduler.from_outside(leave)
        until = time.monotonic() + self._leave_seconds
        while not over.acquire(True, _LOOK_SECONDS) and not self.scheduler.is_closed and time.monotonic() < until:
            pass

    # --- for the other modules --------------------------------------------------------------------------------------

    def present(self, name: str, uri: str, rank: Optional[int]) -> None:
        """Say hello and wait for the first grant, which gives the turn to the calling thread.

        ``rank`` is None if the node has none of its own.
        """
        incarnation = (os.getpid() << 32) ^ (time.time_ns() & 0xffffffff)
        self.rounds.prepare(name)
        self.members.uris[name] = uri
        self.connection.send(wire.hello(name, uri, rank or 0, rank is not None, incarnation, secret()))
        self.members.names[0] = name
        self.rounds.begin({**self.topics.handlers(), **self.services.handlers()}, {
            wire.CHANGED: self._forget_parameters})
        self.scheduler.adopt_caller(threading.current_thread().name)

    def _forget_parameters(self) -> None:
        if self.parameters is not None:
            self.parameters.forget()

    def take_in(self, kind: int, body: bytes) -> None:
        """Handle a frame of the time master that is not a grant: about the participants, or the end of the run."""
        if kind == wire.END:
            reason, as_wished = wire.read_frame(kind, body)
            self._give_up('the time master has ended lockstep: {}'.format(reason), as_wished)
        if kind == wire.WELCOME:
            number, self.rank, leave_limit_ns, busy_limit_ns, excluded, self.has_radio = wire.read_frame(kind, body)
            silence.watch(self, busy_limit_ns)
            self._leave_seconds = leave_limit_ns * 1e-9
            self.topics.excluded.update(excluded)
            self.members.names[number] = self.members.own_name
        elif kind == wire.MEMBER:
            self.topics.drop_connections_to(self.members.came(body))
        elif kind == wire.GONE:
            self.members.left(body)

    def lost(self, reason: str) -> NoReturn:
        """End the node, since the time master is gone, and time would stand still for ever.

        :raises TurnLost: always.
        """
        self._give_up('the time master has ended lockstep: {}'.format(reason))

    def _give_up(self, reason: str, as_wished: bool = False) -> NoReturn:
        """Leave the run and end the node, with an error unless the run has ended ``as_wished``."""
        if not self.scheduler.is_closed:
            self.scheduler.close()
            self.connection.try_to_send(wire.leave(reason))
            self.connection.close()
            self.charge.close()
            # Not in this thread, since a shutdown hook may wait for it.
            finish.end_node(reason, as_wished)
        raise TurnLost()


class Members:
    """The participants: ``names`` {number: name}, with this process's own name also at 0, and ``uris`` {name: URI}."""

    def __init__(self) -> None:
        self.names: Dict[int, str] = {}
        self.uris: Dict[str, str] = {}
        self.gone: Set[str] = set()  # names of participants that have left

    @property
    def own_name(self) -> str:
        """The name of this process's node."""
        return self.names[0]

    @property
    def there(self) -> Set[str]:
        """The names of all present participants."""
        return set(self.names.values()) - self.gone

    def is_member(self, name: str) -> bool:
        """Return whether the node ``name`` takes part, or has taken part."""
        return name in self.uris

    def came(self, body: bytes) -> str:
        """Note the new participant in the ``body`` of a MEMBER frame; return its name."""
        name: str
        number, name, uri = wire.read_frame(wire.MEMBER, body)
        self.names[number] = name
        self.uris[name] = uri
        self.gone.discard(name)
        return name

    def left(self, body: bytes) -> None:
        """Note that the participant in the ``body`` of a GONE frame has left.

        Its connections are closed by items of a grant. Its name and URI are kept: its process ends at some moment of
        the wall clock, and until then must not be taken for a node that never took part.
        """
        number, = wire.read_frame(wire.GONE, body)
        self.gone.add(self.names.get(number, ''))


def _to_json(values: Sequence[Any]) -> str:
    """Return the ``values`` of a line of the event log as JSON; each by itself, in a third of json.dumps' time."""
    parts = []
    for value in values:
        if type(value) is float and isfinite(value):
            parts.append(repr(value))
        else:
            parts.append(_encode_text(value) if type(value) is str else _encode(value))
    return '[{}]'.format(','.join(parts))
