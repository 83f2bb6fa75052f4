"""The one queue from which every event of a simulation comes."""
from __future__ import annotations

import math
from collections import deque
from heapq import heapify, heappop, heappush
from itertools import chain
from typing import TYPE_CHECKING, Any, Callable, Deque, Dict, List, Optional, Tuple

from .series import ONLOOKERS

if TYPE_CHECKING:
    from .series import Series
    from .simulation import Simulation

    _Entry = Tuple[int, int, int, 'Event']


class Event:
    """Something that will happen: a call of ``action(due_ns, now_ns)``.

    ``due_ns`` [ns] is when it is due; ``now_ns`` [ns] is the time that the clock shows at the call, the same or later.
    ``keeps_going()`` returns whether time goes on for this event alone; None: it does. ``output`` is the event's
    :class:`Series` if that is output, otherwise None.
    """

    __slots__ = ('action',)

    action: Optional[Callable[[int, int], Any]]
    output: Optional[Series] = None
    keeps_going: Optional[Callable[[], bool]] = None

    def __lt__(self, _other: Event) -> bool:
        """Return False: two events with the same place are of one series, and one of them is cancelled."""
        return False

    def cancel(self) -> None:
        """Cancel this event. It may be cancelled twice, and after it has happened."""
        self.action = None


class _SpecialEvent(Event):
    """An event that tells, or for which alone time does not always go on; most events are neither."""

    __slots__ = ('output', 'keeps_going')


_new_event = Event.__new__  # called without a constructor of ours, which would take most of the time

#: the index from which on events are calls of users and what follows from them; robots have lower ones
USERS = 2 ** 31 - 1

#: added to the places of series of output, so that they come after all other events of an instant and robot
_OUTPUT = 1 << 62
_NO_INDEX = 1 << 62  # above those of all robots
_FEWEST_SWEPT = 4096  # with fewer entries the queue is not searched for cancelled ones


class EventQueue:
    """Events in the order of their time; at the same instant: lower robot index first, then first scheduled.

    What concerns several robots is decided (:meth:`decide`) when all that robots do at an instant has happened, so it
    does not depend on their order. Then users' calls come, all that are due; what follows from these is decided after
    them, and so on.

    A :class:`Series` that is output comes after the robot's other events of that instant. So its place does not depend
    on when somebody began to listen.
    """

    def __init__(self, now_ns: int = -1) -> None:
        # Of (due_ns, robot index, number, Event): tuples, because tuples are compared fastest.
        self._heap: List[_Entry] = []
        # A second heap, of what is due at the instant that is happening: it is short, so it is fast.
        self._soon: List[_Entry] = []
        # A third queue, of what comes at its end: items to be told and events, as they came; see tell_at_end().
        self._ends: Deque[Any] = deque()
        self._decisions: Deque[Tuple[int, Callable[[int, int], Any]]] = deque()  # (due_ns, action)
        self._when_quiet: Dict[Callable[[int, int], Any], bool] = {}
        self._end_index = _NO_INDEX
        self._tell_end: Callable[[Any], object] = self._ends.append
        self._instant_ns = now_ns  # the instant of the event that has happened last, or up to which all has happened
        self._sweep_at = _FEWEST_SWEPT
        self._sequence = 0
        #: whether any event was ever scheduled with ``keeps_going``
        self.ever_waits = False
        self._output = 0
        self._output_places = 0
        self._asleep: List[Series] = []  # Series, in the order in which they fell asleep
        self._guards: Dict[int, Callable[[Exception], object]] = {}  # {robot index: break_off}

    def guard(self, robot_index: int, break_off: Optional[Callable[[Exception], object]]) -> None:
        """Call ``break_off(error)`` if an event of the robot raises ``error``, and go on; None: let errors through."""
        if break_off is None:
            self._guards.pop(robot_index, None)
        else:
            self._guards[robot_index] = break_off

    def tell_at_end(self, robot_index: int, tell: Callable[[Any], object]) -> Callable[[Any], None]:
        """Return a function that takes an item, for which ``tell(item)`` is called at the end of the present instant.

        That is where an event of ``robot_index`` would happen that is scheduled now. A queue has one such function.
        """
        self._end_index, self._tell_end = robot_index, tell
        return self._ends.append

    def decide(self, now_ns: int, action: Callable[[int, int], Any]) -> None:
        """Call ``action(due_ns, now_ns)`` when robots have done all that they do at this instant, ``now_ns`` [ns]."""
        self._decisions.append((now_ns, action))

    def when_quiet(self, action: Callable[[int, int], Any]) -> None:
        """Call ``action(due_ns, now_ns)`` once, at the end of the next instant after which the queue is not busy."""
        self._when_quiet[action] = True

    @property
    def is_ending(self) -> bool:
        """Whether anything is still to be told or decided at the end of the present instant."""
        return bool(self._decisions) or any(
            not isinstance(item, Event) or item.action is not None for item in self._ends)

    def new_output_place(self) -> int:
        """Return the place of a new series of output, among the events of one instant and robot."""
        self._output_places += 1
        return _OUTPUT + self._output_places

    def count_output(self, change: int) -> None:
        """Note that ``change`` (1, 0 or -1) more series of output have an event in the queue."""
        self._output += change

    def sleep(self, series: Series) -> None:
        """Note that nobody hears the :class:`Series`, so that it has no event until its :meth:`Series.wake`."""
        self._asleep.append(series)

    def forget_sleeper(self, series: Series) -> None:
        """Note that the series is no longer asleep: it has been stopped or woken."""
        self._asleep.remove(series)

    def sleepers(self) -> List[Series]:
        """Return the series that are asleep although somebody would hear them now."""
        return [series for series in self._asleep if series.is_heard()]

    def schedule(self, due_ns: int, robot_index: int, action: Callable[[int, int], Any],
                 output: Optional[Series] = None, keeps_going: Optional[Callable[[], bool]] = None) -> Event:
        """Schedule ``action(due_ns, now_ns)`` at ``due_ns`` [ns]; return its :class:`Event`, which can be cancelled.

        ``keeps_going()`` returns whether time goes on for this event alone. It is given for events that come by
        themselves while nobody does anything, for example the end of a charge.
        """
        place = self._sequence
        if output is None and keeps_going is None:
            event = _new_event(Event)
            self._sequence = place + 1
        else:
            event = _SpecialEvent()
            event.output, event.keeps_going = output, keeps_going
            if keeps_going is not None:
                self.ever_waits = True
            if output is None:
                self._sequence = place + 1
            else:
                place = output.place  # type: ignore[assignment]
        event.action = action
        if due_ns <= self._instant_ns:
            if robot_index == self._end_index:
                self._ends.append(event)
            else:
                heappush(self._soon, (due_ns, robot_index, place, event))
            return event
        if len(self._heap) >= self._sweep_at:
            self._sweep()
        heappush(self._heap, (due_ns, robot_index, place, event))
        return event

    def _settle(self) -> None:
        """Have all events in one heap, for methods that look at it from outside of a run."""
        for entry in self._soon:
            heappush(self._heap, entry)
        self._soon.clear()

    def _sweep(self) -> None:
        """Drop cancelled events, of which those of far instants would stay for long; this does not change the order."""
        self._heap[:] = [entry for entry in self._heap if entry[3].action is not None]
        heapify(self._heap)
        self._sweep_at = max(_FEWEST_SWEPT, 2 * len(self._heap))

    def next_due_ns(self) -> Optional[int]:
        """Return when the next event is due [ns], or None if there is none."""
        if self._soon:
            self._settle()
        heap = self._heap
        while heap and heap[0][3].action is None:
            heappop(heap)
        due_ns = heap[0][0] if heap else None
        if self._decisions:
            return self._decisions[0][0] if due_ns is None else min(due_ns, self._decisions[0][0])
        return due_ns

    def is_busy(self) -> bool:
        """Return whether there is an event for which alone time goes on."""
        for entry in chain(self._heap, self._soon):
            event = entry[3]
            if event.action is not None and (event.keeps_going is None or event.keeps_going()):
                return True
        return self.is_ending

    def is_for_onlookers(self) -> bool:
        """Return whether there are events, but time goes on for none of them alone, or only for onlookers.

        That is: each event either does not keep time going, or is of a series that only onlookers hear.
        """
        is_any = False
        if self._decisions:
            return False
        for *_, event in chain(self._heap, self._soon):
            if event.action is not None:
                if event.keeps_going is not None:
                    if event.keeps_going():
                        return False
                elif event.output is None or event.output.is_heard() != ONLOOKERS:
                    return False
                is_any = True
        return is_any

    def run_until(self, until_ns: Optional[int], present: Simulation, instant_by_instant: bool = False,
                  decides: bool = True) -> None:
        """Run all events that are due at ``until_ns`` [ns] or before, in order, with those scheduled meanwhile.

        ``present.now_ns`` [ns] is set to the time of each event before it happens, and never back. The actions get
        ``until_ns`` as the time of the clock, or, with ``instant_by_instant``, the time at which each is due. None:
        this goes on as long as the queue :meth:`is_busy`. Unless ``decides``, nothing is decided at ``until_ns`` yet.
        """
        later, soon, ends = self._heap, self._soon, self._ends
        end_ns, open_ns, entered_ns = math.inf if until_ns is None else until_ns, None if decides else until_ns, -1
        turn: Optional[int] = None  # in a turn of users' calls: how many of those that were to be told are left
        while later or soon or ends or self._decisions or (self._when_quiet and decides):
            heap = soon if soon and (not later or soon[0] < later[0]) else later
            if heap and heap[0][3].action is None:  # cancelled
                heappop(heap)
                continue
            if (self._decisions or self._when_quiet and not (heap and heap[0][3].keeps_going is None)) and (
                    self._is_time_to_decide(heap, turn, present.now_ns, open_ns)):
                turn = None
                self._take_decision(instant_by_instant, until_ns)
                continue
            if ends and not (heap and heap[0][:2] <= (present.now_ns, self._end_index)):
                turn, entered_ns = (turn or len(ends)) - 1, present.now_ns
                self._take_end(present.now_ns, present.now_ns if instant_by_instant else until_ns)
                continue
            if not heap or heap[0][0] > end_ns:
                break
            if until_ns is None and self.ever_waits and heap[0][0] != entered_ns and not self.is_busy():
                return
            due_ns, robot_index, _, event = heappop(heap)
            action, event.action = event.action, None
            if due_ns != entered_ns or turn is None:
                entered_ns, turn = due_ns, len(ends) if robot_index >= USERS else None
            if heap is later:
                self._instant_ns, present.now_ns = max(due_ns, self._instant_ns), max(due_ns, present.now_ns)
            try:
                action(due_ns, due_ns if instant_by_instant else until_ns)  # type: ignore[arg-type,misc]
            except Exception as error:
                self._break_off(robot_index, error)
        self._instant_ns = max(self._instant_ns, -1 if until_ns is None else until_ns)

    def _is_time_to_decide(self, heap: List[_Entry], turn: Optional[int], now_ns: int, open_ns: Optional[int]) -> bool:
        """Return whether robots have done all of this instant, and a turn of users' calls has not begun or is over."""
        if not self._decisions and (open_ns is not None or not self._falls_quiet(heap, now_ns)):
            return False
        if self._decisions[0][0] == open_ns or (heap and heap[0][:2] < (now_ns, USERS)):
            return False
        return turn is None or (turn == 0 and not (heap and heap[0][0] <= now_ns))

    def _falls_quiet(self, heap: List[_Entry], now_ns: int) -> bool:
        """If this instant is over, and is the last one, have done what is to be done then; return whether it is so."""
        if (heap and (heap[0][0] <= now_ns or heap[0][3].keeps_going is None)) or self.is_busy():
            return False
        self._decisions.extend((now_ns, action) for action in self._when_quiet)
        self._when_quiet.clear()
        return True

    def _take_decision(self, instant_by_instant: bool, until_ns: Any) -> None:
        due_ns, decide = self._decisions.popleft()
        decide(due_ns, due_ns if instant_by_instant else until_ns)

    def _break_off(self, robot_index: int, error: Exception) -> None:
        break_off = self._guards.get(robot_index)
        if break_off is None:
            raise error
        break_off(error)

    def _take_end(self, due_ns: int, now_ns: Any) -> None:
        item = self._ends.popleft()
        if not isinstance(item, Event):
            self._tell_end(item)
        elif item.action is not None:
            action, item.action = item.action, None
            action(due_ns, now_ns)

    def heard_output(self, before_ns: int) -> Tuple[List[Tuple[int, Series]], int]:
        """Return ([(due_ns, Series), ...], end_ns): the heard series of output, in their order at an instant.

        ``due_ns`` [ns] is when each is due next. ``end_ns`` [ns] is ``before_ns``, or
        when anything else is due, if that is earlier. Series that nobody hears any more fall asleep.
        """
        first_ns = self.next_due_ns()
        if not self._output:
            return [], before_ns if first_ns is None else min(before_ns, first_ns)
        heard, cancelled = [], 0
        for due_ns, robot_index, place, event in self._heap:
            if event.action is None:
                cancelled += 1
            elif event.output is None:
                before_ns = min(before_ns, due_ns)
            elif event.output.is_heard():
                heard.append((robot_index, place, due_ns, event.output))
            else:
                event.cancel()
                event.output.fall_asleep(due_ns)
        heard.sort()
        if 2 * cancelled > len(self._heap):  # so that the next call is not slow again
            self._sweep()
        return [one[2:] for one in heard], before_ns

    def shift(self, by_ns: int) -> None:
        """Move all events by ``by_ns`` [ns]; their order stays."""
        self._settle()
        self._instant_ns = -1
        self._heap[:] = [(due_ns + by_ns, *rest) for due_ns, *rest in self._heap]  # type: ignore[misc]
        self._decisions = deque((due_ns + by_ns, action) for due_ns, action in self._decisions)
        for series in self._asleep:
            series.shift(by_ns)
