"""Orders that arrive: at random instants, regularly, or as listed in a file; the same orders for the same seed.

    orders:
      - {name: picks, rate_per_hour: 60.0, count: 100, deadline: 600.0,
         stops: [{places: ['bay_*'], action: load}, {places: [station_1, station_2], action: unload}]}
      - {name: rounds, every: 900.0, stops: [{place: gate}]}
      - {name: listed, file: my_orders.yaml}

Instants count from a beginning that the publisher of the orders chooses.
"""
from __future__ import annotations

import fnmatch
import heapq
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Dict, Iterable, Iterator, List, Mapping, Optional, Sequence, Tuple, Union

from ..common.errors import ConfigurationError
from ..common.kinds import ANY, error, number
from ..common.parameter_table import Parameter, read_mapping
from ..common.units import LAST_NS, seconds_to_ns
from ..engine.chance import Chance, Purpose
from ..motion.geometry import Pose2D
from ..tasks.arrivals import (
    AREA,
    FILE,
    RATE_TABLE,
    TIME,
    as_value,
    drawn_ns,
    exponential_ns,
    file_alone,
    instants,
    point_in,
    read_sources,
    rows_in,
    some_of,
)
from ..tasks.places import MAX_SECONDS, NAME, PRIORITY, WORK_TABLE, Place, read_work
from .order import ACTION, DEADLINE, ListedStop, Order, Stop, read_stop, read_stops, stop_at


def _texts(value: Any) -> List[str]:
    if not isinstance(value, list) or not value or not all(isinstance(one, str) for one in value):
        raise ValueError
    return value


_STOPS = Parameter('stops', None, ANY, allowed='a list of stops')
ORDER_TABLE = (
    NAME, *RATE_TABLE, Parameter('every', None, number(1e-9, MAX_SECONDS, unit='s, simulated')), _STOPS, DEADLINE,
    PRIORITY, FILE)
#: the keys of a stop of a template, in addition to those of a stop of a file
DRAWN_STOP_TABLE = (
    Parameter('places', None, _texts, allowed="a list of names of places, or of patterns: 'bay_*'"), AREA, ACTION,
    *WORK_TABLE)
_ROW = (TIME, _STOPS, DEADLINE, PRIORITY)


@dataclass(frozen=True)
class DrawnStop:
    """A stop of a template: drawn evenly from ``choices``, or from ``area`` (x_min, y_min, x_max, y_max) [m]."""

    choices: Tuple[ListedStop, ...]
    area: Optional[Tuple[float, float, float, float]] = None

    def draw(self, chance: Chance, number_: int) -> Stop:
        """Return the stop of the ``number_``-th order."""
        at = int(chance.uniform(number_, Purpose.ORDER_STOP) * len(self.choices)) if len(self.choices) > 1 else 0
        stop, seconds = self.choices[at].stop, self.choices[at].seconds
        if self.area is not None:
            stop = replace(stop, pose=point_in(self.area, chance, number_))
        return with_duration(stop, seconds, chance, number_)


def with_duration(stop: Stop, seconds: Any, chance: Chance, number_: int) -> Stop:
    """Return ``stop`` with a duration drawn from ``seconds`` for the ``number_``-th order; None: it takes no time."""
    if seconds is None:
        return stop
    return replace(stop, duration_ns=drawn_ns(seconds, partial(chance.uniform, number_, Purpose.TASK_DURATION)))


@dataclass(frozen=True)
class Template:
    """Orders with exponential gaps, at a ``rate`` [1/s], or with the constant gap ``every_ns`` [ns] if it is None.

    There are at most ``count`` orders (None: endless), and none after ``until_ns`` [ns]. ``deadline_ns`` [ns] counts
    from the arrival of each order, None: there is none.
    """

    name: str
    stops: Tuple[DrawnStop, ...]
    rate: Optional[float] = None
    every_ns: int = 0
    count: Optional[int] = None
    until_ns: int = LAST_NS
    deadline_ns: Optional[int] = None
    priority: int = 0

    def orders(self, seed: int) -> Iterator[Order]:
        """Yield the orders for ``seed``, in the order of their arrival."""
        chance = Chance(seed, 'orders {}'.format(self.name))
        of_stops = _chances(seed, self.name, len(self.stops))

        def gap_ns(number_: int) -> int:
            return self.every_ns if self.rate is None else exponential_ns(self.rate, chance, number_)
        for number_, arrival_ns in instants(gap_ns, self.count, self.until_ns):
            stops = tuple(stop.draw(one, number_) for stop, one in zip(self.stops, of_stops))
            yield Order('{}_{}'.format(self.name, number_), arrival_ns, stops, self.deadline_ns, self.priority)


@dataclass(frozen=True)
class ListedOrders:
    """Orders of a file; ``rows``: (number in the file, Order without stops, its stops), in the order of arrival."""

    name: str
    rows: Tuple[Tuple[int, Order, Tuple[ListedStop, ...]], ...]

    def orders(self, seed: int) -> Iterator[Order]:
        """Yield the orders; only the durations that are drawn depend on the seed."""
        most = max(len(stops) for _, _, stops in self.rows)
        of_stops = _chances(seed, self.name, most)
        for number_, order, stops in self.rows:
            yield replace(order, stops=tuple(with_duration(one.stop, one.seconds, chance, number_)
                                             for one, chance in zip(stops, of_stops)))


def _chances(seed: int, name: str, count: int) -> List[Chance]:
    return [Chance(seed, 'orders {} stop {}'.format(name, number_ + 1)) for number_ in range(count)]


OrderSource = Union[Template, ListedOrders]


def merged(sources: Sequence[OrderSource], seed: int) -> Iterable[Order]:
    """Return an iterator over all orders by their instants; at one instant, in the order of the sources."""
    return heapq.merge(*(source.orders(seed) for source in sources), key=lambda order: order.arrival_ns)


def read_orders(raw: Any, places: Dict[str, Place], where: str) -> Tuple[OrderSource, ...]:
    """Return the sources of orders in the list ``raw``; ``places``: {name: Place}.

    :raises ConfigurationError: if an entry is not allowed; the text names ``where``, the entry and what is allowed.
    """
    return read_sources(raw, 'orders', ORDER_TABLE, where, lambda values, here: _read_one(values, places, here),
                        ('name',))


def _read_one(values: Mapping[str, Any], places: Dict[str, Place], where: str) -> OrderSource:
    name = values['name']
    if (values['file'] is None) == (values['stops'] is None):
        raise ConfigurationError('{}: got {} file and stops; allowed: one of them'.format(
            where, 'neither' if values['file'] is None else 'both'))
    if values['file'] is not None:
        file_alone(values, ORDER_TABLE, where)
        return _read_file(name, values['file'], places, where)
    given = [key for key in ('rate', 'rate_per_hour', 'every') if values[key] is not None]
    if len(given) != 1:
        raise ConfigurationError('{}: got {}; allowed: one of rate, rate_per_hour and every'.format(
            where, ' and '.join(given) or 'none of rate, rate_per_hour and every'))
    rate = values['rate'] if values['rate_per_hour'] is None else values['rate_per_hour'] / 3600.0
    stops = tuple(_drawn(one, places, '{}: stops[{}]'.format(where, index))
                  for index, one in enumerate(read_stops(values['stops'], where)))
    return Template(name, stops, rate, _ns(values['every']) or 0, values['count'],
                    LAST_NS if values['until'] is None else seconds_to_ns(values['until']), _ns(values['deadline']),
                    values['priority'])


def _ns(seconds: Optional[float]) -> Optional[int]:
    return None if seconds is None else seconds_to_ns(seconds)


def _drawn(raw: Any, places: Dict[str, Place], where: str) -> DrawnStop:
    """Return the stop of a template in ``raw``: at one place or pose, or drawn from places or an area."""
    groups = [key for key in ('places', 'area') if isinstance(raw, dict) and raw.get(key) is not None]
    if not groups:
        known = raw if not isinstance(raw, dict) else {key: value for key, value in raw.items()
                                                       if key not in ('places', 'area')}
        return DrawnStop((read_stop(known, places, where),))
    also = [key for key in ('place', 'x', 'y', 'yaw') if key in raw] + groups[1:]
    if also:
        raise ConfigurationError('{}: got {} and {}; allowed: one of place, places, area, and x, y and yaw'.format(
            where, groups[0], also[0]))
    values = read_mapping(raw, DRAWN_STOP_TABLE, where)
    if values['area'] is not None:
        return DrawnStop((stop_at(None, Pose2D(), values['action'], read_work(values, where)),), values['area'])
    names = _named(values['places'], places, where)
    return DrawnStop(tuple(stop_at(places[name], places[name].pose, values['action'],
                                   read_work(values, where, places[name].work)) for name in names))


def _named(patterns: List[str], places: Dict[str, Place], where: str) -> List[str]:
    """Return the names of the places that match one of the ``patterns``, each once, in the order of the scenario."""
    for pattern in patterns:
        if not fnmatch.filter(places, pattern):
            raise error(f'{where}: places', pattern, some_of(places), ', which matches no place')
    return [name for name in places if any(fnmatch.fnmatchcase(name, pattern) for pattern in patterns)]


def _read_file(name: str, path: str, places: Dict[str, Place], where: str) -> ListedOrders:
    rows = []
    for index, (here, row) in enumerate(rows_in(path, 'orders', where, _cell)):
        values = read_mapping(row, _ROW, here, ('time',))
        stops = tuple(read_stop(one, places, '{}: stops[{}]'.format(here, number_))
                      for number_, one in enumerate(read_stops(values['stops'], here)))
        rows.append((index + 1, Order('{}_{}'.format(name, index + 1), seconds_to_ns(values['time']), (),
                                      _ns(values['deadline']), values['priority']), stops))
    return ListedOrders(name, tuple(sorted(rows, key=lambda row: row[1].arrival_ns)))


def _cell(key: str, cell: str) -> Any:
    """Return the value of a cell. Stops are separated by semicolons; each is 'load bay_1', or a place alone."""
    if key == 'stops':
        return [_stop_words(part.split()) for part in cell.split(';') if part.strip()]
    return as_value(cell)


def _stop_words(words: List[str]) -> Dict[str, str]:
    return {'place': words[-1]} if len(words) == 1 else {'action': words[0], 'place': ' '.join(words[1:])}

