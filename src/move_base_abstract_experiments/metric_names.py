"""The built-in metrics of a trial: what they are called, in which unit, and which way is better."""
from typing import NamedTuple, Optional


class Metric(NamedTuple):
    """What is told of a metric. ``better``: 'lower', 'higher', or None where neither is."""

    title: str
    unit: str = ''
    better: Optional[str] = None


BUILT_IN = {
    'goals': Metric('Goals reached', '', 'higher'),
    'goals_failed': Metric('Goals not reached', '', 'lower'),
    'makespan': Metric('Makespan', 's', 'lower'),
    'distance': Metric('Distance travelled', 'm', 'lower'),
    'moving': Metric('Time moving, mean of the robots', 's'),
    'idle': Metric('Time idle, mean of the robots', 's'),
    'waiting': Metric('Time waiting, mean of the robots', 's', 'lower'),
    'throughput': Metric('Goals reached per hour', '1/h', 'higher'),
}
