"""The event log of a run as objects."""
import json
from typing import Any, Dict, List, NamedTuple, Optional

from move_base_abstract.runs import event_log
from move_base_abstract.runs.event_log import EventLog


class LogEvent(NamedTuple):
    """An event. ``robot``: or node, or topic; ``values``: as the kind has them (docs/time_master.md)."""

    time_ns: int
    robot: str
    kind: str
    values: List[Any]

    @property
    def time(self) -> float:
        """When it was [s, simulated]."""
        return self.time_ns * 1e-9


class RunLog:
    """The log of a run that is over. ``end``: its end record."""

    def __init__(self, path: str) -> None:
        """:raises EventLogError: if it is none."""
        self.path = path
        with event_log.open_text(path) as stream:
            log = EventLog(stream, path)
            self.events = [LogEvent(one.time_ns, one.robot, one.kind, json.loads(one.values)) for one in log]
        self.end: Dict[str, Any] = log.end or {}

    def of(self, kind: Optional[str] = None, robot: Optional[str] = None) -> List[LogEvent]:
        """Return the events of a kind, of a robot, or of both."""
        return [one for one in self.events if kind in (None, one.kind) and robot in (None, one.robot)]

    @property
    def labels(self) -> List[str]:
        """Why the run is not called repeatable, or is called degraded."""
        return event_log.labels_of(self.end) if self.end else ['it has no end']
