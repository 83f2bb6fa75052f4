"""Write the event log of a run in plain Python; the time master writes that of a run under ROS."""
from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, List

from ..common.own_files import PART, check_file, create_file
from .event_log import FORMAT

if TYPE_CHECKING:
    from ..common.type_names import StrPath
    from .trace import TraceEntry


def write_event_log(path: StrPath, entries: List[TraceEntry], start_ns: int) -> None:
    """Write ``entries`` as the event log ``path`` (JSON lines) of a run that began at ``start_ns`` [ns].

    An event log that is there is replaced. :raises ConfigurationError: if another kind of file is there.
    """
    check_file(path, _is_log)
    part = os.fspath(path) + PART
    with create_file(part, _is_log) as stream:
        stream.write(_line({'event_log': FORMAT, 'start_ns': start_ns}))
        for time_ns, robot, kind, values in entries:
            stream.write(_line({'time_ns': time_ns, 'robot': robot, 'kind': kind, 'values': values}))
        stream.write(_line({'end': {
            'events': len(entries), 'repeatable': True, 'not_repeatable_because': [], 'degraded_because': [],
            'reason': 'the trace of a fleet in plain Python'}}))
    os.replace(part, path)


def _line(record: object) -> str:
    return json.dumps(record, separators=(',', ':'), allow_nan=False) + '\n'


def _is_log(line: bytes) -> bool:
    return line.startswith(b'{"event_log":')
