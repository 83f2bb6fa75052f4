"""One robot's tasks at places in plain Python: what is written down of them, and who is told of their ends."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Optional

from ..goals.ledger import GoalLedger
from ..runs.trace import TaskTrace
from .place_tasks import PlaceTaskListener, PlaceTaskRunner

if TYPE_CHECKING:
    from ..goals.ledger import GoalRecord
    from ..motion.robot import Robot
    from .place_tasks import Rooms


class Worker(PlaceTaskListener):
    """The tasks of ``robot`` (Robot), which ``record`` (None: nothing) and ``on_end(record, stamp_ns)`` are told of.

    ``has_failed``: as of PlaceTaskRunner; ``on_load``: as of PlaceTaskListener.load.
    """

    def __init__(self, rooms: Rooms, robot: Robot, seed: int, record: Callable[..., Any], on_end: Callable[..., Any],
                 has_failed: Callable[[], bool], on_load: Optional[Callable[..., Any]] = None) -> None:
        self._trace = TaskTrace(robot.name, record)
        self._on_end = on_end
        self._on_load = on_load
        ledger = GoalLedger(lambda: None, self._ended, '{}-task-{{}}'.format(robot.name).format)
        self.tasks = PlaceTaskRunner(rooms, robot.index, robot.name, seed, ledger, self, robot,
                                     has_failed=has_failed)

    def waits(self, record: GoalRecord, place: str, now_ns: int) -> None:
        """Write it down."""
        self._trace.waits(record, place, now_ns)

    def waited(self, record: GoalRecord, place: str, now_ns: int) -> None:
        """Write it down."""
        self._trace.waited(record, place, now_ns)

    def begins(self, record: GoalRecord, duration_ns: int, now_ns: int) -> None:
        """Write it down."""
        self._trace.began(record, duration_ns, now_ns)

    def load(self, watts: Any, now_ns: int) -> None:
        """Hand it over."""
        if self._on_load is not None:
            self._on_load(watts, now_ns)

    def _ended(self, record: GoalRecord, stamp_ns: int) -> None:
        self._trace.ended(record, stamp_ns)
        self._on_end(record, stamp_ns)
