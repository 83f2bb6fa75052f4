"""The event log of a run as objects."""
from typing import Any, Dict, List, NamedTuple, Optional

from move_base_abstract.runs import event_log


class LogEvent(NamedTuple):
    """An event. ``robot`` is a robot, a node or a topic; ``values`` depend on the kind (docs/time_master.md)."""

    time_ns: int
    robot: str
    kind: str
    values: List[Any]

    @property
    def time(self) -> float:
        """The instant of the event [s, simulated]."""
        return self.time_ns * 1e-9


class RunLog:
    """The log of a run that is over. ``end`` is its end record, {} if it has none."""

    def __init__(self, path: str) -> None:
        """Read the file.

        :raises EventLogError: if it is not an event log.
        """
        self.path = path
        with event_log.opened(path) as log:
            self.events = [LogEvent(*row) for row in log.rows()]
        self.end: Dict[str, Any] = log.end or {}

    def of(self, kind: Optional[str] = None, robot: Optional[str] = None) -> List[LogEvent]:
        """Return the events of this kind, of this robot, or of both; all events if neither is given."""
        return [one for one in self.events if kind in (None, one.kind) and robot in (None, one.robot)]

    @property
    def labels(self) -> List[str]:
        """The reasons why the run is not called repeatable, or is called degraded."""
        return event_log.labels_of(self.end) if self.end else ['it has no end']
