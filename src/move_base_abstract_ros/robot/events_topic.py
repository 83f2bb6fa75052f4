"""The topic ``~events`` of a process: the events of its robots, each as a row of the event log."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Tuple, Union

from move_base_abstract.msg import RobotEvent

from ..messages import conversions
from ..messages.outlets import Outlet
from ..messages.packing import of_message

if TYPE_CHECKING:
    from ..clocks.timing import Clock

_QUEUE_SIZE = 1000  # messages: many robots may do something at one instant


class EventsTopic:
    """Publishes events, and writes them into the event log. Make one in a process, when ``clock`` has started."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._outlet = Outlet('~events', RobotEvent, _QUEUE_SIZE)

    def record(self, index: int) -> Callable[[Tuple[Any, ...]], None]:
        """Return a function that takes rows of the robot with ``index``, for the event log and for listeners.

        A row is (time [ns], robot, kind, value, ...).
        """
        log, outlet = self._clock.record(index), self._outlet

        def record(row: Tuple[Any, ...]) -> None:
            if log is not None:
                log(row)
            if outlet.is_heard():
                outlet.send(of_message(_message(*row)))
        return record


def _message(time_ns: int, robot: str, kind: str, *values: Union[float, str, Tuple[float, ...]]) -> Any:
    texts = [value for value in values if isinstance(value, str)]
    return RobotEvent(conversions.to_time(time_ns), robot, kind, texts, [
        float(number) for value in values if not isinstance(value, str)
        for number in (value if isinstance(value, tuple) else (value,))])
