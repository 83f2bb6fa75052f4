"""One process that takes part in lockstep: how it says hello, what its users ask of it, how it leaves."""
import os
import threading
import time

import rospy

from move_base_abstract.common.units import seconds_to_ns
from move_base_abstract.lockstep import wire
from move_base_abstract.lockstep.scheduler import TurnLost, _make_lock

from ..exchange.access import secret
from ..exchange.connection import Closed
from ..exchange.log_values import to_json
from ..exchange.services import Services
from ..exchange.topics import Topics
from . import finish, silence
from .members import Members
from .rounds import Rounds

_LOOK_SECONDS = 0.05  # wall; so soon the end of lockstep is seen by who waits for something else


class Participant:
    """Made by :func:`join`. Whoever calls it holds the participant's turn, unless said otherwise."""

    def __init__(self, connection, charge):
        self.connection = connection
        self.charge = charge
        self.rounds = Rounds(self, connection, charge)
        self.scheduler = self.rounds.scheduler
        self.members = Members()
        #: as of Rounds
        self.add, self.add_aside, self.last_words = self.rounds.add, self.rounds.add_aside, self.rounds.last_words
        self.rank, self.has_radio = 0, False  # has_radio: robots tell how they move
        self._leave_seconds = 0.0  # wall
        self.parameters = None
        #: whether somebody has told the node to end, at some moment of the wall clock
        self.is_told_to_end = False
        self.topics = Topics(self)
        self.services = Services(self)

    # --- what users call --------------------------------------------------------------------------------------------

    @property
    def now_ns(self):
        """The simulated time of the present grant [ns]."""
        return self.scheduler.now_ns

    def log(self, robot, kind, values=(), sub=0):
        """Add a line to the run's event log: who, what, details (a sequence of numbers and texts)."""
        self.add(wire.log(sub, robot, kind, to_json(values)))

    def label(self, text):
        """Have the run called not repeatable, because of ``text``."""
        self.add(wire.note(wire.NoteKind.NOT_REPEATABLE, text))

    def be_strict(self):
        """Have the run end, with an error, with the first label that anybody gives it."""
        self.add(wire.note(wire.NoteKind.STRICT, ''))

    def constant(self, topic):
        """Take what non-participants publish on ``topic`` as there from the beginning.

        In this node's first round, in which time stands still, it is delivered at once, in rospy's own thread, and
        labels nothing. What comes later is input from outside.
        """
        self.topics.constants.add(rospy.resolve_name(topic))

    def exclude(self, topic):
        """Have ``topic`` not counted: it goes over rospy's own connections, at moments of the wall clock."""
        self.topics.excluded.add(rospy.resolve_name(topic))

    def wait_until(self, condition, timeout=None, what='something'):
        """Let the others go on until ``condition()`` holds; return whether it does when ``timeout`` [s] is over.

        It is looked at whenever something has happened in this process. ``what`` is shown by ``why``.

        :raises rospy.ROSInterruptException: if the run ends meanwhile.
        """
        wake_ns = wire.NEVER if timeout is None else self.now_ns + seconds_to_ns(timeout)
        try:
            return bool(self.scheduler.wait_until(condition, wake_ns, what))
        except TurnLost:
            raise rospy.ROSInterruptException('lockstep has ended') from None

    def set_source(self, source):
        """Have events driven by the grants: ``source.next_due_ns()`` -> int or None, ``source.run(now_ns)``.

        One that can tell some of them beforehand has what :class:`.Foresight` asks for.
        """
        self.rounds.set_source(source, lambda: rospy.get_param('~foresee', True) is not False)

    def serve(self):
        """Let callbacks and events go on without the calling thread, which does nothing more by itself."""
        self.scheduler.finish()

    def leave(self, reason='it has left'):
        """Take no more part; the process sees no time any more. Of use at its end only."""
        if self.scheduler.is_closed:
            return
        holds_turn = self.scheduler.is_mine()
        if not holds_turn and self.scheduler.has_outside:
            self._leave_in_turn(reason)
            if self.scheduler.is_closed:
                return
        if self.parameters is not None and (self.is_told_to_end or not (holds_turn and self.rounds.is_granted)):
            self.parameters.flush()
        try:
            if holds_turn and self.rounds.is_granted:
                self.connection.send(wire.report(self.rounds.number, True, wire.NEVER, 0, self.rounds.take_items()))
            else:
                self.connection.send(wire.leave(reason))
        except Closed:
            pass
        self.scheduler.close()
        self.connection.close(self.is_told_to_end)
        self.charge.close()
        if self.is_told_to_end:
            finish.end_what_is_stuck()

    def interrupted(self, reason):
        """The node is told to end, at some moment of the wall clock: say so before anything comes of it; any thread."""
        if self.scheduler.is_closed or self.is_told_to_end:
            return
        self.is_told_to_end = True
        try:
            self.connection.send(wire.stopping(reason))
        except Closed:
            pass

    def _leave_in_turn(self, reason):
        """Leave in a round, after what hooks have published at last; but not at any price, others may be slow."""
        over = _make_lock()
        over.acquire()

        def leave():
            self.leave(reason)
            over.release()
        self.scheduler.from_outside(leave)
        until = time.monotonic() + self._leave_seconds
        while not over.acquire(True, _LOOK_SECONDS) and not self.scheduler.is_closed and time.monotonic() < until:
            pass

    # --- what the other parts call ----------------------------------------------------------------------------------

    def tell_busy(self, round_number, where):
        """Say where the thread is that has the turn; from any thread."""
        try:
            self.connection.send(wire.busy(round_number, where))
        except Closed:
            pass

    def present(self, name, uri, rank):
        """Say hello and wait for the first grant, in which the calling thread gets the turn; ``rank``: None if none."""
        incarnation = (os.getpid() << 32) ^ (time.time_ns() & 0xffffffff)
        self.rounds.prepare(name)
        self.members.uris[name] = uri
        self.connection.send(wire.hello(name, uri, rank or 0, rank is not None, incarnation, secret()))
        self.members.names[0] = name
        topics, services = self.topics, self.services
        self.rounds.begin({
            wire.PUBLISHER: topics.on_publisher, wire.NO_PUBLISHER: topics.on_no_publisher,
            wire.SUBSCRIBER: topics.on_subscriber, wire.NO_SUBSCRIBER: topics.on_no_subscriber,
            wire.DELIVER: topics.on_deliver, wire.HEARD: topics.on_heard, wire.CALL_IN: services.on_called,
            wire.ANSWER: services.on_answered, wire.FOUND: services.on_found,
            wire.CHANGED: lambda: self.parameters and self.parameters.forget()})
        self.scheduler.adopt_caller(threading.current_thread().name)

    def take_in(self, kind, body):
        """Take in what the time master tells beside the grants: who is there, and the end of the run."""
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

    def lost(self, reason):
        """The time master is gone, so that time will never move again: end the node."""
        return self._give_up('the time master has ended lockstep: {}'.format(reason))

    def _give_up(self, reason, as_wished=False):
        """Take no more part; the node ends, with an error unless the run's end is ``as_wished``."""
        if not self.scheduler.is_closed:
            self.scheduler.close()
            try:
                self.connection.send(wire.leave(reason))
            except Closed:
                pass
            self.connection.close()
            self.charge.close()
            # Not in this thread: it may be one that a shutdown hook waits for.
            finish.end_node(reason, as_wished)
        raise TurnLost()
