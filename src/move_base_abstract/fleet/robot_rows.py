"""The rows of a robot's events, in the trace of the plain fleet and in a run's event log."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable

from ..goals import events, traffic_events
from ..goals.events import ChargeRead, Departed, MotionSet, Phased, Recorded, motion_of

if TYPE_CHECKING:
    from ..engine.stream import Stream
    from ..motion.robot import Robot

_WITH_MOTION = (MotionSet, Phased, ChargeRead)
_OTHER_ROWS = tuple(kind for module in (events, traffic_events) for kind in vars(module).values()
                    if hasattr(kind, 'row'))
_PLAIN_ROWS = {**events.PLAIN_ROWS, **traffic_events.PLAIN_ROWS}


def write(stream: Stream, name: str, take: Callable[[events.Row], object], with_motion: bool = False) -> None:
    """Call ``take`` with each row of the events of ``stream``, at the place of the subscriber ``name`` in its order.

    ``with_motion``: also with the rows of the limits, phases and manner of the robot's travel, so that its legs can be
    computed again from the rows, and of its state of charge when a charge begins and ends.
    """
    def hear(event: Any) -> None:
        take(event.row())

    def plain(kind: str) -> Callable[[Any], object]:
        return lambda event: take((event[0], event[1], kind, *event[2:]))

    def departed(event: Departed) -> None:
        take(event.row())
        if event.corners:
            take(event.route())
        if with_motion and event.manner:
            take((event.time_ns, event.robot, 'manner', *event.manner))
    stream.subscribe(name, {**{event: plain(kind) for event, kind in _PLAIN_ROWS.items()},
                            **{event: hear for event in _OTHER_ROWS if with_motion or event not in _WITH_MOTION},
                            Departed: departed})


def tell_start(stream: Stream, robot: Robot, durations: Any, now_ns: int) -> None:
    """Tell ``stream`` the first events of a robot that exists from ``now_ns`` [ns] on: how it travels, and where it is.

    ``durations``: the Durations or CalibratedDurations of its settings, or None.
    """
    stream.tell(motion_of(robot, now_ns))
    if robot.phases is not None:
        stream.tell(Phased(now_ns, robot.name, robot.phases))
    if durations is not None and durations.recorded is not None:
        stream.tell(Recorded(now_ns, robot.name, durations.recorded))
