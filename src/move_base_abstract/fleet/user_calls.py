"""Calls of the functions that a fleet's user has given: for events and endings, at the end of their instant."""
from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, Callable, Optional, Tuple

from ..common.arguments import check_function
from ..engine.event_queue import USERS
from ..goals.events import Beyond, Ended
from ..goals.task_events import TaskEnded
from ..motion.recorded_range import WARNING
from ..runs.trace import as_entries
from .robot_rows import write

if TYPE_CHECKING:
    from ..engine.simulation import Simulation
    from ..engine.stream import Stream
    from ..goals.outcome import GoalState
    from ..runs.trace import TraceEntry

    Row = Tuple[Any, ...]
    OnEnd = Callable[[str, str, GoalState, str, int], object]

#: above a user's calls, for the events of processes, which come last
AFTER_USERS = USERS + 2


class UserCalls:
    """The calls of one fleet's user: ``on_event``, ``on_end``, ``on_worked`` of :class:`.Fleet`; each may be None."""

    def __init__(self, simulation: Simulation, on_event: Optional[Callable[[TraceEntry], object]],
                 on_end: Optional[OnEnd], on_worked: Optional[OnEnd]) -> None:
        for given, call in ((on_event, 'on_event(entry)'), (on_end, 'on_end(robot, goal_id, state, text, now_ns)'),
                            (on_worked, 'on_worked(robot, goal_id, state, text, now_ns)')):
            if given is not None:
                check_function(given, call)
        self._simulation = simulation
        self._on_event: Any = on_event
        self._listeners = {kind: listener for kind, listener in ((Ended, on_end), (TaskEnded, on_worked))
                           if listener is not None}
        self._tell_later = simulation.queue.tell_at_end(USERS, self._tell_now)
        self._has_warned = False  # whether the user was warned of a goal outside the ranges of its calibration

    def subscribe(self, stream: Stream, with_motion: bool) -> None:
        """Call the user's functions for the events of a robot's ``stream`` (Stream): ``on_event`` before the others."""
        if self._on_event is not None:
            write(stream, 'users', self._tell_later, with_motion)
        stream.subscribe('shown', {Beyond: self._warn_of_beyond})
        stream.subscribe('users', dict.fromkeys(self._listeners, self._tell_later))

    def at(self, time_ns: int, call: Callable[[int, int], Any]) -> None:
        """Call ``call(due_ns, now_ns)`` at ``time_ns`` [ns], which must not be past."""
        self._simulation.queue.schedule(time_ns, USERS, call)

    def tell(self, row: Row) -> None:
        """Call the user's ``on_event`` for a row that belongs to no robot's stream."""
        if self._on_event is not None:
            self._tell_later(row)

    def _tell_now(self, item: Any) -> None:
        """Make the call for ``item``: an Ended or TaskEnded, or a row of the trace."""
        listener = self._listeners.get(type(item))
        if listener is not None:
            _, robot, _, goal_id, _, text, _, state = item
            listener(robot, goal_id, state, text, self._simulation.now_ns)
        else:
            self._on_event(*as_entries([item]))

    def _warn_of_beyond(self, event: Beyond) -> None:
        if not self._has_warned:
            self._has_warned = True
            warnings.warn(WARNING.format(event.robot, event.words), stacklevel=2)

