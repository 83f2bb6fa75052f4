"""Zones: named areas of the world, which may have place for a limited number of robots. They come from a scenario.

    zones:
      - {name: gate, rectangle: [4.0, -1.0, 6.0, 1.0], capacity: 1}
      - {name: yard, polygon: [[0, 0], [20, 0], [20, 10], [0, 15]]}      # for any number of robots

A zone may hold any number of robots unless it has a ``capacity``. A zone with ``charger`` charges the robots that stand
in it.
"""
from __future__ import annotations

from typing import Any, Dict, Mapping, NamedTuple, Optional, Tuple, Union

from ..common.errors import ConfigurationError
from ..common.kinds import check_keys, integer, number
from ..common.parameter_table import Parameter, checked
from ..common.ros_names import ROBOT_NAME_RULE, is_robot_name
from ..common.shown import shown
from ..maps.lane_map import GROUP
from .outline import MAX_POINTS, Outline, rectangle
from .passages import passages

KEYS = ('name', 'rectangle', 'polygon', 'capacity', 'charger', 'group', 'max_speed')
MAX_ZONES = 10_000
_NUMBER = number(-1e9, 1e9)
_CURRENT = number(above=0.0, high=1e9)


def _charger(value: object) -> Union[bool, float, None]:
    return value if value is None or value is True else None if value is False else _CURRENT(value)


_CAPACITY = Parameter('capacity', None, integer(1, note='or none: any number of robots'))
_CHARGER = Parameter('charger', None, _charger,
                     allowed='true, or a number > 0, <= 1e9 [A], or none: robots are not charged')
#: the top speed of robots in a zone
MAX_SPEED = Parameter('max_speed', None, number(1e-6, 1e6, unit='m/s', note='or none: as fast as they are'))
_RECTANGLE = ('[x_min, y_min, x_max, y_max] [m, global frame, within +-1e9] with x_min < x_max and '
              'y_min < y_max')
_POLYGON = ('a list of 3 to {} points [x, y] [m, global frame, within +-1e9], the corners of a polygon that does not '
            'cross or touch itself'.format(MAX_POINTS))


class Zone(NamedTuple):
    """A named area with an ``outline`` (Outline, global frame) and place for ``capacity`` robots, None: for any number.

    ``charger``: the current [A] that charges robots that stand in it, True: their own ``charging_current``, None: they
    are not charged; ``group``: the name of its group, None: it has none; ``max_speed`` [m/s]: the top speed of robots
    in it, None: no limit.
    """

    name: str
    outline: Outline
    capacity: Optional[int] = None
    charger: Union[bool, float, None] = None
    group: Optional[str] = None
    max_speed: Optional[float] = None

    def contains(self, x: float, y: float) -> bool:
        """Return whether (x, y) [m, global frame] is in the zone, more than a micrometre from its border."""
        return self.outline.contains(x, y)

    def passages(self, leg: Any) -> Any:
        """Return the instants at which a leg or route enters and leaves: [:class:`.passages.Passage`, ...]."""
        return passages(leg, self.outline)


def read_zones(raw: Any, where: str) -> Tuple[Zone, ...]:
    """Return the :class:`Zone` objects in the list ``raw``, in its order; the text of an error begins with ``where``.

    :raises ConfigurationError: for unknown keys, values that are not allowed, and a name that is given twice.
    """
    if raw is None:
        return ()
    if not isinstance(raw, list) or len(raw) > MAX_ZONES:
        raise ConfigurationError('{}: zones: got {}; allowed: a list of at most {} zones'.format(
            where, shown(raw), MAX_ZONES))
    zones = tuple(_read_zone(entry, '{}: zones[{}]'.format(where, index)) for index, entry in enumerate(raw))
    names: Dict[str, int] = {}
    for index, zone in enumerate(zones):
        first = names.setdefault(zone.name, index)
        if first != index:
            raise ConfigurationError("{}: zones[{}]: the name '{}' is that of zones[{}] too; each zone needs a "
                                     'name of its own'.format(where, index, zone.name, first))
    return zones


def _read_zone(raw: Mapping[str, Any], where: str) -> Zone:
    if not isinstance(raw, dict):
        raise ConfigurationError('{}: got {}; allowed: a mapping with name and rectangle or polygon'.format(
            where, shown(raw)))
    check_keys(raw, KEYS, where, '')
    name = raw.get('name')
    if not isinstance(name, str) or not is_robot_name(name):
        raise ConfigurationError('{}: name: got {}; allowed: {}'.format(where, shown(name), ROBOT_NAME_RULE))
    if ('rectangle' in raw) == ('polygon' in raw):
        raise ConfigurationError('{}: got {} rectangle and polygon; allowed: one of them'.format(
            where, 'both' if 'rectangle' in raw else 'neither'))
    outline = _outline(raw, 'rectangle' if 'rectangle' in raw else 'polygon', where)
    capacity = raw.get('capacity')
    return Zone(name, outline, None if capacity is None else checked(capacity, 'capacity', _CAPACITY, where),
                checked(raw.get('charger'), 'charger', _CHARGER, where),
                checked(raw['group'], 'group', GROUP, where) if raw.get('group') is not None else None,
                None if raw.get('max_speed') is None else checked(raw['max_speed'], 'max_speed', MAX_SPEED, where))


def _outline(raw: Mapping[str, Any], key: str, where: str) -> Outline:
    value = raw[key]
    reason = ''
    try:
        if key == 'rectangle':
            x_min, y_min, x_max, y_max = (_NUMBER(part) for part in value)
            return rectangle(x_min, y_min, x_max, y_max)
        points = [(_NUMBER(x), _NUMBER(y)) for x, y in value]
    except (TypeError, ValueError, OverflowError):
        pass
    else:
        try:
            return Outline(points)
        except ValueError as error:
            reason = ', which {}'.format(error)
    raise ConfigurationError('{}: {}: got {}{}; allowed: {}'.format(
        where, key, shown(value), reason, _RECTANGLE if key == 'rectangle' else _POLYGON))
