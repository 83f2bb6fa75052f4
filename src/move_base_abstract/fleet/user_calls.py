"""Calls of the functions that a fleet's user has given: for events and endings, at the end of their instant."""
import warnings

from ..goals.events import Beyond, Ended, TaskEnded
from ..motion.recorded_range import WARNING
from ..runs.trace import as_entries
from .robot_rows import write

#: above all robot indices, so that a user's calls come after the robots' events of the same instant
_USER_INDEX = 2 ** 31 - 1
#: above that, for the events of processes, which come last
AFTER_USERS = _USER_INDEX + 2


class UserCalls:
    """The calls of one fleet's user: ``on_event``, ``on_end``, ``on_worked`` of :class:`.Fleet`; each may be None."""

    def __init__(self, simulation, on_event, on_end, on_worked):
        self._simulation = simulation
        self._on_event = on_event
        self._hears = {kind: self._teller(listener)  # shared by all robots
                       for kind, listener in ((Ended, on_end), (TaskEnded, on_worked)) if listener is not None}
        self._has_warned = False  # whether the user was warned of a goal outside the ranges of its calibration

    def subscribe(self, stream, with_motion):
        """Call the user's functions for the events of a robot's ``stream`` (Stream): ``on_event`` before the others."""
        if self._on_event is not None:
            write(stream, 'users', self._tell_event, with_motion)
        stream.subscribe('shown', {Beyond: self._warn_of_beyond})
        stream.subscribe('users', self._hears)

    def at(self, time_ns, call):
        """Call ``call(due_ns, now_ns)`` at ``time_ns`` [ns], which must not be past."""
        self._simulation.queue.schedule(time_ns, _USER_INDEX, call)

    def tell(self, row):
        """Call the user's ``on_event`` for a row that belongs to no robot's stream."""
        if self._on_event is not None:
            self._tell_event(row)

    def _tell_event(self, row):
        """Call ``on_event`` for a row of the trace, at the end of its instant, when all that belongs to it is over."""
        self.at(max(row[0], self._simulation.now_ns), lambda _due_ns, _now_ns: self._on_event(*as_entries([row])))

    def _teller(self, listener):
        """Return a function that has ``listener`` called for the end of a goal or a task, at the end of its instant."""
        simulation = self._simulation

        def tell_end(event):
            def call(_due_ns, _now_ns):
                listener(event[1], event[2], event[4], event[5], simulation.now_ns)
            simulation.queue.schedule(max(event[0], simulation.now_ns), _USER_INDEX, call)
        return tell_end

    def _warn_of_beyond(self, event):
        if not self._has_warned:
            self._has_warned = True
            warnings.warn(WARNING.format(event.robot, event.words), stacklevel=2)

