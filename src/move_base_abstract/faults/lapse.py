"""A lapse: for a while a robot reports a wrong pose, or none, and drives on as usual."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Tuple

from ..engine.alarm import Alarm
from ..goals.events import Lapse

if TYPE_CHECKING:
    from ..engine.event_queue import EventQueue
    from ..engine.stream import Stream

JUMP, MUTE = 'jump', 'mute'
LAPSES = (JUMP, MUTE)


class Lapsing:
    """The lapses of one robot, one at a time; their beginnings and ends are told to ``stream`` (Stream)."""

    def __init__(self, robot: Any, queue: EventQueue, stream: Stream) -> None:
        self._robot = robot
        self._stream = stream
        self._end = Alarm(queue, robot.index)
        self._now: Optional[Tuple[str, str]] = None  # kind and cause

    def begin(self, kind: str, cause: str, now_ns: int, until_ns: int, by: Tuple[float, float, float]) -> None:
        """Begin a lapse at ``now_ns`` [ns] that lasts until ``until_ns`` [ns]; if there is one already, do nothing.

        ``by``: the jump of the reported pose from the true one (x, y [m], yaw [rad]), for a lapse of the kind JUMP.
        """
        if self._now is not None:
            return
        self._now = kind, cause
        if kind == JUMP:
            self._robot.telling.jump(now_ns, *by)
        else:
            self._robot.telling.is_mute = True
        self._end.set(until_ns, self._be_right)
        self._stream.tell(Lapse(now_ns, self._robot.name, kind, cause, True, by if kind == JUMP else ()))

    def _be_right(self, now_ns: int) -> None:
        if self._now is not None:
            (kind, cause), self._now = self._now, None
            self._robot.telling.shift, self._robot.telling.is_mute = None, False
            self._stream.tell(Lapse(now_ns, self._robot.name, kind, cause, False))

    def reset(self, now_ns: int) -> None:
        """End the lapse, since the robot is placed at its start at ``now_ns`` [ns]."""
        self._end.cancel()
        self._be_right(now_ns)

    def restart(self, by_ns: int) -> None:
        """Note that the clock has restarted and events have been shifted by ``by_ns`` [ns]."""
        self._end.shift(by_ns)

    def close(self) -> None:
        """Note that the robot is removed."""
        self._end.cancel()
