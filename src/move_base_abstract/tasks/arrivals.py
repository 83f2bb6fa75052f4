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
    Mapping,
    Optional,
    Sequence,
    Tuple,
    TypeVar,
    Union,
)

from ..common.arguments import as_float, as_ns, check_kind
from ..common.bounded_yaml import load_yaml_file
from ..common.csv_files import open_csv, rows_of
from ..common.errors import ConfigurationError
from ..common.kinds import COORDINATE, as_number, error, integer, made_by, number, numbers, string
from ..common.parameter_table import Parameter, checked, read_mapping
from ..common.ros_names import robot_name
from ..common.units import LAST_NS, seconds_to_ns
from ..engine.chance import Chance, Purpose
from ..engine.factors import Constant
from ..motion.geometry import Pose2D
from .places import MAX_SECONDS, NAME, POSE_TABLE, PRIORITY, WORK_TABLE, Place, Work, read_work

if TYPE_CHECKING:
    from ..engine.factors import Lognormal

Source = TypeVar('Source')
MAX_TASKS = 1_000_000  # in a file
MAX_ENTRIES = 10_000
_corners = numbers(4, single=COORDINATE)


def _area(value: object) -> Tuple[float, ...]:
    area: Tuple[float, ...] = _corners(value)
    if area[0] > area[2] or area[1] > area[3]:
        raise ValueError
    return area


PLACE = Parameter('place', None, robot_name, allowed='the name of one of the places')
AREA = Parameter('area', None, made_by(_area, 'a list [x_min, y_min, x_max, y_max] within 1e9 [m, global frame], '
                                       'x_min <= x_max, y_min <= y_max', _corners.schema))
FILE = Parameter('file', None, string('the path of a file: .csv, .yaml or .yml'))
#: how often something arrives
RATE_TABLE = (
    Parameter('rate', None, number(1e-12, 1e9, unit='1/s, simulated')),
    Parameter('rate_per_hour', None, number(1e-9, 1e12, unit='1/h, simulated')),
    Parameter('count', None, integer(1)),
    Parameter('until', None, number(0.0, MAX_SECONDS, unit='s, simulated')),
)
ARRIVAL_TABLE = (NAME, PLACE, AREA, *RATE_TABLE, FILE, PRIORITY, *WORK_TABLE)
TIME = Parameter('time', None, number(0.0, MAX_SECONDS, unit='s, simulated'))
_DURATION, _, _, _POWER, _ENERGY = WORK_TABLE
_ROW = (TIME, PLACE, *POSE_TABLE, PRIORITY, _DURATION, _POWER, _ENERGY)


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
        raise error('task: priority', task.priority, 'a whole number')


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
        for number_, arrival_ns in instants(lambda number_: exponential_ns(self.rate, chance, number_), self.count,
                                            self.until_ns):
            yield Task('{}_{}'.format(self.name, number_), arrival_ns, self.place.name if self.place else '',
                       self.place.pose if self.place else point_in(self.area, chance, number_),
                       drawn_ns(self.work.seconds, partial(chance.uniform, number_, Purpose.TASK_DURATION)),
                       self.work.power, self.work.energy, self.priority)


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


#: begins a warning that it comes long after what came before; only the first such wait is told
NEXT = 'the arrival of the next {}, {},'


def instants(gap_ns: Callable[[int], int], count: Optional[int], until_ns: int) -> Iterator[Tuple[int, int]]:
    """Yield (number, from 1 on; instant [ns]) of things that arrive ``gap_ns(number)`` [ns] after one another.

    There are at most ``count`` of them (None: endless), and none after ``until_ns`` [ns].
    """
    arrival_ns, number_ = 0, 0
    while count is None or number_ < count:
        number_ += 1
        arrival_ns = min(LAST_NS + 1, arrival_ns + gap_ns(number_))
        if arrival_ns > until_ns:
            return
        yield number_, arrival_ns


def exponential_ns(rate: float, chance: Chance, number_: int) -> int:
    """Return the gap [ns] before the ``number_``-th of things that arrive at a ``rate`` [1/s]."""
    return max(1, seconds_to_ns(min(-math.log(chance.uniform(number_, Purpose.ARRIVAL)) / rate, MAX_SECONDS)))


def point_in(area: Tuple[float, float, float, float], chance: Chance, number_: int) -> Pose2D:
    """Return a point that is drawn evenly from ``area`` (x_min, y_min, x_max, y_max) [m]."""
    x_min, y_min, x_max, y_max = area
    return Pose2D(x_min + (x_max - x_min) * chance.uniform(number_, Purpose.TASK_X),
                  y_min + (y_max - y_min) * chance.uniform(number_, Purpose.TASK_Y))


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
    return read_sources(raw, 'arrivals', ARRIVAL_TABLE, where, lambda values, here: _read_one(values, places, here))


def read_sources(raw: Any, key: str, table: Tuple[Parameter, ...], where: str,
                 read_one: Callable[[Mapping[str, Any], str], Source],
                 needed: Sequence[str] = ()) -> Tuple[Source, ...]:
    """Return what ``read_one(values of an entry, where it stands)`` returns for each entry of the list at ``key``.

    ``needed``: the keys that each entry must have.

    :raises ConfigurationError: if ``raw`` is no list, or an entry is not allowed or has the name of another one.
    """
    if not isinstance(raw, list) or len(raw) > MAX_ENTRIES:
        raise error(f'{where}: {key}', raw, f'a list of at most {MAX_ENTRIES} entries')
    sources: Dict[str, Source] = {}
    for index, entry in enumerate(raw):
        here = '{}: {}[{}]'.format(where, key, index)
        one: Any = read_one(read_mapping(entry, table, here, needed), here)
        if one.name in sources:
            raise ConfigurationError("{}: name: '{}' is given to more than one entry; each needs a name of its own{}"
                                     .format(here, one.name, ' (if none is given, it is the name of the place)'
                                             if PLACE in table else ''))
        sources[one.name] = one
    return tuple(sources.values())


def _read_one(values: Mapping[str, Any], places: Dict[str, Place], where: str) -> Union[Listed, Poisson]:
    given = [key for key in ('place', 'area', 'file') if values[key] is not None]
    if len(given) != 1:
        raise ConfigurationError('{}: got {}; allowed: one of place, area and file'.format(
            where, ' and '.join(given) or 'none of place, area and file'))
    name = checked(values['name'] or values['place'], 'name', NAME, where)
    if values['file'] is not None:
        return _read_file(name, values, places, where)
    rates = [values['rate'], None if values['rate_per_hour'] is None else values['rate_per_hour'] / 3600.0]
    if rates.count(None) != 1:
        raise ConfigurationError('{}: got {} rate and rate_per_hour; allowed: one of them'.format(
            where, 'neither' if None in rates else 'both'))
    place = None if values['place'] is None else find_place(values['place'], places, where)
    area = values['area'] or (0.0,) * 4
    work = read_work(values, where, place.work if place else Work())
    if work.seconds is None:
        raise ConfigurationError('{}: the duration, {}, is given neither here nor at a place'.format(
            where, _DURATION.allowed))
    until_ns = LAST_NS if values['until'] is None else seconds_to_ns(values['until'])
    return Poisson(name, rates[0] or rates[1], work, place, area, values['count'], until_ns, values['priority'])


def some_of(places: Mapping[str, Place]) -> str:
    """Return the names of some of ``places``, {name: Place}, for errors."""
    return ', '.join(list(places)[:10]) or 'none: there are no places'


def find_place(name: str, places: Dict[str, Place], where: str) -> Place:
    """Return the place ``name``.

    :raises ConfigurationError: if there is no such place; the text names ``where`` and some places that exist.
    """
    if name not in places:
        raise error(f'{where}: place', name, some_of(places))
    return places[name]


def _read_file(name: str, values: Mapping[str, Any], places: Dict[str, Place], where: str) -> Listed:
    file_alone(values, ARRIVAL_TABLE, where)
    rows = [(index + 1, *_task_of(row, index, name, places, here)) for index, (here, row) in enumerate(
        rows_in(values['file'], 'tasks', where, lambda key, cell: cell.strip() if key == 'place' else as_value(cell)))]
    return Listed(name, tuple(sorted(rows, key=lambda row: row[1].arrival_ns)))


def file_alone(values: Mapping[str, Any], table: Sequence[Parameter], where: str) -> None:
    """Check that an entry with a file has no other key of ``table`` but a name.

    :raises ConfigurationError: if it has one.
    """
    for one in table:
        if one not in (NAME, FILE) and values[one.name] != one.default:
            raise error(f'{where}: {one.name}', values[one.name], 'name and file', ' with a file, which determines it')


def rows_in(path: str, key: str, where: str, value_of: Callable[[str, str], Any]) -> Iterator[
        Tuple[str, Dict[str, Any]]]:
    """Yield (location for messages, mapping) of each row of a file, CSV or YAML with one list at ``key``.

    ``value_of(column, cell)`` returns the value of a cell of a CSV file.

    :raises ConfigurationError: if the file cannot be read, or has no rows or too many.
    """
    if path.endswith('.csv'):
        with open_csv(path) as stream:
            index = -1
            for index, (here, row) in enumerate(rows_of(stream, path)):
                if index >= MAX_TASKS:
                    raise ConfigurationError('{}: got more rows; allowed: at most {} {}'.format(here, MAX_TASKS, key))
                yield here, {column: value_of(column, cell) for column, cell in row.items() if cell}
            is_empty = index < 0
    elif path.endswith(('.yaml', '.yml')):
        raw = load_yaml_file(path)
        if not isinstance(raw, dict) or list(raw) != [key] or not isinstance(raw[key], list):
            raise error(path, raw, f'a mapping with one key, {key}, a list')
        for index, row in enumerate(raw[key]):
            yield '{}: {}[{}]'.format(path, key, index), row
        is_empty = not raw[key]
    else:
        raise error(f'{where}: file', path, FILE.allowed)
    if is_empty:
        raise ConfigurationError('{}: got no {}; allowed: at least one'.format(path, key))


def as_value(cell: str) -> Union[float, str]:
    """Return the number that a cell of a CSV file is, or, if it is none, its text."""
    try:
        return as_number(cell)
    except ValueError:
        return cell


def _task_of(row: Dict[str, Any], index: int, name: str, places: Dict[str, Place],
             where: str) -> Tuple[Task, Union[Constant, Lognormal]]:
    """Return (the :class:`Task` of a row without its duration, the distribution of the duration)."""
    values = read_mapping(row, _ROW, where, ('time',))
    place, pose = place_or_pose(row, values, places, where)
    work = place.work if place else Work()
    seconds = work.seconds if values['duration'] is None else Constant(values['duration'])
    if seconds is None:
        raise ConfigurationError('{}: the duration, {}, is given neither here nor at a place'.format(
            where, _DURATION.allowed))
    return Task('{}_{}'.format(name, index + 1), seconds_to_ns(values['time']), place.name if place else '', pose, 0,
                values['power'] or work.power, values['energy'] or work.energy, values['priority']), seconds


def place_or_pose(raw: Mapping[str, Any], values: Mapping[str, Any], places: Dict[str, Place],
                  where: str) -> Tuple[Optional[Place], Pose2D]:
    """Return (the place, or None; the pose) of an entry ``raw`` with the checked ``values``.

    :raises ConfigurationError: if it does not have either a place or a pose.
    """
    has_place, own = raw.get('place') is not None, [key for key in ('x', 'y', 'yaw') if key in raw]
    if has_place == bool(own):
        raise error(where, raw, 'either a place or x, y and yaw')
    place = find_place(values['place'], places, where) if has_place else None
    return place, place.pose if place else Pose2D(values['x'], values['y'], values['yaw'])
