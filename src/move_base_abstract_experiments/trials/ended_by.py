"""Why a trial ended, in a word or two: `ended_by` of its row in the table.

What a trial measured has another meaning if the limit of simulated time (`until: seconds`) cut it off.
"""
import re

SECONDS, TOPIC, IDLE, REQUIRED, RETURNED = 'seconds', 'topic', 'idle', 'required', 'returned'
FAULT, TIME_LIMIT, ERROR, CRASH, OTHER = 'fault', 'time_limit', 'error', 'crash', 'other'
_END_NODE = '/experiment_end'  # stands for until: topic
_LEFT = re.compile(r"'([^']+)' left at ")


def of_run(reason, by_fault):
    """Return how a run ended, by what its event log's end record says: 'required NODE' names the node."""
    if by_fault:
        return FAULT
    left = _LEFT.match(reason)
    if left:
        return TOPIC if left.group(1) == _END_NODE else f'{REQUIRED} {left.group(1)}'
    return SECONDS if reason.startswith('the run was to end at ') else IDLE if reason.startswith('idle at ') else OTHER


def of_error(text, before):
    """Return how a trial ended that failed with this error; ``before``: what is known already."""
    return TIME_LIMIT if text.endswith('(time_limit)') else before
