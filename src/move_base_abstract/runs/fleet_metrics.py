"""The metrics of a fleet's orders and of its robots' time, from the Story of a run."""
from __future__ import annotations

import math
from typing import Dict, Optional, Sequence

from .states import NAMES
from .story import Story


def fleet_metrics(story: Story) -> Dict[str, Optional[float]]:
    """Return {name: number}, the metrics of orders and of the robots' time; {} if no orders arrived.

    A number that does not exist is None.
    """
    orders, robots = story.orders.times, story.figures.values()
    if not orders.arrived:
        return {}
    time = math.fsum(one[state] for one in robots for state in NAMES)
    found: Dict[str, Optional[float]] = {
        'orders_done': orders.done, 'orders_failed': orders.failed, 'orders_open': orders.open,
        'order_flow': _mean(orders.flow), 'order_wait': _mean(orders.wait)}
    if story.orders.has_deadlines:
        found.update(orders_late=100.0 * orders.late / len(orders.lateness) if orders.lateness else None,
                     order_lateness=_mean(orders.lateness))
    for state in NAMES:
        found['share_' + state] = round(100.0 * math.fsum(one[state] for one in robots) / time, 9) if time else None
    found['failures'] = sum(one['failures'] for one in robots)
    if story.has_energy:
        found['charges'] = sum(one['charges'] for one in robots)
        for what in ('energy_used', 'energy_charged'):
            found[what] = round(math.fsum(one[what] for one in robots), 9)
    return found


def _mean(values: Sequence[float]) -> Optional[float]:
    return round(math.fsum(values) / len(values), 9) if values else None
