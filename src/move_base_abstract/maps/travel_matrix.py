"""Travel matrices: the travel times between places, for worlds that have times but no geometry.

    places:
      - {name: depot, x: 0.0, y: 0.0}
      - {name: field, x: 40.0, y: 10.0}
    times:
      - {from: depot, to: field, seconds: 75.0}

or as CSV: from,from_x,from_y,to,to_x,to_y,seconds. Each direction has a time of its own.
"""
from __future__ import annotations

import math
from collections import OrderedDict
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, NamedTuple, Optional, Tuple

from ..common.bounded_yaml import load_yaml_file
from ..common.csv_files import open_csv, rows_of
from ..common.errors import ConfigurationError
from ..common.kinds import COORDINATE, as_number, check_keys, error, number, string
from ..common.parameter_table import Parameter, kept_per_file, read_mapping
from ..common.shown import shown
from ..motion.geometry import share_along
from ..motion.planned_way import PlannedWay
from .lane_map import NAME
from .planning import StraightLinePlanner, WorldBounds

if TYPE_CHECKING:
    from typing import OrderedDict as Ordered

    from ..motion.geometry import Pose2D
    from .map_check import MapCheck

AT_PLACE = 0.1  # m; a robot as near as this to a place is there
_ON_LINE = 0.01  # m; a robot as near as this to the straight line between two places is on it
CSV_COLUMNS = ['from', 'from_x', 'from_y', 'to', 'to_x', 'to_y', 'seconds']
_PLACE_TABLE = (NAME, Parameter('x', None, COORDINATE), Parameter('y', None, COORDINATE))
_PLACE_NAME = string('the name of a place')
_TIME_TABLE = (Parameter('from', None, _PLACE_NAME), Parameter('to', None, _PLACE_NAME),
               Parameter('seconds', None, number(0.0, 1e9, unit='s, simulated')))


class TravelMatrix(NamedTuple):
    """``places`` {name: (x, y) [m]} in the order of the file, ``seconds`` {(from, to): s}; ``source``: its path."""

    places: Dict[str, Tuple[float, float]]
    seconds: Dict[Tuple[str, str], float]
    source: str


@kept_per_file('travel_matrix')
def read_travel_matrix(path: str) -> TravelMatrix:
    """Return the :class:`TravelMatrix` in the file ``path``, CSV if its name ends with .csv, otherwise YAML.

    The second argument is the namespace of its parameter.

    :raises ConfigurationError: if there is none, or it cannot be used.
    """
    return make_travel_matrix(_read_csv(path) if path.endswith('.csv') else load_yaml_file(path), path)


def make_travel_matrix(raw: Mapping[str, Any], where: str = 'travel_matrix') -> TravelMatrix:
    """Return the :class:`TravelMatrix` in the dictionary ``raw``.

    :raises ConfigurationError: for unknown keys and places, for values that are not allowed, and for places and times
        that are there twice; the text begins with ``where``.
    """
    if not isinstance(raw, dict) or not all(isinstance(raw.get(key), list) for key in ('places', 'times')):
        raise error(where, raw, 'a mapping with the lists places and times')
    check_keys(raw, ('places', 'times'), where, '')
    places: Dict[str, Tuple[float, float]] = {}
    for index, entry in enumerate(raw['places']):
        place = '{}: places[{}]'.format(where, index)
        name, x, y = read_mapping(entry, _PLACE_TABLE, place, ('name', 'x', 'y')).values()
        if name in places:
            raise error(f'{place}: name', name, 'each name once')
        places[name] = x, y
    _check_apart(places, where)
    seconds: Dict[Tuple[str, str], float] = {}
    for index, entry in enumerate(raw['times']):
        place = '{}: times[{}]'.format(where, index)
        *pair, duration = read_mapping(entry, _TIME_TABLE, place, ('from', 'to', 'seconds')).values()
        for key, name in zip(('from', 'to'), pair):
            if name not in places:
                raise error(f'{place}: {key}', name, _PLACE_NAME.allowed)
        if tuple(pair) in seconds:
            raise ConfigurationError('{}: from {} to {} is there twice'.format(place, *map(shown, pair)))
        seconds[pair[0], pair[1]] = duration
    return TravelMatrix(places, seconds, where)


def _check_apart(places: Dict[str, Tuple[float, float]], where: str) -> None:
    """Check that no robot can be at two places at the same time.

    :raises ConfigurationError: if two places are too near each other.
    """
    ordered = sorted(places.items(), key=lambda place: place[1])
    for number_, (name, (x, y)) in enumerate(ordered):
        for other, (a, b) in ordered[number_ + 1:]:
            if a - x > 2.0 * AT_PLACE:
                break
            if math.hypot(a - x, b - y) <= 2.0 * AT_PLACE:
                raise ConfigurationError('{}: places: {} and {} are {:g} m apart; allowed: more than {:g} m'.format(
                    where, shown(name), shown(other), math.hypot(a - x, b - y), 2.0 * AT_PLACE))


def _read_csv(path: str) -> Dict[str, List[Dict[str, Any]]]:
    places: Ordered[str, Tuple[float, ...]] = OrderedDict()
    times: List[Dict[str, Any]] = []
    with open_csv(path) as stream:
        for where, row in rows_of(stream, path):
            if list(row) != CSV_COLUMNS:
                raise error(f'{path}: columns', list(row), ','.join(CSV_COLUMNS))
            try:
                numbers = [as_number(row[key]) for key in ('from_x', 'from_y', 'to_x', 'to_y', 'seconds')]
            except (TypeError, ValueError):
                raise error(where, dict(row), 'numbers, except for the names') from None
            for name, place in ((row['from'], tuple(numbers[:2])), (row['to'], tuple(numbers[2:4]))):
                if places.setdefault(name, place) != place:
                    raise ConfigurationError('{}: {} is at {} and at {}; a name has one place'.format(
                        where, shown(name), places[name], place))
            times.append({'from': row['from'], 'to': row['to'], 'seconds': numbers[4]})
    return {'places': [{'name': name, 'x': x, 'y': y} for name, (x, y) in places.items()], 'times': times}


class MatrixPlanner(StraightLinePlanner):
    """Plans straight ways between the places of ``matrix`` (TravelMatrix), with the durations in it.

    ``bounds`` and the map only decide which goals are allowed.
    """

    goes_straight = False
    keeps_times = True

    def __init__(self, matrix: TravelMatrix, bounds: WorldBounds = WorldBounds(),
                 map_check: Optional[MapCheck] = None) -> None:
        super().__init__(bounds, map_check)
        self._matrix = matrix
        self._places = list(matrix.places.items())

    def refusal_of_way(self, start: Pose2D, goal: Pose2D) -> Optional[str]:
        """Return a text that says why there is no way from ``start`` to ``goal``; call it only if there is none."""
        refusal = super().refusal_of_way(start, goal)
        if refusal is not None:
            return refusal
        name = self._at(goal)
        if name is None:
            return 'The goal ({:g}, {:g}) lies at no place of the travel matrix.'.format(goal.x, goal.y)
        return 'The travel matrix has no time from {} to {}.'.format(shown(self._nearest(start)[0]), shown(name))

    def corners(self, start: Pose2D, goal: Pose2D) -> Optional[PlannedWay]:
        """Return the :class:`.PlannedWay`, which has a duration and no corners, or None if there is no way."""
        name = self._at(goal) if self.reachable(goal) else None
        seconds = None if name is None else self._seconds(start, name)
        return None if seconds is None else PlannedWay(seconds=seconds)

    def _nearest(self, pose: Pose2D) -> Tuple[Optional[str], float]:
        """Return (name, distance [m]) of the nearest place; of equally near ones the first in the file counts."""
        return min(((name, math.hypot(x - pose.x, y - pose.y)) for name, (x, y) in self._places),
                   key=lambda place: round(place[1], 6), default=(None, math.inf))

    def _at(self, pose: Pose2D) -> Optional[str]:
        name, distance = self._nearest(pose)
        return name if distance <= AT_PLACE else None

    def _seconds(self, start: Pose2D, goal_name: str) -> Optional[float]:
        """Return the travel time [s] from ``start``, or None; between two places it is a share of their time."""
        name = self._at(start)
        if name == goal_name:
            return self._matrix.seconds.get((name, name), 0.0)
        if name is not None:
            return self._matrix.seconds.get((name, goal_name))
        x, y = self._matrix.places[goal_name]
        left = math.hypot(x - start.x, y - start.y)
        on_line = [(math.hypot(a - x, b - y), one) for one, (a, b) in self._places if one != goal_name
                   and (one, goal_name) in self._matrix.seconds and _is_between((a, b), (x, y), start)]
        if on_line:
            whole, one = min(on_line, key=lambda place: round(place[0], 6))
            return self._matrix.seconds[one, goal_name] * min(1.0, left / whole)
        others = ((other, place) for other, place in self._places if other != goal_name)
        nearest: Any = min(((round(math.hypot(a - start.x, b - start.y), 6), one) for one, (a, b) in others),
                      key=lambda place: place[0], default=(0.0, None))[1]
        return self._matrix.seconds.get((nearest, goal_name))


def _is_between(begin: Tuple[float, float], end: Tuple[float, float], pose: Pose2D) -> bool:
    """Return whether ``pose`` is on the straight line from ``begin`` to ``end``."""
    share = share_along(begin, end, pose.x, pose.y)
    return math.hypot(begin[0] + share * (end[0] - begin[0]) - pose.x,
                      begin[1] + share * (end[1] - begin[1]) - pose.y) <= _ON_LINE
