"""Any number of future events of one robot, which can all be cancelled at once."""
from __future__ import annotations

from typing import TYPE_CHECKING, Callable, List

if TYPE_CHECKING:
    from .event_queue import Event, EventQueue


class Agenda:
    """Future events of the robot ``robot_index`` in ``queue`` (EventQueue)."""

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
