"""Future events of a robot: one that can be postponed, and any number that are cancelled at once."""
from __future__ import annotations

from typing import TYPE_CHECKING, Callable, List, Optional

if TYPE_CHECKING:
    from .event_queue import Event, EventQueue


class Alarm:
    """At most one future event of a robot in ``queue`` (EventQueue); ``due_ns``: when it is due [ns], or None.

    ``keeps_going``: see :meth:`.event_queue.EventQueue.schedule`.
    """

    def __init__(self, queue: EventQueue, robot_index: int, keeps_going: Optional[Callable[[], bool]] = None) -> None:
        self._queue = queue
        self._robot_index = robot_index
        self._keeps_going = keeps_going
        self._event: Optional[Event] = None
        self.due_ns: Optional[int] = None

    def set(self, due_ns: int, action: Callable[[int], object]) -> None:
        """Call ``action(due_ns)`` at ``due_ns`` [ns], instead of whatever was set before."""
        self.cancel()
        self.due_ns = due_ns
        self._event = self._queue.schedule(due_ns, self._robot_index, lambda at_ns, _: self._go_off(action, at_ns),
                                           keeps_going=self._keeps_going)

    def cancel(self) -> None:
        """Cancel the event, if there is one."""
        if self._event is not None:
            self._event.cancel()
            self._event = self.due_ns = None

    def shift(self, by_ns: int) -> None:
        """Correct :attr:`due_ns` after the queue was shifted by ``by_ns`` [ns]."""
        if self.due_ns is not None:
            self.due_ns += by_ns

    def _go_off(self, action: Callable[[int], object], at_ns: int) -> None:
        self._event = self.due_ns = None
        action(at_ns)


class Agenda:
    """Any number of future events of the robot ``robot_index`` in ``queue`` (EventQueue)."""

    __slots__ = ('_queue', '_robot_index', 'events')

    def __init__(self, queue: EventQueue, robot_index: int) -> None:
        self._queue = queue
        self._robot_index = robot_index
        self.events: List[Event] = []

    def at(self, due_ns: int, action: Callable[[int, int], object]) -> None:
        """Call ``action(due_ns, now_ns)`` at ``due_ns`` [ns]."""
        if self.events:
            self.events = [event for event in self.events if event.action is not None]
        self.events.append(self._queue.schedule(due_ns, self._robot_index, action))

    def clear(self) -> None:
        """Cancel all events."""
        for event in self.events:
            event.action = None  # the same as Event.cancel()
        self.events.clear()
