"""Why a trial ended: the codes in `ended_by` of its row in the table.

The metrics of a trial have another meaning if the limit of simulated time (`until: seconds`) cut it off.
"""
from typing import Any, Dict, Optional

from move_base_abstract.common.errors import SimulatorError

SECONDS, TOPIC, IDLE, REQUIRED, RETURNED = 'seconds', 'topic', 'idle', 'required', 'returned'
FAULT, TIME_LIMIT, ERROR, CRASH, OTHER = 'fault', 'time_limit', 'error', 'crash', 'other'
END_NODE = '/experiment_end'  # the node that ends a trial for `until: topic`


class RunError(SimulatorError):
    """A run could not be started, or did not come to its end. ``ended_by``: one of the codes, or None."""

    def __init__(self, text: str, ended_by: Optional[str] = None) -> None:
        super().__init__(text)
        self.ended_by = ended_by


def of_run(end: Dict[str, Any]) -> str:
    """Return how a run ended, from the end record of its event log. For 'required NODE' it names the node."""
    if end.get('by_fault'):
        return FAULT
    if end.get('ended_by') == 'departure':
        return TOPIC if end.get('node') == END_NODE else f'{REQUIRED} {end.get("node")}'
    return {'end_at': SECONDS, 'idle': IDLE}.get(end.get('ended_by', ''), OTHER)
