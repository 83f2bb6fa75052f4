"""The results of a run: its event log, the first difference of two logs, and what the log says of robots and orders."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .event_log import Event as Event, EventLog as EventLog, EventLogError as EventLogError, compare as compare
    from .trace import TraceEntry as TraceEntry
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
