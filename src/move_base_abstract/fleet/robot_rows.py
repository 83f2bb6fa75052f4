"""The rows of a robot's events, in the trace of the plain fleet and in a run's event log."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Dict, Type

from ..goals.events import WRITTEN, Departed, Ended, GoalTaken, Recorded, Stands, motion_of
from ..goals.task_events import TaskEnded
from ..goals.traffic_events import Entered, Left
from ..runs.trace import FLAT, Rows

if TYPE_CHECKING:
    from ..engine.stream import Stream
    from ..motion.robot import Robot

#: a function that takes a row, or an event
Take = Callable[[Any], object]

#: the kinds of rows that robots write
ROW_KINDS = tuple(kind for kinds in WRITTEN.values() for kind in kinds)


def row_hearers(take: Take, with_motion: bool = False) -> Dict[Type[Any], Take]:
    """Return functions that call ``take`` with each row of the events that they hear: {type of events: function}.

    ``with_motion``: also with the rows that come only with ``log_motion``. The functions can be shared by all robots.
    """
    def hear(event: Any) -> None:
        take(event.row())

    def plain(kind: str) -> Take:
        def hear_plain(event: Any) -> None:
            time_ns, robot, *values = event
            take((time_ns, robot, kind, *values))
        return hear_plain

    return {**{event: hear if hasattr(event, 'row') else plain(kinds[0].kind) for event, kinds in WRITTEN.items()
               if with_motion or not kinds[0].is_motion},
            **dict.fromkeys((GoalTaken, Departed, Stands, Entered, Left), take),
            **dict.fromkeys((Ended, TaskEnded), lambda event: take(event[:6]))}


def write(stream: Stream, name: str, take: Take, with_motion: bool = False) -> None:
    """Call ``take`` with each row of the events of ``stream``, at the place of the subscriber ``name`` in its order.

    ``with_motion``: see :func:`row_hearers`.
    """
    stream.subscribe(name, row_hearers(take, with_motion))


class TraceRows(Rows):
    """The rows of a fleet's trace that nobody has read yet."""

    def __init__(self) -> None:
        super().__init__()
        flat = {event: self.take_flat for event, kinds in WRITTEN.items() if kinds[0].kind in FLAT}
        self._hearers = tuple({**row_hearers(self.take, with_motion), **flat} for with_motion in (False, True))

    def subscribe(self, stream: Stream, with_motion: bool) -> None:
        """Take the rows of the events of a robot's ``stream``; ``with_motion``: see :func:`row_hearers`."""
        stream.subscribe('trace', self._hearers[with_motion])


def tell_start(stream: Stream, robot: Robot, durations: Any, now_ns: int) -> None:
    """Tell ``stream`` the first events of a robot that exists from ``now_ns`` [ns] on: how it travels, and where it is.

    ``durations``: the Durations or CalibratedDurations of its settings, or None.
    """
    stream.tell(motion_of(robot, now_ns))
    if durations is not None and durations.recorded is not None:
        stream.tell(Recorded(now_ns, robot.name, durations.recorded))
