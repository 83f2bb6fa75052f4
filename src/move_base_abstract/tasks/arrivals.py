"""Tasks that arrive at random instants or at those of a file: the same for the same seed, whichever robots do them.

    arrivals:
      - {place: dock, rate_per_hour: 20.0}
      - {name: field, area: [0.0, 0.0, 40.0, 40.0], rate: 0.05, count: 50, duration: 10.0}
      - {name: orders, file: orders.csv}

Instants count from a beginning that the publisher of the tasks chooses.
"""
from __future__ import annotations

import heapq
import math
from dataclasses import dataclass, replace
from functools import partial
from typing import (
    TYPE_CHECKING,
    Any,
    Callable,
    Dict,
    Iterable,
    Iterator,
    List,
    Mapping,
    Optional,
    Sequence,
    Tuple,
    Union,
)

from ..common.arguments import as_float, as_ns, check_kind
from ..common.bounded_yaml import load_yaml_file
from ..common.csv_files import open_csv, rows_of
from ..common.errors import ConfigurationError
from ..common.parameter_table import Parameter, checked, integer, number, numbers, text
from ..common.shown import shown
from ..common.units import LAST_NS, seconds_to_ns
from ..engine.chance import Chance, Purpose
from ..engine.factors import Constant
from ..motion.geometry import Pose2D
from .places import (
    MAX_SECONDS,
    NAME,
    POSE_TABLE,
    PRIORITY,
    WORK_TABLE,
    Place,
    Work,
    place_name,
    read_entry,
    read_work,
)

if TYPE_CHECKING:
    from ..engine.factors import Lognormal

MAX_TASKS = 1_000_000  # in a file
MAX_ENTRIES = 10_000
_PLACE = Parameter('place', None, place_name, 'the name of one of the places')
ARRIVAL_TABLE = (
    NAME,
    _PLACE,
    Parameter('area', None, numbers(4), 'a list [x_min, y_min, x_max, y_max] [m, global frame], x_min <= x_max, '
              'y_min <= y_max'),
    Parameter('rate', None, number(1e-12, 1e9), 'a number in 1e-12..1e9 [1/s, simulated]'),
    Parameter('rate_per_hour', None, number(1e-9, 1e12), 'a number in 1e-9..1e12 [1/h, simulated]'),
    Parameter('count', None, integer(1), 'a whole number >= 1'),
    Parameter('until', None, number(0.0, MAX_SECONDS), 'a number in 0..{:.0f} [s, simulated]'.format(MAX_SECONDS)),
    Parameter('file', None, text, 'the path of a file: .csv, .yaml or .yml'),
    PRIORITY,
    *WORK_TABLE,
)
_TIME = Parameter('time', None, number(0.0, MAX_SECONDS), 'a number in 0..{:.0f} [s, simulated]'.format(MAX_SECONDS))
_DURATION, _, _, _POWER, _ENERGY = WORK_TABLE
_ROW = (_TIME, _PLACE, *POSE_TABLE, PRIORITY, _DURATION, _POWER, _ENERGY)


@dataclass(frozen=True)
class Task:
    """Work at a place or a pose.

    ``place``: the name of the place, '': none; ``pose`` (Pose2D, global frame): where the robot stands. The task
    arrives ``arrival_ns`` [ns] after the beginning. ``duration_ns`` [ns], 0: the duration of work at the place;
    ``power`` [W] and ``energy`` [J] that the work draws.
    """

    task_id: str
    arrival_ns: int
    place: str
    pose: Pose2D
    duration_ns: int = 0
    power: float = 0.0
    energy: float = 0.0
    priority: int = 0  # a higher one comes first where there is no room


def check_task(task: Task) -> None:
    """Check that ``task`` is a :class:`Task` and that its values have the right types.

    :raises ConfigurationError: if not; the text names the value.
    """
    check_kind(task, Task, 'task')
    for name, kind in (('task_id', str), ('place', str), ('pose', Pose2D)):
        check_kind(getattr(task, name), kind, 'task: ' + name)
    as_ns(task.duration_ns, 'task: duration_ns')
    for name in ('power', 'energy'):
        as_float(getattr(task, name), 'task: ' + name)
    if type(task.priority) is not int:
        raise ConfigurationError('task: priority: got {}; allowed: a whole number'.format(shown(task.priority)))


@dataclass(frozen=True)
class Poisson:
    """Tasks at ``place``, or evenly over ``area`` (x_min, y_min, x_max, y_max) [m], with exponential gaps.

    ``rate`` [1/s]: the mean number of tasks per second. There are at most ``count`` tasks (None: endless), and none
    after ``until_ns`` [ns].
    """

    name: str
    rate: float
    work: Work
    place: Optional[Place] = None
    area: Tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    count: Optional[int] = None
    until_ns: int = LAST_NS
    priority: int = 0

    def tasks(self, seed: int) -> Iterator[Task]:
        """Yield the :class:`Task` objects for ``seed``, in the order of their arrival."""
        chance = Chance(seed, 'arrivals {}'.format(self.name))
        arrival_ns, number_ = 0, 0
        while self.count is None or number_ < self.count:
            number_ += 1
            gap = -math.log(chance.uniform(number_, Purpose.ARRIVAL)) / self.rate
            arrival_ns = min(LAST_NS + 1, arrival_ns + max(1, seconds_to_ns(min(gap, MAX_SECONDS))))
            if arrival_ns > self.until_ns:
                return
            yield Task('{}_{}'.format(self.name, number_), arrival_ns, self.place.name if self.place else '',
                       self._pose(chance, number_), self._duration_ns(chance, number_), self.work.power,
                       self.work.energy, self.priority)

    def _pose(self, chance: Chance, number_: int) -> Pose2D:
        if self.place is not None:
            return self.place.pose
        x_min, y_min, x_max, y_max = self.area
        return Pose2D(x_min + (x_max - x_min) * chance.uniform(number_, Purpose.TASK_X),
                      y_min + (y_max - y_min) * chance.uniform(number_, Purpose.TASK_Y))

    def _duration_ns(self, chance: Chance, number_: int) -> int:
        return drawn_ns(self.work.seconds, lambda place: chance.uniform(number_, Purpose.TASK_DURATION, place))


@dataclass(frozen=True)
class Listed:
    """Tasks of a file; ``rows``: (number in the file, Task, distribution of its duration), in the order of arrival."""

    name: str
    rows: Tuple[Tuple[int, Task, Any], ...] = ()

    def tasks(self, seed: int) -> Iterator[Task]:
        """Yield the tasks; only the durations that are drawn depend on the seed."""
        chance = Chance(seed, 'arrivals {}'.format(self.name))
        for number_, task, seconds in self.rows:
            yield replace(task, duration_ns=drawn_ns(
                seconds, partial(chance.uniform, number_, Purpose.TASK_DURATION)))


def drawn_ns(seconds: Any, uniform: Callable[[int], float]) -> int:
    """Return a duration [ns], at least 1, drawn from the distribution ``seconds`` by ``uniform(place)`` in (0, 1)."""
    return max(1, seconds_to_ns(min(seconds.draw(uniform), MAX_SECONDS)))


def merged(arrivals: Sequence[Union[Listed, Poisson]], seed: int) -> Iterable[Task]:
    """Return an iterator over all tasks by their instants; at one instant, in the order of the entries."""
    return heapq.merge(*(entry.tasks(seed) for entry in arrivals), key=lambda task: task.arrival_ns)


def read_arrivals(raw: Mapping[str, Any], places: Dict[str, Place], where: str) -> Tuple[Union[Listed, Poisson], ...]:
    """Return the Poisson processes and files in the list ``raw``; ``places``: {name: Place}.

    :raises ConfigurationError: if an entry is not allowed; the text names ``where``, the entry and what is allowed.
    """
    if not isinstance(raw, list) or len(raw) > MAX_ENTRIES:
        raise ConfigurationError('{}: arrivals: got {}; allowed: a list of at most {} entries'.format(
            where, shown(raw), MAX_ENTRIES))
    arrivals, names = [], set()
    for index, entry in enumerate(raw):
        here = '{}: arrivals[{}]'.format(where, index)
        one = _read_one(read_entry(entry, ARRIVAL_TABLE, here), places, here)
        if one.name in names:
            raise ConfigurationError("{}: name: '{}' is given to more than one entry; allowed: a name of its own "
                                     '(if none is given, it is the name of the place)'.format(here, one.name))
        names.add(one.name)
        arrivals.append(one)
    return tuple(arrivals)


def _read_one(values: Mapping[str, Any], places: Dict[str, Place], where: str) -> Union[Listed, Poisson]:
    given = [key for key in ('place', 'area', 'file') if values[key] is not None]
    if len(given) != 1:
        raise ConfigurationError('{}: got {}; allowed: one of place, area and file'.format(
            where, ' and '.join(given) or 'none of place, area and file'))
    name = checked(values['name'] or values['place'], 'name', NAME, where)
    rates = [values['rate'], None if values['rate_per_hour'] is None else values['rate_per_hour'] / 3600.0]
    if values['file'] is not None:
        return _read_file(name, values, rates, places, where)
    if rates.count(None) != 1:
        raise ConfigurationError('{}: got {} rate and rate_per_hour; allowed: one of them'.format(
            where, 'neither' if None in rates else 'both'))
    place = None if values['place'] is None else find_place(values['place'], places, where)
    area = values['area'] or (0.0,) * 4
    if area[0] > area[2] or area[1] > area[3]:
        raise ConfigurationError('{}: area: got {}; allowed: {}'.format(where, shown(list(area)),
                                                                        ARRIVAL_TABLE[2].allowed))
    work = read_work(values, where, place.work if place else Work())
    if work.seconds is None:
        raise ConfigurationError('{}: duration: not given, neither here nor at a place; allowed: {}'.format(
            where, _DURATION.allowed))
    until_ns = LAST_NS if values['until'] is None else seconds_to_ns(values['until'])
    return Poisson(name, rates[0] or rates[1], work, place, area, values['count'], until_ns, values['priority'])


def find_place(name: str, places: Dict[str, Place], where: str) -> Place:
    """Return the place ``name``.

    :raises ConfigurationError: if there is no such place; the text names ``where`` and some places that exist.
    """
    if name not in places:
        raise ConfigurationError('{}: place: got {}; allowed: {}'.format(
            where, shown(name), ', '.join(list(places)[:10]) or 'none: there are no places'))
    return places[name]


def _read_file(name: str, values: Mapping[str, Any], rates: List[Optional[float]], places: Dict[str, Place],
               where: str) -> Listed:
    path = values['file']
    others = [key for key in ('count', 'until', 'duration') if values[key] is not None]
    others += [key for key, rate in zip(('rate', 'rate_per_hour'), rates) if rate is not None]
    others += [key for key in ('power', 'energy', 'duration_cv', 'priority') if values[key]]
    if others:
        raise ConfigurationError('{}: {}: got {} with a file, which determines it; allowed: name and file'.format(
            where, others[0], shown(values[others[0]])))
    rows = [(index + 1, *_task_of(row, index, name, places, here))
            for index, (here, row) in enumerate(_rows(path, where))]
    if not rows:
        raise ConfigurationError('{}: got no tasks; allowed: at least one'.format(path))
    return Listed(name, tuple(sorted(rows, key=lambda row: row[1].arrival_ns)))


def _rows(path: str, where: str) -> Iterator[Tuple[str, Dict[str, Any]]]:
    """Yield (location for messages, mapping) of each row of a file of tasks, CSV or YAML."""
    if path.endswith('.csv'):
        with open_csv(path) as stream:
            for index, (here, row) in enumerate(rows_of(stream, path)):
                if index >= MAX_TASKS:
                    raise ConfigurationError('{}: got more rows; allowed: at most {} tasks'.format(here, MAX_TASKS))
                yield here, {key: cell.strip() if key == 'place' else _value(cell) for key, cell in row.items() if cell}
        return
    if not path.endswith(('.yaml', '.yml')):
        raise ConfigurationError('{}: file: got {}; allowed: {}'.format(where, shown(path), ARRIVAL_TABLE[7].allowed))
    raw = load_yaml_file(path)
    if not isinstance(raw, dict) or list(raw) != ['tasks'] or not isinstance(raw['tasks'], list):
        raise ConfigurationError('{}: got {}; allowed: a mapping with one key, tasks, a list'.format(
            path, shown(raw)))
    for index, row in enumerate(raw['tasks']):
        yield '{}: tasks {}'.format(path, index), row


def _value(cell: str) -> Union[float, str]:
    try:
        return float(cell)
    except ValueError:
        return cell


def _task_of(row: Dict[str, Any], index: int, name: str, places: Dict[str, Place],
             where: str) -> Tuple[Task, Union[Constant, Lognormal]]:
    """Return (the :class:`Task` of a row without its duration, the distribution of the duration)."""
    values = read_entry(row, _ROW, where)
    has_place, own = 'place' in row, [key for key in ('x', 'y', 'yaw') if key in row]
    if 'time' not in row or has_place == bool(own):
        raise ConfigurationError('{}: got {}; allowed: a time, and either a place or x, y and yaw'.format(
            where, shown(row)))
    place = find_place(values['place'], places, where) if has_place else None
    work = place.work if place else Work()
    seconds = work.seconds if values['duration'] is None else Constant(values['duration'])
    if seconds is None:
        raise ConfigurationError('{}: duration: not given, neither here nor at a place; allowed: {}'.format(
            where, _DURATION.allowed))
    pose = place.pose if place else Pose2D(values['x'], values['y'], values['yaw'])
    return Task('{}_{}'.format(name, index + 1), seconds_to_ns(values['time']), place.name if place else '', pose, 0,
                values['power'] or work.power, values['energy'] or work.energy, values['priority']), seconds
