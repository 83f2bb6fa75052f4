"""The one queue from which every event of a simulation comes."""
from __future__ import annotations

import math
from collections import deque
from heapq import heapify, heappop, heappush
from itertools import chain
from typing import TYPE_CHECKING, Any, Callable, Deque, Dict, List, Optional, Tuple

if TYPE_CHECKING:
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

#: the index of events that decide about several robots: at an instant they come after all that robots, users and
#: processes do, so that they do not depend on the order of robots
DECISIONS = 2 ** 31 + 7

#: the listeners of a :class:`Series` that is output; time goes on for it alone only if participants listen
NOBODY, ONLOOKERS, PARTICIPANTS = 0, 1, 2

#: added to the places of series of output, so that they come after all other events of an instant and robot
_OUTPUT = 1 << 62
_NO_INDEX = 1 << 62  # above those of all robots
_FEWEST_SWEPT = 4096  # with fewer entries the queue is not searched for cancelled ones


class EventQueue:
    """Events in the order of their time; at the same instant: lower robot index first, then first scheduled.

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

    @property
    def is_ending(self) -> bool:
        """Whether anything is still to be told at the end of the present instant."""
        return any(not isinstance(item, Event) or item.action is not None for item in self._ends)

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
        return heap[0][0] if heap else None

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

        Unless ``decides``, those of ``until_ns`` with the index ``DECISIONS`` or above are left: more is to come.

        ``present.now_ns`` [ns] is set to the time of each event before it happens, and never back. The actions get
        ``until_ns`` as the time of the clock, or, with ``instant_by_instant``, the time at which each is due. If
        ``until_ns`` is None, this goes on as long as the queue :meth:`is_busy`.
        """
        later, soon, ends, entered_ns = self._heap, self._soon, self._ends, None
        end_ns = math.inf if until_ns is None else until_ns
        undecided_ns = None if decides else until_ns
        while later or soon or ends:
            heap = soon if soon and (not later or soon[0] < later[0]) else later
            if ends and not (heap and heap[0][:2] <= (present.now_ns, self._end_index)):
                self._take_end(present.now_ns, present.now_ns if instant_by_instant else until_ns)
                continue
            due_ns, robot_index, _, event = heap[0]
            if due_ns > end_ns or (due_ns == undecided_ns and robot_index >= DECISIONS):
                break
            action = event.action
            if action is None:  # cancelled
                heappop(heap)
                continue
            if until_ns is None and self.ever_waits and due_ns != entered_ns and not self.is_busy():
                return
            heappop(heap)
            event.action = None
            entered_ns = due_ns
            if heap is later:
                if due_ns > self._instant_ns:
                    self._instant_ns = due_ns
                if due_ns > present.now_ns:
                    present.now_ns = due_ns
            try:
                action(due_ns, due_ns if instant_by_instant else until_ns)  # type: ignore[arg-type]
            except Exception as error:
                break_off = self._guards.get(robot_index)
                if break_off is None:
                    raise
                break_off(error)
        if until_ns is not None and until_ns > self._instant_ns:
            self._instant_ns = until_ns

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
        for series in self._asleep:
            series.shift(by_ns)


class Series:
    """A periodic event: it is due at its start, and then every ``period_ns`` [ns], at exact multiples.

    ``action(due_ns, now_ns)`` is called at most once for each time that the clock shows: multiples that the clock has
    leapt over are left out, so that a fast clock does not flood the listeners. The k-th multiple stays at start + k *
    period exactly. If an action has nothing to do for a while, it may return for how long [ns]; the multiples in
    between are left out, too.

    ``is_output``: the action changes nothing that another event could see, so it can be done beforehand. Such a series
    has ``is_heard()``, which returns who listens: ``NOBODY``, ``ONLOOKERS`` or ``PARTICIPANTS``. While nobody does, the
    series sleeps, that is, it has no events. When it is woken (:meth:`Simulation.wake`), it goes on as if it had never
    slept. Its first event always happens.

    :raises ValueError: if the period is not > 0.
    """

    def __init__(self, queue: EventQueue, robot_index: int, period_ns: int, action: Callable[[int, int], Optional[int]],
                 is_output: bool = False, is_heard: Optional[Callable[[], int]] = None) -> None:
        if not period_ns > 0:
            raise ValueError('the period of a series must be > 0 ns, got {!r}'.format(period_ns))
        self._queue = queue
        self._robot_index = robot_index
        self.period_ns = period_ns
        self._action = action
        self._output = self if is_output else None
        self._event: Optional[Event] = None
        self._asleep_until_ns: Optional[int] = None
        self.is_heard = is_heard or _always
        self.place = queue.new_output_place() if is_output else None

    def start(self, first_ns: int) -> None:
        """Start anew, with the first call at ``first_ns`` [ns]."""
        self.stop()
        self._schedule(first_ns)
        self._queue.count_output(self._output is not None)

    def start_in_step(self, now_ns: int) -> None:
        """Start anew at ``now_ns`` [ns], with calls at whole multiples of the period."""
        self.start(-(-now_ns // self.period_ns) * self.period_ns)

    def stop(self) -> None:
        """Stop the series; stopping it twice is allowed."""
        if self._asleep_until_ns is not None:
            self._asleep_until_ns = None
            self._queue.forget_sleeper(self)
        if self._event is not None:
            self._event.cancel()
            self._event = None
            self._queue.count_output(-(self._output is not None))

    def tell(self, due_ns: int) -> None:
        """Do the action now that is due at ``due_ns`` [ns]."""
        self._action(due_ns, due_ns)

    def skip(self, due_ns: int) -> None:
        """Go on after ``due_ns`` [ns], up to which others have done what this series does."""
        if self._event is not None:
            self._event.cancel()
            self._go_on(due_ns + self.period_ns)

    def wake(self, now_ns: int) -> Optional[int]:
        """End the sleep: go on after ``now_ns`` [ns]. Return the last instant [ns] that was slept through, or None."""
        due_ns, self._asleep_until_ns = self._asleep_until_ns or 0, None
        self._queue.forget_sleeper(self)
        missed = (now_ns - due_ns) // self.period_ns + 1 if due_ns <= now_ns else 0
        self._queue.count_output(1)
        self._schedule(due_ns + missed * self.period_ns)
        return due_ns + (missed - 1) * self.period_ns if missed else None

    def shift(self, by_ns: int) -> None:
        """Move the next event of a series that is asleep by ``by_ns`` [ns]."""
        self._asleep_until_ns = (self._asleep_until_ns or 0) + by_ns

    def _go_on(self, due_ns: int) -> None:
        if self.is_heard():
            self._schedule(due_ns)
        else:
            self.fall_asleep(due_ns)

    def fall_asleep(self, due_ns: int) -> None:
        """Have no events until woken; ``due_ns`` [ns] is when the next one would be due."""
        self._event = None
        self._asleep_until_ns = due_ns
        self._queue.count_output(-1)
        self._queue.sleep(self)

    def _schedule(self, due_ns: int) -> None:
        self._event = self._queue.schedule(due_ns, self._robot_index, self._happen, self._output)

    def _happen(self, due_ns: int, now_ns: int) -> None:
        own = self._event
        pause_ns = 0
        try:
            pause_ns = self._action(due_ns, now_ns) or 0
        finally:
            if self._event is own:  # the action has neither stopped nor restarted the series
                self._go_on(due_ns + self.period_ns * ((now_ns + pause_ns - due_ns) // self.period_ns + 1))


def _always() -> int:
    return PARTICIPANTS
