"""One process that takes part in lockstep: what it tells the time master, and what becomes of what it is told."""
import os
import threading
import time

import rospy

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.units import seconds_to_ns
from move_base_abstract.lockstep import open_waits, wire
from move_base_abstract.lockstep.charge import NoCharge
from move_base_abstract.lockstep.scheduler import Scheduler, TurnLost, _make_lock
from move_base_abstract.lockstep.window import Window

from ..exchange.access import secret
from ..exchange.connection import Closed
from ..exchange.foresight import Foresight
from ..exchange.log_values import to_json
from ..exchange.services import Services
from ..exchange.topics import Topics
from ..waiting import pools
from . import finish, garbage, silence
from .report_delays import make_beginning, make_delay
from .rospy_time import set_rostime

_SENDS = (wire.SEND, wire.CALL, wire.RESPONSE)
_LOOK_SECONDS = 0.05  # wall; so soon the end of lockstep is seen by who waits for something else


class Participant:
    """Made by :func:`join`. Whoever calls it holds the participant's turn, unless said otherwise."""

    def __init__(self, connection, charge):
        self.scheduler = Scheduler(self)
        self.connection = connection
        self.rank, self.has_radio = 0, False  # has_radio: robots tell how they move
        self._leave_seconds = 0.0  # wall
        self.names = {}
        self.uris = {}
        self.gone = set()  # names of those that took part
        self.parameters = None
        self.sub = 0
        self.microstep = 0
        self._round = 0
        self._items = []
        self.last_words = []  # functions that are called when a turn is over, before it is reported
        self.window = Window()
        self.charge = charge
        self._is_charged = type(charge) is not NoCharge
        self._foresight = self._source_is_background = None
        self._is_granted = self.is_at_rest = self._has_mail = False
        self.is_starting = True
        self._is_interrupted = False
        self._told = ''
        self._delay = self._begin = None
        self.topics = Topics(self)
        self.services = Services(self)
        self._handlers = {wire.PUBLISHER: self.topics.on_publisher, wire.NO_PUBLISHER: self.topics.on_no_publisher,
                          wire.SUBSCRIBER: self.topics.on_subscriber, wire.NO_SUBSCRIBER: self.topics.on_no_subscriber,
                          wire.DELIVER: self.topics.on_deliver, wire.CALL_IN: self.services.on_called,
                          wire.ANSWER: self.services.on_answered, wire.FOUND: self.services.on_found,
                          wire.HAPPENED: self._on_happened, wire.HEARD: self.topics.on_heard,
                          wire.CHANGED: lambda: self.parameters and self.parameters.forget()}

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
        self.scheduler.set_source(source)
        self._source_is_background = getattr(source, 'is_background', None)
        if not self._is_charged and hasattr(source, 'foresee') and rospy.get_param('~foresee', True) is not False:
            self._foresight = Foresight(source)

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
        if self.parameters is not None and (self._is_interrupted or not (holds_turn and self._is_granted)):
            self.parameters.flush()
        try:
            if holds_turn and self._is_granted:
                self.connection.send(wire.report(self._round, True, wire.NEVER, 0, self._take_items()))
            else:
                self.connection.send(wire.leave(reason))
        except Closed:
            pass
        self.scheduler.close()
        self.connection.close(self._is_interrupted)
        self.charge.close()
        if self._is_interrupted:
            finish.end_what_is_stuck()

    def interrupted(self, reason):
        """The node is told to end, at some moment of the wall clock: say so before anything comes of it; any thread."""
        if self.scheduler.is_closed or self._is_interrupted:
            return
        self._is_interrupted = True
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

    def add(self, item):
        """Have ``item`` (bytes, or a function that returns them at the end of the round) in the next report."""
        if self.scheduler.acts():
            self._items.append(item)
        elif not self.scheduler.is_closed:
            self.scheduler.from_outside(lambda: self._items.append(item))

    def add_aside(self, item):
        """The same, for what nobody waits for: a thread that does nothing else may still be one that looks."""
        self._items.append(item)

    def tell_busy(self, round_number, where):
        """Say where the thread is that has the turn; from any thread."""
        try:
            self.connection.send(wire.busy(round_number, where))
        except Closed:
            pass

    @property
    def granted(self):
        """The number of the round that is being worked on, None if none is; from any thread."""
        return self._round if self._is_granted and not self.scheduler.is_closed else None

    def is_member(self, name):
        """Return whether the node ``name`` takes part (as far as this process has been told)."""
        return name in self.uris

    @property
    def there(self):
        """The names of all that take part."""
        return set(self.names.values()) - self.gone

    @property
    def is_told_to_end(self):
        """Whether somebody has told the node to end, at some moment of the wall clock."""
        return self._is_interrupted

    def knock(self):
        """Ask for a grant; from any thread."""
        try:
            self.connection.send(wire.frame(wire.KNOCK))
        except Closed:
            pass

    # --- rounds -----------------------------------------------------------------------------------------------------

    def present(self, name, uri, rank):
        """Say hello and wait for the first grant, in which the calling thread gets the turn; ``rank``: None if none."""
        incarnation = (os.getpid() << 32) ^ (time.time_ns() & 0xffffffff)
        self._delay, self._begin = make_delay(name), make_beginning(name)
        self.uris[name] = uri
        self.connection.send(wire.hello(name, uri, rank or 0, rank is not None, incarnation, secret()))
        self.names[0] = name
        self._await_grant()
        self.scheduler.adopt_caller(threading.current_thread().name)

    def exchange(self):
        """Report and wait for the next grant; return what is to be done in it, in order (for the scheduler)."""
        pools.await_results(self.scheduler)
        deferred = self.let_time_pass()
        next_ns = self.now_ns if deferred else self.scheduler.next_ns()
        is_resting = self.scheduler.is_resting
        if is_resting:
            self._items.append(wire.rest())
        self._report(next_ns, may_foresee=not (deferred or is_resting))
        actions = self._await_grant()
        # Nothing has come, and nothing else was asked for.
        self.is_at_rest = is_resting and not (
            self._has_mail or self.scheduler.has_outside or next_ns <= self.now_ns)
        return deferred + actions + garbage.due()

    def goes_on_to(self, due_ns):
        """Begin the turn at ``due_ns`` [ns] as :meth:`exchange` would if nothing but time came; else return False."""
        if self._foresight is None or not self.window.is_open or due_ns >= self.window.first_arrival_ns:
            return False
        self._end_turn()
        self.is_starting = False
        is_free = not (self._is_background() or self.scheduler.has_outside)
        if is_free and self.window.walk(due_ns, self.now_ns, self._items):
            self._begin_turn(*self.window.next_turn())
            return True
        return False

    def let_time_pass(self):
        """Charge the round that ends, if it has sent anything; return what has come meanwhile."""
        try:
            cost_ns = self.charge.cost_ns(self.now_ns) if self._is_charged and self._sends else 0
        except ConfigurationError as error:
            self._items.clear()  # what would have left after the charged time
            self.label(str(error))
            self.leave()
            finish.end_node(str(error), False)
            raise TurnLost() from None
        return self._compute(cost_ns) if cost_ns > 0 else []

    @property
    def _sends(self):
        """Whether this round has sent anything to others."""
        return any(not callable(item) and item[0] in _SENDS for item in self._items)

    def _compute(self, cost_ns):
        """Let simulated time pass, after which the round's messages leave; return what has come meanwhile."""
        held = self._items[:]
        self._items.clear()
        until_ns = self.now_ns + cost_ns
        deferred = []
        while self.now_ns < until_ns:
            self._report(until_ns)
            deferred += self._await_grant()
        self._items[:0] = held
        return deferred

    def _take_items(self):
        self._end_turn()
        return self.window.take_walked(self._items)

    def _end_turn(self):
        for tell in self.last_words:
            tell()
        self._items[:] = [item() if callable(item) else item for item in self._items]

    def _report(self, next_ns, may_foresee=False):
        is_background = may_foresee and self.now_ns < next_ns < wire.NEVER and self._is_background()
        if self.window.is_open:
            self.is_starting = may_foresee = False
            self._end_turn()
            is_free = not (is_background or self.scheduler.has_outside)
            if is_free and self.window.walk(next_ns, self.now_ns, self._items):
                return
            is_background = is_background and self.window.first_arrival_ns == wire.NEVER
            next_ns = min(next_ns, self.window.first_arrival_ns)
        waits, told = self.scheduler.open_waits, ''
        if waits and next_ns == wire.NEVER:
            told = ', '.join('{} waits for {}'.format(task.name, task.waits_for or 'another thread') for task in waits)
        if told != self._told:
            self._told = told
            self._items.append(wire.note(wire.NoteKind.WAITS_FOR, told))
        owed, idle = open_waits.split(waits) if waits else ((), ())
        self._items += [wire.idle(len(idle))] if idle else []
        self._is_granted = self.is_starting = False
        if is_background:
            self._items.append(wire.background())
        elif may_foresee and self._foresight is not None and self.scheduler.can_foresee and next_ns > self.now_ns:
            next_ns = self._foresight.tell(self.scheduler.next_besides_source_ns(), self._items)
        if self._delay is not None:
            self._delay()
        try:
            self.connection.send(wire.report(self._round, False, next_ns, len(owed), self._take_items()))
        except Closed as error:
            self._lost(str(error))

    def _is_background(self):
        """Whether only onlookers would notice, if time did not go on to the next event."""
        return (self._source_is_background is not None and self.scheduler.can_foresee
                and self.scheduler.next_besides_source_ns() == wire.NEVER and self._source_is_background())

    def _await_grant(self):
        """Return what the next grant lists, as functions to be called in this order."""
        if self.window.walks_to_ns is not None:
            return self._begin_turn(*self.window.next_turn())
        try:
            while True:
                kind, body = self.connection.receive()
                if kind == wire.GRANT:
                    if self._begin is not None:
                        self._begin()
                    self._round, now_ns, microstep, items = wire.read_grant(body)
                    return self._begin_turn(now_ns, microstep, self.window.take(items, now_ns))
                self._told_of_members(kind, body)
        except (Closed, wire.WireError) as error:
            return self._lost(str(error))

    def _begin_turn(self, now_ns, microstep, items):
        self.microstep = self.microstep + 1 if self.window.is_open and now_ns == self.now_ns else microstep
        self._is_granted, self._has_mail = True, any(item[0] != wire.CHANGED for item in items)
        self.charge.begin()
        if now_ns != self.scheduler.now_ns:
            self.scheduler.now_ns = self.scheduler.shown_ns[0] = now_ns
            set_rostime(now_ns)
        actions = []
        for item in items:
            action = self._handlers[item[0]](*item[1:])
            if action is not None:
                actions.append(action)
        return actions

    def _on_happened(self, count):
        """At once, before all else: what was told beforehand, and has not happened, is taken back."""
        self._foresight.came_to_pass(count)

    def _told_of_members(self, kind, body):
        if kind == wire.END:
            reason, as_wished = wire.read_frame(kind, body)
            self._give_up('the time master has ended lockstep: {}'.format(reason), as_wished)
        if kind == wire.WELCOME:
            number, self.rank, leave_limit_ns, busy_limit_ns, excluded, self.has_radio = wire.read_frame(kind, body)
            silence.watch(self, busy_limit_ns)
            self._leave_seconds = leave_limit_ns * 1e-9
            self.topics.excluded.update(excluded)
            self.names[number] = self.names[0]
        elif kind == wire.MEMBER:
            number, name, uri = wire.read_frame(kind, body)
            self.names[number] = name
            self.uris[name] = uri
            self.gone.discard(name)
            self.topics.drop_connections_to(name)
        elif kind == wire.GONE:
            # What there is to do comes in a grant. Until its process has ended, at some moment of the wall clock,
            # it is still to be told from nodes that do not take part.
            number, = wire.read_frame(kind, body)
            self.gone.add(self.names.get(number, ''))

    def _lost(self, reason):
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
