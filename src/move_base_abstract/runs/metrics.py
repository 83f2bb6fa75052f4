"""The built-in metrics of a run: one row of METRICS for each.

To add one, add a row. Trials compute it, tables and reports name it, and the tables in docs/experiments.md and
docs/experiment_report.md come from the rows. A number that does not exist is None.
"""
from __future__ import annotations

import functools
import math
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, Iterable, NamedTuple, Optional, Tuple

from .states import STATES
from .story import Story

_NS_PER_S = 1e9  # dividing by it rounds once


class RadioSums(NamedTuple):
    """The sums of all messages and links between hosts. Ages and times are in ns."""

    sent: int
    arrived: int
    age_ns: int
    links: int
    down_ns: int


@dataclass
class Figures:
    """What the log of a run says.

    ``robots``: {name: {'distance_m', 'moving_s' and so on: number}}. ``recorded``: (goals of robots whose calibration
    says what was recorded, those outside of that). ``encounters``: how many; ``stood``: for how long robots stood for
    others [s]. Of these and of ``radio`` None means that there is no such thing in the run.
    """

    story: Story
    robots: Dict[str, Dict[str, float]] = field(default_factory=dict)
    recorded: Optional[Tuple[float, float]] = None
    encounters: int = 0
    stood: Optional[float] = None
    radio: Optional[RadioSums] = None

    @property
    def reached(self) -> int:
        """The number of goals that were reached."""
        return sum(robot.goals for robot in self.story.robots.values())

    @property
    def missed(self) -> int:
        """The number of goals that were not reached."""
        return sum(robot.goals_missed for robot in self.story.robots.values())

    def sum(self, key: str) -> float:
        """Return the sum of a value over the robots."""
        return round(sum(one[key] for one in self.robots.values()), 9)

    def mean(self, key: str) -> Optional[float]:
        """Return the mean of a value over the robots."""
        return _mean([one[key] for one in self.robots.values()], sum)

    def sum_of_fleet(self, key: str) -> float:
        """Return the sum of one of the Story's figures over the robots."""
        return round(math.fsum(one[key] for one in self.story.figures.values()), 9)

    def share(self, state: str) -> Optional[float]:
        """Return the share [%] of the robots' time that they were in a state."""
        robots = self.story.figures.values()
        time = math.fsum(one[each.name] for one in robots for each in STATES)
        return round(100.0 * math.fsum(one[state] for one in robots) / time, 9) if time else None


class When(NamedTuple):
    """The runs that have a metric. ``words``: as in the docs."""

    words: str
    holds: Callable[[Figures], bool]


class Metric(NamedTuple):
    """The description of a metric.

    ``better``: 'lower', 'higher', or None if neither is better. ``at_limit``: what the metric means in a trial that the
    limit of time ended: 'lower_bound', 'value', 'to_last_goal' (a lower bound if a goal was under way), or None: not
    declared. ``of(figures)``: its value in a run that has it; None: it is not computed of the log. ``says``: more about
    it, for the docs.
    """

    title: str
    unit: str = ''
    better: Optional[str] = None
    at_limit: Optional[str] = None
    when: When = When('', lambda _run: False)
    of: Optional[Callable[[Any], Optional[float]]] = None
    says: str = ''

    def described(self) -> Dict[str, Any]:
        """Return the metric in the form of plan.json."""
        return {'unit': self.unit, 'title': self.title, 'better': self.better,
                **({'at_limit': self.at_limit} if self.at_limit else {})}


def _mean(values: Iterable[float], add: Callable[[Iterable[float]], float] = math.fsum) -> Optional[float]:
    found = list(values)
    return round(add(found) / len(found), 9) if found else None


def _share(part: float, whole: float) -> Optional[float]:
    return 100.0 * part / whole if whole else None


ALWAYS = When('always', lambda run: True)
CALIBRATED = When('robots have a [calibration](calibrate.md#goals-outside-of-what-was-recorded) that says what it was '
                  'fitted to', lambda run: run.recorded is not None)
MEETS = When('robots [meet](encounters.md)', lambda run: run.stood is not None)
RADIO = When('there is a [radio](radio.md)', lambda run: run.radio is not None)
ORDERS = When('[orders](orders.md) arrive', lambda run: run.story.orders.times.arrived > 0)
DEADLINES = When('orders with a deadline arrive',
                 lambda run: ORDERS.holds(run) and run.story.orders.has_deadlines)
BATTERIES = When('orders arrive, and robots have batteries', lambda run: ORDERS.holds(run) and run.story.has_energy)
CHECKED = When('the experiment names [properties](properties.md#many-runs)', lambda run: False)
#: {name: Metric}
METRICS = {
    'goals': Metric('Goals reached', 'goals', 'higher', 'lower_bound', ALWAYS, lambda run: run.reached),
    'goals_failed': Metric('Goals not reached', 'goals', 'lower', 'lower_bound', ALWAYS, lambda run: run.missed,
                           'aborted, rejected or lost'),
    'makespan': Metric('Makespan', 's', 'lower', 'to_last_goal', ALWAYS, lambda run: (
        run.story.last_end_ns - run.story.start_ns) / _NS_PER_S if run.reached + run.missed else None,
        'until the last goal ended'),
    'distance': Metric('Distance travelled', 'm', 'lower', 'lower_bound', ALWAYS, lambda run: run.sum('distance_m'),
                       'along the corners of [routes](routes.md); a leg that the end of the run cuts off adds nothing'),
    'moving': Metric('Time moving, mean of the robots', 's', None, 'lower_bound', ALWAYS,
                     lambda run: run.mean('moving_s'), 'in the [state](replay.md#the-page) driving'),
    'idle': Metric('Time idle, mean of the robots', 's', None, 'lower_bound', ALWAYS, lambda run: run.mean('idle_s')),
    'waiting': Metric('Time waiting, mean of the robots', 's', 'lower', 'lower_bound', ALWAYS,
                      lambda run: run.mean('waiting_s')),
    'throughput': Metric('Goals reached per hour', 'goals/h', 'higher', 'value', ALWAYS, lambda run: (
        run.reached * 3600.0 / run.story.seconds if run.story.seconds > 0.0 else None)),
    'goals_beyond': Metric('Goals outside of what was recorded', '%', 'lower', 'value', CALIBRATED,
                           lambda run: _share(run.recorded[1], run.recorded[0]),
                           'the report says so before its findings'),
    'encounters': Metric('Encounters', 'encounters', 'lower', 'lower_bound', MEETS, lambda run: run.encounters),
    'encounter_time': Metric('Time stood for other robots, sum of the robots', 's', 'lower', 'lower_bound', MEETS,
                             lambda run: round(run.stood, 9)),
    'radio_messages': Metric('Messages between hosts', 'messages', None, 'lower_bound', RADIO,
                             lambda run: run.radio.sent),
    'delivery_ratio': Metric('Messages between hosts that arrived', '%', 'higher', 'value', RADIO,
                             lambda run: _share(run.radio.arrived, run.radio.sent)),
    'message_age': Metric('Age of messages between hosts when they arrive, mean', 's', 'lower', 'value', RADIO,
                          lambda run: run.radio.age_ns / run.radio.arrived / _NS_PER_S if run.radio.arrived else None),
    'out_of_reach': Metric('Time out of reach, mean of the links', 's', 'lower', 'lower_bound', RADIO,
                           lambda run: run.radio.down_ns / run.radio.links / _NS_PER_S if run.radio.links else None),
    'orders_done': Metric('Orders done', 'orders', 'higher', 'lower_bound', ORDERS,
                          lambda run: run.story.orders.times.done),
    'orders_failed': Metric('Orders given up', 'orders', 'lower', 'lower_bound', ORDERS,
                            lambda run: run.story.orders.times.failed),
    'orders_open': Metric('Orders open at the end', 'orders', 'lower', None, ORDERS,
                          lambda run: run.story.orders.times.open),
    'order_flow': Metric('Flow time of orders, mean', 's', 'lower', None, ORDERS,
                         lambda run: _mean(run.story.orders.times.flow)),
    'order_wait': Metric('Time until a robot begins an order, mean', 's', 'lower', None, ORDERS,
                         lambda run: _mean(run.story.orders.times.wait)),
    'orders_late': Metric('Orders with a deadline that were done late', '%', 'lower', 'value', DEADLINES, lambda run: (
        _share(run.story.orders.times.late, len(run.story.orders.times.lateness)))),
    'order_lateness': Metric('Lateness of orders with a deadline, mean', 's', 'lower', None, DEADLINES,
                             lambda run: _mean(run.story.orders.times.lateness)),
    **{f'share_{state.name}': Metric(f'Share of time {state.name}, mean of the robots', '%', state.better, 'value',
                                     ORDERS, functools.partial(Figures.share, state=state.name)) for state in STATES},
    'failures': Metric('Failures of robots', 'failures', 'lower', 'lower_bound', ORDERS,
                       lambda run: sum(one['failures'] for one in run.story.figures.values())),
    'charges': Metric('Times that robots charged', 'charges', None, 'lower_bound', BATTERIES,
                      lambda run: sum(one['charges'] for one in run.story.figures.values())),
    'energy_used': Metric('Energy used', 'kWh', 'lower', 'lower_bound', BATTERIES,
                          lambda run: run.sum_of_fleet('energy_used')),
    'energy_charged': Metric('Energy charged', 'kWh', None, 'lower_bound', BATTERIES,
                             lambda run: run.sum_of_fleet('energy_charged')),
    'emptied': Metric('Batteries that became empty away from a charger', 'times', 'lower', 'lower_bound', BATTERIES,
                      lambda run: len(run.story.emptied)),
    'broken_properties': Metric('Broken properties', 'properties', 'lower', 'lower_bound', CHECKED),
}
#: the metrics that each trial has
USUAL = {name: one for name, one in METRICS.items() if one.when is ALWAYS}


def metrics_of(run: Figures) -> Dict[str, Optional[float]]:
    """Return {name: number} of the metrics that the run has."""
    return {name: one.of(run) for name, one in METRICS.items() if one.of is not None and one.when.holds(run)}


def fleet_metrics(story: Story) -> Dict[str, Optional[float]]:
    """Return {name: number}, the metrics of orders and of the robots' time; {} if no orders arrived."""
    run = Figures(story)
    return {name: one.of(run) for name, one in METRICS.items()
            if one.of is not None and one.when in (ORDERS, DEADLINES, BATTERIES) and one.when.holds(run)}
