"""The built-in metrics of a trial: their titles, their units, and which side is better."""
from __future__ import annotations

from typing import Any, Dict, NamedTuple, Optional

from move_base_abstract.runs.states import STATES


class Metric(NamedTuple):
    """The description of a metric.

    ``better``: 'lower', 'higher', or None if neither is better. ``at_limit``: what the metric means in a trial that the
    limit of time ended: 'lower_bound', 'value', 'to_last_goal' (a lower bound if a goal was under way), or None: not
    declared.
    """

    title: str
    unit: str = ''
    better: Optional[str] = None
    at_limit: Optional[str] = None

    def described(self) -> Dict[str, Any]:
        """Return the metric in the form of plan.json."""
        return {'unit': self.unit, 'title': self.title, 'better': self.better,
                **({'at_limit': self.at_limit} if self.at_limit else {})}


BUILT_IN = {
    'goals': Metric('Goals reached', 'goals', 'higher', 'lower_bound'),
    'goals_failed': Metric('Goals not reached', 'goals', 'lower', 'lower_bound'),
    'makespan': Metric('Makespan', 's', 'lower', 'to_last_goal'),
    'distance': Metric('Distance travelled', 'm', 'lower', 'lower_bound'),
    'moving': Metric('Time moving, mean of the robots', 's', None, 'lower_bound'),
    'idle': Metric('Time idle, mean of the robots', 's', None, 'lower_bound'),
    'waiting': Metric('Time waiting, mean of the robots', 's', 'lower', 'lower_bound'),
    'throughput': Metric('Goals reached per hour', 'goals/h', 'higher', 'value'),
}
#: the metrics of trials in which such a thing can happen, for example those of orders only if there are orders
OCCASIONAL = {
    'broken_properties': Metric('Broken properties', 'properties', 'lower', 'lower_bound'),
    'goals_beyond': Metric('Goals outside of what was recorded', '%', 'lower', 'value'),
    'encounters': Metric('Encounters', 'encounters', 'lower', 'lower_bound'),
    'radio_messages': Metric('Messages between hosts', 'messages', None, 'lower_bound'),
    'delivery_ratio': Metric('Messages between hosts that arrived', '%', 'higher', 'value'),
    'message_age': Metric('Age of messages between hosts when they arrive, mean', 's', 'lower', 'value'),
    'out_of_reach': Metric('Time out of reach, mean of the links', 's', 'lower', 'lower_bound'),
    'encounter_time': Metric('Time stood for other robots, sum of the robots', 's', 'lower', 'lower_bound'),
    'orders_done': Metric('Orders done', 'orders', 'higher', 'lower_bound'),
    'orders_failed': Metric('Orders given up', 'orders', 'lower', 'lower_bound'),
    'orders_open': Metric('Orders open at the end', 'orders', 'lower'),
    'orders_late': Metric('Orders with a deadline that were done late', '%', 'lower', 'value'),
    'order_flow': Metric('Flow time of orders, mean', 's', 'lower'),
    'order_wait': Metric('Time until a robot begins an order, mean', 's', 'lower'),
    'order_lateness': Metric('Lateness of orders with a deadline, mean', 's', 'lower'),
    **{f'share_{state.name}': Metric(f'Share of time {state.name}, mean of the robots', '%', state.better, 'value')
       for state in STATES},
    'failures': Metric('Failures of robots', 'failures', 'lower', 'lower_bound'),
    'charges': Metric('Times that robots charged', 'charges', None, 'lower_bound'),
    'energy_used': Metric('Energy used', 'kWh', 'lower', 'lower_bound'),
    'energy_charged': Metric('Energy charged', 'kWh', None, 'lower_bound'),
}
