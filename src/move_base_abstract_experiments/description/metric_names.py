"""The built-in metrics of a trial: what they are called, in which unit, and which way is better."""
from __future__ import annotations

from typing import Any, Dict, NamedTuple, Optional


class Metric(NamedTuple):
    """What is told of a metric.

    ``better``: 'lower', 'higher', or None where neither is. ``at_limit``: what it is of a trial that the limit of time
    ended: 'lower_bound', 'value', 'to_last_goal' (a lower bound if a goal was under way), or None: nobody has said it.
    """

    title: str
    unit: str = ''
    better: Optional[str] = None
    at_limit: Optional[str] = None

    def described(self) -> Dict[str, Any]:
        """Return it as plan.json has it."""
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
#: of trials in which something of the kind can be
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
    **{f'share_{state}': Metric(f'Share of time {state}, mean of the robots', '%', better, 'value')
       for state, better in (('driving', None), ('working', None), ('waiting', 'lower'), ('charging', None),
                             ('idle', None), ('failed', 'lower'))},
    'failures': Metric('Failures of robots', 'failures', 'lower', 'lower_bound'),
    'charges': Metric('Times that robots charged', 'charges', None, 'lower_bound'),
    'energy_used': Metric('Energy used', 'kWh', 'lower', 'lower_bound'),
    'energy_charged': Metric('Energy charged', 'kWh', None, 'lower_bound'),
}
