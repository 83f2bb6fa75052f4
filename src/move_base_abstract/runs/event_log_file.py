"""Writes the event log of a run in plain Python. For a run under ROS, the time master writes it."""
from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any, Dict, List, NamedTuple, Optional, Sequence

from ..common.own_files import PART, check_file, create_file
from .event_log import FORMAT

if TYPE_CHECKING:
    from ..common.type_names import StrPath
    from .trace import TraceEntry


class End(NamedTuple):
    """How a run ended. ``at_ns``: when [ns]; ``is_idle``: nothing was left to happen; ``open``: robots with a goal."""

    at_ns: int
    is_idle: bool
    open: Sequence[str]

    def written(self) -> Dict[str, Any]:
        """Return the end as a part of the end record, as in the log of a run under ROS."""
        goals = [{'client': 'fleet', 'action': f'{name}/move_base', 'count': 1} for name in self.open]
        return {'by_fault': False, 'ended_by': 'idle' if self.is_idle else 'end_at', 'at_ns': self.at_ns,
                **({'open_goals': goals} if goals else {})}


def write_event_log(path: StrPath, entries: List[TraceEntry], start_ns: int, end: Optional[End] = None) -> None:
    """Write ``entries`` as the event log ``path`` (JSON lines) of a run that began at ``start_ns`` [ns].

    Without an ``end`` the log does not say whether goals are open. An existing event log is replaced.

    :raises ConfigurationError: if ``path`` is a file of another kind.
    :raises OutputError: if the file cannot be written.
    """
    check_file(path, _is_log)
    part = os.fspath(path) + PART
    with create_file(part, _is_log) as stream:
        stream.write(_line({'event_log': FORMAT, 'start_ns': start_ns}))
        for time_ns, robot, kind, values in entries:
            stream.write(_line({'time_ns': time_ns, 'robot': robot, 'kind': kind, 'values': values}))
        stream.write(_line({'end': {
            'events': len(entries), 'repeatable': True, 'not_repeatable_because': [], 'degraded_because': [],
            'reason': 'the trace of a fleet in plain Python', **(end.written() if end else {})}}))
    os.replace(part, path)


def _line(record: object) -> str:
    return json.dumps(record, separators=(',', ':'), allow_nan=False) + '\n'


def _is_log(line: bytes) -> bool:
    return line.startswith(b'{"event_log":')
