"""Orders as values: several stops in a row, an arrival, a deadline and a priority.

{stops: [{place: bay_1_2, action: load}, {place: station_1, action: unload, duration: 8.0}], deadline: 600.0}
"""
from __future__ import annotations

import sys
from dataclasses import dataclass
from numbers import Integral, Real
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

from ..common.errors import ConfigurationError
from ..common.kinds import error, number, one_of
from ..common.parameter_table import Parameter, read_mapping
from ..common.shown import shown
from ..motion.geometry import Pose2D
from ..tasks.arrivals import PLACE, Task, place_or_pose, some_of
from ..tasks.places import MAX_SECONDS, POSE_TABLE, PRIORITY, WORK_TABLE, Place, Work, read_work

#: what the robot does at a stop; after a load it carries goods
WORK, LOAD, UNLOAD = 'work', 'load', 'unload'
ACTIONS = (WORK, LOAD, UNLOAD)
MAX_STOPS = 100
_LARGEST = sys.float_info.max
DEADLINE = Parameter('deadline', None, number(0.0, MAX_SECONDS, unit='s, simulated'))
ACTION = Parameter('action', WORK, one_of(*ACTIONS))
STOP_TABLE = (PLACE, *POSE_TABLE, ACTION, *WORK_TABLE)


@dataclass(frozen=True)
class Stop:
    """One stop of an order: where it is, and the work there.

    ``pose`` (Pose2D, global frame); ``place``: the name of the place, '': none, so any number of robots may work there;
    ``action``: one of ACTIONS; ``duration_ns`` [ns] of the work, 0: the robot goes on at once; ``power`` [W] and
    ``energy`` [J] that the work draws.
    """

    pose: Pose2D
    place: str = ''
    action: str = WORK
    duration_ns: int = 0
    power: float = 0.0
    energy: float = 0.0

    def task(self, task_id: str, priority: int) -> Task:
        """Return the Task of the work at this stop."""
        return Task(task_id, 0, self.place, self.pose, self.duration_ns, self.power, self.energy, priority)


@dataclass(frozen=True)
class Order:
    """Stops in a row, for one robot. The order arrives ``arrival_ns`` [ns] after the beginning.

    ``deadline_ns`` [ns]: counted from the arrival, None: there is none. Orders with a higher ``priority`` come first.
    """

    order_id: str
    arrival_ns: int
    stops: Tuple[Stop, ...]
    deadline_ns: Optional[int] = None
    priority: int = 0


_ORDER_KINDS = (('order_id', (str,), 'a text'), ('stops', (tuple, list), 'a list of stops'),
                ('deadline_ns', (Integral, type(None)), 'a whole number [ns], or None'),
                ('priority', (Integral,), 'a whole number'))
_STOP_KINDS = (('pose', (Pose2D,), 'a Pose2D'), ('place', (str,), 'a text'), ('action', (str,), 'a text'),
               ('duration_ns', (Integral,), 'a whole number [ns]'), ('power', (Real,), 'a number'),
               ('energy', (Real,), 'a number'))
_SHOWN_AS = {'order_id': 'id', 'deadline_ns': 'deadline', 'duration_ns': 'duration'}


def fault_of(order: Order, places: Mapping[str, Place]) -> Optional[str]:
    """Return a text that says what is wrong with ``order``, or None. The order may contain values of any kind."""
    fault = _fault_of_kinds(order, _ORDER_KINDS)
    if fault is not None:
        return fault
    if not order.order_id:
        return 'id: got none; allowed: an id of its own for each order'
    if not 1 <= len(order.stops) <= MAX_STOPS:
        return 'stops: got {}; allowed: 1 to {}'.format(len(order.stops), MAX_STOPS)
    try:
        PRIORITY.kind(int(order.priority))
    except ConfigurationError:
        return 'priority: got {}; allowed: {}'.format(shown(order.priority), PRIORITY.allowed)
    if order.deadline_ns is not None and order.deadline_ns < 0:
        return 'deadline: got {:g} s before its arrival; allowed: not before it'.format(-order.deadline_ns / 1e9)
    for index, stop in enumerate(order.stops):
        fault = _fault_of_stop(stop, places)
        if fault:
            return 'stops[{}]: {}'.format(index, fault)
    return None


def _fault_of_kinds(value: Any, kinds: Sequence[Tuple[str, Tuple[Any, ...], str]]) -> Optional[str]:
    for name, allowed, text in kinds:
        got = getattr(value, name, None)
        if not isinstance(got, allowed) or isinstance(got, bool):
            return '{}: got {}; allowed: {}'.format(_SHOWN_AS.get(name, name), shown(got), text)
    return None


def _fault_of_stop(stop: Stop, places: Mapping[str, Place]) -> Optional[str]:
    fault = _fault_of_kinds(stop, _STOP_KINDS)
    if fault is not None:
        return fault
    if stop.place and stop.place not in places:
        return 'place: got {}; allowed: {}'.format(shown(stop.place), some_of(places))
    if stop.action not in ACTIONS:
        return 'action: got {}; allowed: {}'.format(shown(stop.action), ACTION.allowed)
    for name, value in (('duration [ns]', stop.duration_ns), ('power [W]', stop.power), ('energy [J]', stop.energy)):
        if not 0 <= value <= _LARGEST:
            return '{}: got {}; allowed: a finite number >= 0'.format(name, shown(value))
    return None


@dataclass(frozen=True)
class ListedStop:
    """A stop of a file without its duration, and the distribution of the duration [s] (None: it takes no time)."""

    stop: Stop
    seconds: Any


def read_stop(raw: Any, places: Dict[str, Place], where: str) -> ListedStop:
    """Return the stop in a mapping with the keys of :data:`STOP_TABLE`; it is at a place or at a pose.

    :raises ConfigurationError: if it is not allowed; the text names ``where`` and what is allowed.
    """
    values = read_mapping(raw, STOP_TABLE, where)
    place, pose = place_or_pose(raw, values, places, where)
    return stop_at(place, pose, values['action'], read_work(values, where, place.work if place else Work()))


def stop_at(place: Optional[Place], pose: Pose2D, action: str, work: Work) -> ListedStop:
    """Return the stop at ``place``, or at ``pose`` if there is none, with the ``action`` and ``work`` there."""
    return ListedStop(Stop(pose, place.name if place else '', action, 0, work.power, work.energy), work.seconds)


def read_stops(raw: Any, where: str) -> List[Any]:
    """Return ``raw``, the value of a key ``stops``.

    :raises ConfigurationError: if it is not a list, or is too long or empty.
    """
    if not isinstance(raw, list) or not 1 <= len(raw) <= MAX_STOPS:
        raise error(f'{where}: stops', raw, f'a list of 1 to {MAX_STOPS} stops')
    return raw
