"""Zones: named areas of the world, which may have place for a limited number of robots. They come from a scenario.

    zones:
      - {name: gate, rectangle: [4.0, -1.0, 6.0, 1.0], capacity: 1}
      - {name: yard, polygon: [[0, 0], [20, 0], [20, 10], [0, 15]]}      # for any number of robots

A zone may hold any number of robots unless it has a ``capacity``. A zone with ``charger`` charges the robots that stand
in it.
"""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from ..common.errors import ConfigurationError
from ..common.kinds import ANY, COORDINATE, error, integer, number
from ..common.parameter_table import Parameter, read_mapping
from ..common.ros_names import ROBOT_NAME_RULE, robot_name
from ..maps.lane_map import GROUP
from ..motion.planned_way import PieceLimit, PlannedWay
from .outline import BORDER, MAX_POINTS, Outline, rectangle

if TYPE_CHECKING:
    from ..motion.geometry import Pose2D

MAX_ZONES = 10_000
_FREE = PieceLimit()
_CURRENT = number(above=0.0, high=1e9)


def _charger(value: object) -> Union[bool, float, None]:
    return value if value is True else None if value is False else _CURRENT(value)


#: the top speed of robots in a zone
MAX_SPEED = Parameter('max_speed', None, number(1e-6, 1e6, unit='m/s', note='or none: as fast as they are'))
_RECTANGLE = ('[x_min, y_min, x_max, y_max] [m, global frame, within +-1e9] with x_min < x_max and '
              'y_min < y_max')
_POLYGON = ('a list of 3 to {} points [x, y] [m, global frame, within +-1e9], the corners of a polygon that does not '
            'cross or touch itself'.format(MAX_POINTS))
TABLE = (
    Parameter('name', None, robot_name, allowed=ROBOT_NAME_RULE),
    Parameter('rectangle', None, ANY, allowed=_RECTANGLE),
    Parameter('polygon', None, ANY, allowed=_POLYGON),
    Parameter('capacity', None, integer(1, note='or none: any number of robots')),
    Parameter('charger', None, _charger, allowed='true, or a number > 0, <= 1e9 [A], or none: robots are not charged'),
    GROUP,
    MAX_SPEED,
)


class Passage(NamedTuple):
    """A robot's stay in an area on one leg: ``enter_ns`` and ``leave_ns`` [ns], the latter None if it ends inside.

    From ``enter_ns`` on the robot is at the border or inside; from ``leave_ns`` on it is at the border or outside. Each
    is the first nanosecond at which that is true. A robot that is inside at the departure, or at the border on its way
    in, enters at the departure.
    """

    enter_ns: int
    leave_ns: Optional[int]


def passages(leg: Any, outline: Outline) -> List[Passage]:
    """Return the :class:`Passage` objects of a leg or route through ``outline`` (Outline), in their order.

    A robot enters or leaves when it has driven as far as the border. So if it turns in place there, it enters or leaves
    before the turn.
    """
    way = leg.way
    pieces = outline.pieces_inside(way)
    ends_inside = outline.contains(*way[-1])
    if not pieces:
        return [Passage(leg.depart_ns, None)] if ends_inside and way[0] == way[-1] else []
    length = math.fsum(math.hypot(x - a, y - b) for (a, b), (x, y) in zip(way, way[1:]))
    return [Passage(leg.covers_ns(begin) if begin > BORDER else leg.depart_ns,
                    None if ends_inside and end >= length - BORDER else leg.covers_ns(end))
            for begin, end in pieces]


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

    def passages(self, leg: Any) -> List[Passage]:
        """Return the instants at which a leg or route enters and leaves: [:class:`Passage`, ...]."""
        return passages(leg, self.outline)


def read_zones(raw: Any, where: str) -> Tuple[Zone, ...]:
    """Return the :class:`Zone` objects in the list ``raw``, in its order; the text of an error begins with ``where``.

    :raises ConfigurationError: for unknown keys, values that are not allowed, and a name that is given twice.
    """
    if raw is None:
        return ()
    if not isinstance(raw, list) or len(raw) > MAX_ZONES:
        raise error(f'{where}: zones', raw, f'a list of at most {MAX_ZONES} zones')
    zones = tuple(_read_zone(entry, '{}: zones[{}]'.format(where, index)) for index, entry in enumerate(raw))
    names: Dict[str, int] = {}
    for index, zone in enumerate(zones):
        first = names.setdefault(zone.name, index)
        if first != index:
            raise ConfigurationError("{}: zones[{}]: the name '{}' is that of zones[{}] too; each zone needs a "
                                     'name of its own'.format(where, index, zone.name, first))
    return zones


def _read_zone(raw: Any, where: str) -> Zone:
    given = {key: value for key, value in raw.items() if value is not None} if isinstance(raw, dict) else raw
    values = read_mapping(given, TABLE, where, ('name',))
    shape = [key for key in ('rectangle', 'polygon') if values[key] is not None]
    if len(shape) != 1:
        raise ConfigurationError('{}: got {} rectangle and polygon; allowed: one of them'.format(
            where, 'both' if shape else 'neither'))
    return Zone(values['name'], _outline(values, shape[0], where), values['capacity'], values['charger'],
                values['group'], values['max_speed'])


def _outline(raw: Mapping[str, Any], key: str, where: str) -> Outline:
    value = raw[key]
    reason = ''
    try:
        if key == 'rectangle':
            x_min, y_min, x_max, y_max = (COORDINATE(part) for part in value)
            return rectangle(x_min, y_min, x_max, y_max)
        points = [(COORDINATE(x), COORDINATE(y)) for x, y in value]
    except (TypeError, ValueError, OverflowError):
        pass
    else:
        try:
            return Outline(points)
        except ValueError as fault:
            reason = ', which {}'.format(fault)
    raise error(f'{where}: {key}', value, _RECTANGLE if key == 'rectangle' else _POLYGON, reason)


def limited(start: Pose2D, corners: Any, goal: Pose2D, zones: Sequence[Tuple[Outline, float]]) -> Any:
    """Return the way from ``start`` along ``corners`` to ``goal`` with the limits of ``zones`` ((Outline, m/s), ...).

    If the way is in none of them, ``corners`` is returned. Where there are several limits, including those that the
    pieces have already, the lowest counts.
    """
    points: List[Tuple[float, float]] = [(start.x, start.y), *corners, (goal.x, goal.y)]
    inside = [(*piece, speed) for outline, speed in zones for piece in outline.pieces_inside(points)]
    if not inside:
        return corners
    count = len(points) - 1
    limits = getattr(corners, 'limits', ()) or (_FREE,) * count
    lanes = getattr(corners, 'lanes', ())
    ends, found, found_lanes = [], [], []
    for piece, end, limit in _pieces(points, limits, inside):
        ends.append(end)
        found.append(limit)
        found_lanes.append(lanes[piece] if lanes else None)
    return PlannedWay(ends[:-1], found, found_lanes if lanes else (), getattr(corners, 'seconds', None),
                      getattr(corners, 'ends_on_lane', False))


def _pieces(points: Sequence[Tuple[float, float]], limits: Sequence[PieceLimit],
            inside: Sequence[Tuple[float, float, float]]) -> Iterator[Tuple[int, Tuple[float, float], PieceLimit]]:
    """Yield (number of the original piece, end, limit) for each piece after the cuts."""
    cuts = sorted({at for begin, end, _ in inside for at in (begin, end)})
    begun = 0.0
    for piece, ((x, y), (to_x, to_y)) in enumerate(zip(points, points[1:])):
        length, last, limit = math.dist((x, y), (to_x, to_y)), 0.0, limits[piece]
        for end in [*(at - begun for at in cuts if BORDER < at - begun < length - BORDER), length]:
            middle, share = begun + 0.5 * (last + end), end / length if length > 0.0 else 1.0
            speed = min((speed for one, other, speed in inside if one < middle < other), default=math.inf)
            place = (to_x, to_y) if end == length else (x + share * (to_x - x), y + share * (to_y - y))
            yield piece, place, PieceLimit(min(limit.speed, speed / limit.share), limit.share,
                                           limit.goes_on or last > 0.0)
            last = end
        begun += length
