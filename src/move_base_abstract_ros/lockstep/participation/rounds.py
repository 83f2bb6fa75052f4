"""The rounds of a participant: its report when none of its threads can go on, and what the next grant tells it to do.

With a window (:mod:`move_base_abstract.lockstep.window`) it goes through several turns by itself before it reports.
"""
from __future__ import annotations

from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterator, List, Optional, Tuple, Union

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.lockstep import open_waits, wire
from move_base_abstract.lockstep.charge import NoCharge
from move_base_abstract.lockstep.scheduler import Scheduler
from move_base_abstract.lockstep.task import TurnLost
from move_base_abstract.lockstep.window import Window

from ..exchange.connection import Closed
from ..exchange.playing import Player
from ..waiting import pools
from . import finish, garbage
from .report_delays import make_beginning, make_delay
from .rospy_time import set_rostime

if TYPE_CHECKING:
    from ...clocks.lockstep_clock import LockstepClock
    from ..exchange.connection import Connection
    from .taking_part import Participant

_SENDS = (wire.SEND, wire.CALL, wire.RESPONSE)
#: an item of a report, or what makes it at the end of the round
Item = Union[bytes, Callable[[], bytes]]


class Rounds:
    """The rounds of one ``participant`` (Participant), and the channel of its scheduler.

    ``last_words`` are functions that are called when a turn is over, before it is reported.
    """

    def __init__(self, participant: Participant, connection: Connection, charge: Any) -> None:
        self.scheduler = Scheduler(self)
        self.charge = charge
        self.window = Window()
        self.last_words: List[Callable[[], None]] = []
        self.number = 0
        self.is_granted = self.is_at_rest = False
        self.is_starting, self._keeps_starting = True, False
        self._participant = participant
        self._connection = connection
        self._items: List[Item] = []
        self._is_charged = type(charge) is not NoCharge
        self._player: Any = None
        self._source_is_background: Callable[[], bool] = bool
        self._undone: Callable[[], str] = str
        self._has_mail = False
        self._told = ''
        self._delay = self._begin = None
        self._handlers: Dict[int, Callable[..., None]] = {}
        self._at_once: Dict[int, Callable[..., None]] = {}

    def prepare(self, name: str) -> None:
        """Read how reports of the node ``name`` are delayed, before it says hello.

        :raises ConfigurationError: if an environment variable for that has a wrong form.
        """
        self._delay, self._begin = make_delay(name), make_beginning(name)

    def begin(self, handlers: Dict[int, Callable[..., None]], at_once: Dict[int, Callable[..., None]]) -> None:
        """Wait for the first grant.

        ``handlers`` is {kind of a grant's item: function of its values, to be called in the turn}; the functions of
        ``at_once`` are called before.
        """
        self._handlers, self._at_once = handlers, at_once
        self.await_grant()

    @contextmanager
    def still_starting(self) -> Iterator[None]:
        """Give a context in the first round: rounds that end in it, and that in which it ends, count as first."""
        self._keeps_starting = True
        try:
            yield
        finally:
            self._keeps_starting = False

    def set_source(self, source: LockstepClock, plays: Callable[[], bool]) -> None:
        """Drive the events of ``source`` by the grants, see :meth:`.Participant.set_source`.

        ``plays()`` returns whether the time master plays output; it is called if the source has output.
        """
        self.scheduler.set_source(source)
        self._source_is_background = getattr(source, 'is_background', bool)
        self._undone = getattr(source, 'undone', str)
        if hasattr(source, 'played'):
            self._player = Player(source, not self._is_charged and plays())

    def add(self, item: Item) -> None:
        """Add ``item`` to the next report: bytes, or a function that returns them at the end of the round.

        Any thread may call this. For a thread without the turn the item comes a round later.
        """
        if self.scheduler.acts():
            self._items.append(item)
        elif not self.scheduler.is_closed:
            self.scheduler.from_outside(lambda: self._items.append(item))

    def add_aside(self, item: Item) -> None:
        """Add ``item`` to the next report, but do not count that as work: the thread may still only wait by looking.

        (:meth:`add` counts as work: the thread does something on which others may wait.)
        """
        self._items.append(item)

    @property
    def granted(self) -> Optional[int]:
        """The number of the present round, or None if this participant has no grant at the moment. For any thread."""
        return self.number if self.is_granted and not self.scheduler.is_closed else None

    def exchange(self) -> List[Callable[..., Any]]:
        """Report and wait for the next grant; return the functions to be called in it, in order. For the scheduler."""
        pools.await_results(self.scheduler)
        deferred = self.let_time_pass()
        next_ns = self.scheduler.now_ns if deferred else self.scheduler.next_ns()
        is_resting = self.scheduler.is_resting
        if is_resting:
            self._items.append(wire.rest())
        self._report(next_ns, may_play=self.scheduler.is_source_alone and not (deferred or is_resting))
        actions = self.await_grant()
        # No mail has come, and no other thread had asked for a round.
        self.is_at_rest = is_resting and not (
            self._has_mail or self.scheduler.has_outside or next_ns <= self.scheduler.now_ns)
        return deferred + actions + garbage.due()

    def let_time_pass(self) -> List[Any]:
        """Let the round's charged time pass, if it has sent anything; return the functions of grants meanwhile."""
        try:
            cost_ns = self.charge.cost_ns(self.scheduler.now_ns) if self._is_charged and self._sends else 0
        except ConfigurationError as error:
            self._items.clear()  # the items would have left after the charged time
            self._participant.label(str(error))
            self._participant.leave()
            finish.end_node(str(error), False)
            raise TurnLost() from None
        return self._compute(cost_ns) if cost_ns > 0 else []

    @property
    def _sends(self) -> bool:
        """Whether this round has sent messages, calls or responses."""
        return any(not callable(item) and item[0] in _SENDS for item in self._items)

    def _compute(self, cost_ns: int) -> List[Any]:
        """Let ``cost_ns`` [ns] pass before the round's items leave; return the functions of grants meanwhile."""
        held = self._items[:]
        self._items.clear()
        until_ns = self.scheduler.now_ns + cost_ns
        deferred = []
        while self.scheduler.now_ns < until_ns:
            self._report(until_ns)
            deferred += self.await_grant()
        self._items[:0] = held
        return deferred

    def take_items(self) -> List[bytes]:
        """Return the items (bytes) of all turns since the last report."""
        self._end_turn()
        return self.window.take_walked(self._items)

    def _end_turn(self) -> None:
        for tell in self.last_words:
            tell()
        self._items[:] = [item() if callable(item) else item for item in self._items]

    def _report(self, next_ns: int, may_play: bool = False) -> None:
        if may_play and self._player is not None and next_ns > self.scheduler.now_ns:
            next_ns = self._player.tell(self.scheduler.now_ns, min(
                self.scheduler.next_besides_source_ns(), self.window.first_arrival_ns), self._items)
        # Only onlookers would notice. (Not before: output that nobody hears any more would be a reason to go on.)
        is_background = (may_play and self.scheduler.now_ns < next_ns < wire.NEVER
                         and self.scheduler.next_besides_source_ns() == wire.NEVER and self._source_is_background())
        if self.window.is_open:
            self.is_starting = self._keeps_starting
            self._end_turn()
            is_free = not (is_background or self.scheduler.has_outside)
            if is_free and self.window.walk(next_ns, self.scheduler.now_ns, self._items):
                return
            is_background = is_background and self.window.first_arrival_ns == wire.NEVER
            next_ns = min(next_ns, self.window.first_arrival_ns)
        waits, told = self.scheduler.open_waits, ''
        undone = self._undone() if next_ns == wire.NEVER else ''
        if (waits or undone) and next_ns == wire.NEVER:
            told = ', '.join([*('{} waits for {}'.format(task.name, task.waits_for or 'another thread')
                                for task in waits), *([undone] if undone else [])])
        if told != self._told:
            self._told = told
            self._items.append(wire.note(wire.NoteKind.WAITS_FOR, told))
        owed, idle = open_waits.split(waits) if waits else ((), ())
        self._items += [wire.idle(len(idle))] if idle else []
        self.is_granted = False
        self.is_starting = self._keeps_starting
        if is_background:
            self._items.append(wire.background())
        if self._delay is not None:
            self._delay()
        try:
            self._connection.send(wire.report(self.number, False, next_ns, len(owed) + bool(undone), self.take_items()))
        except Closed as error:
            self._participant.lost(str(error))

    def await_grant(self) -> List[Callable[..., Any]]:
        """Wait for the next grant, and return its items as functions to be called in this order."""
        if self.window.walks_to_ns is not None:
            return self._begin_turn(*self.window.next_turn())
        try:
            while True:
                kind, body = self._connection.receive()
                if kind == wire.GRANT:
                    if self._begin is not None:
                        self._begin()
                    self.number, now_ns, microstep, items = wire.read_grant(body)
                    items = self.window.take(items, now_ns)
                    return self._begin_turn(now_ns, items, microstep > 0 and not self.window.is_open)
                self._participant.take_in(kind, body)
        except (Closed, wire.WireError) as error:
            return self._participant.lost(str(error))

    def _begin_turn(self, now_ns: int, items: List[Tuple[Any, ...]], is_late: bool = False) -> List[Callable[..., Any]]:
        """``is_late``: whether what was due at ``now_ns`` [ns] has happened in an earlier round."""
        self.is_granted, self._has_mail = True, any(item[0] != wire.CHANGED for item in items)
        self.charge.begin()
        if now_ns != self.scheduler.now_ns:
            self.scheduler.now_ns = self.scheduler.shown_ns[0] = now_ns
            set_rostime(now_ns)
        if self._player is not None:  # before all else; series without a message are not told of by the time master
            told_ns = items.pop(0)[1] if items and items[0][0] == wire.HAPPENED else 0
            self._player.happened(max(told_ns, now_ns if is_late else now_ns - 1))
        actions: List[Callable[..., Any]] = []
        for item in items:
            if item[0] in self._at_once:
                self._at_once[item[0]](*item[1:])
            else:
                actions.append(partial(self._handlers[item[0]], *item[1:]))
        return actions

    def knock(self) -> None:
        """Ask the time master for a grant. For any thread."""
        self._connection.try_to_send(wire.frame(wire.KNOCK))
