"""The parameters of costmaps that have an effect here, without costmaps: the footprint and the local window."""
from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Optional, Tuple

from ..common.errors import ConfigurationError
from ..common.kinds import FLAG, TOPIC, as_number, number
from ..common.parameter_table import Parameter, checked
from ..motion.geometry import share_along

if TYPE_CHECKING:
    from ..motion.geometry import Pose2D

GLOBAL, LOCAL = 'global_costmap', 'local_costmap'

_RADIUS = 0.46  # m, as in costmap_2d
_PADDING = 0.01  # m, as in costmap_2d
_CORNERS = 16  # the corners of the polygon for a circle, as in costmap_2d
_MAX_POINTS = 1000
_MAX_TEXT = 100_000
_MAX_CELLS = 4_000_000
_POINTS = '3 to 1000 points [[x, y], ...] [m, base frame], as a list or as its text'
_ROBOT_RADIUS = Parameter('robot_radius', _RADIUS, number(low=0.0, unit='m'))
_INFLATION_RADIUS = Parameter('inflation_radius', math.inf, number(low=0.0, unit='m'))
_STATIC_MAP = Parameter('static_map', True, FLAG)
_MAP_TOPIC = Parameter('map_topic', 'map', TOPIC)
_ENABLED = Parameter('enabled', True, FLAG)
_OF_OLD = {'inflation_layer': 'InflationLayer'}  # without ``plugins``
_USED_LAYERS = ('StaticLayer', 'InflationLayer')
_FOOTPRINT_PADDING = Parameter('footprint_padding', _PADDING, number(unit='m'))
_WINDOW = (Parameter('width', 10.0, number(above=0.0, unit='m')),
           Parameter('height', 10.0, number(above=0.0, unit='m')),
           Parameter('resolution', 0.05, number(above=0.0, unit='m/cell')))


@dataclass(frozen=True)
class Window:
    """A grid of ``columns`` x ``rows`` cells of ``resolution`` [m] that moves with the robot."""

    columns: int = 200
    rows: int = 200
    resolution: float = 0.05

    def corner(self, pose: Pose2D) -> Tuple[float, float]:
        """Return (x, y) [m] of the south-west corner around ``pose``, on whole cells, in the frame of the pose."""
        return self._edge(pose.x, self.columns), self._edge(pose.y, self.rows)

    def _edge(self, centre: float, cells: int) -> float:
        edge = centre - 0.5 * cells * self.resolution
        number_of_cells = edge / self.resolution
        # If a float is coarser than a cell, there are no whole cells.
        return math.floor(number_of_cells) * self.resolution if abs(number_of_cells) < 2 ** 53 else edge


@dataclass(frozen=True)
class Footprint:
    """The outline of the robot: its corners (x, y) [m] in the base frame.

    ``bare`` are the corners without the padding; ``radius`` [m] is that of a circle, without the padding, or None.
    """

    points: Tuple[Tuple[float, float], ...]
    bare: Tuple[Tuple[float, float], ...] = ()
    radius: Optional[float] = None

    @property
    def inscribed_radius(self) -> float:
        """The distance [m] from the base frame's origin to the nearest point of the outline, as in costmap_2d."""
        return min(_distance_to(begin, end) for begin, end in zip(self.points, self.points[1:] + self.points[:1]))

    def at(self, pose: Pose2D) -> List[Tuple[float, float]]:
        """Return the corners [m] of the robot at ``pose``, in the frame of the pose."""
        cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
        return [(pose.x + cos * x - sin * y, pose.y + sin * x + cos * y) for x, y in self.points]


@dataclass(frozen=True)
class Costmaps:
    """The footprints of both costmaps, and the window of the local one."""

    global_footprint: Footprint
    local_footprint: Footprint
    window: Window = Window()
    #: the distance [m] up to which the global costmap inflates obstacles; inf: nothing says it
    inflation: float = math.inf
    #: the topic of the global costmap's map, as it is given; None: it uses no map
    map_topic: Optional[str] = 'map'


def read_costmaps(raw: Mapping[str, Any], where: str, uses_map: bool = True) -> Tuple[Costmaps, List[str]]:
    """Return (:class:`Costmaps`, paths of the parameters used) of ``raw``, the parameters in the namespace ``where``.

    As in costmap_2d, the outline is ``footprint`` in the costmap's group, or if that is missing the one outside the
    group. If both are missing, it is a circle with ``robot_radius``, found in the same order, or with a radius of
    0.46 m. ``footprint_padding`` in the group is added, by default 0.01 m. The inflation and
    the map are those of the global costmap's layers, which have an effect only with ``uses_map``.

    :raises ConfigurationError: for a wrong type or an impossible value.
    """
    used: List[str] = []
    footprints = [_read_footprint(raw, costmap, used, where) for costmap in (GLOBAL, LOCAL)]
    group = _group(raw, LOCAL)
    width, height, resolution = (_read(group, LOCAL, parameter, used, where) for parameter in _WINDOW)
    cells = [max(1.0, side / resolution) for side in (width, height)]
    if not cells[0] * cells[1] <= _MAX_CELLS:
        raise ConfigurationError('parameters {}/{}: got a width of {:g} m, a height of {:g} m and a resolution of {:g} '
                                 'm/cell; allowed: at most {} cells'.format(where.rstrip('/'), LOCAL, width, height,
                                                                            resolution, _MAX_CELLS))
    of_layers: List[str] = []
    layers = _layers(_group(raw, GLOBAL), of_layers)
    inflation = _read_inflation(_group(raw, GLOBAL), layers, of_layers, where)
    topic = _read_map(_group(raw, GLOBAL), layers, of_layers, where)
    used += of_layers if uses_map else []
    return Costmaps(footprints[0], footprints[1], Window(int(cells[0]), int(cells[1]), resolution), inflation,
                    topic), used


def _layers(group: Mapping[str, Any], used: List[str]) -> Optional[Dict[str, str]]:
    """Return {name: class} of the layers in the costmap's ``plugins``; None if there is no such list."""
    plugins = group.get('plugins')
    if not isinstance(plugins, list) or not all(isinstance(one, dict) for one in plugins):
        return None
    layers = {str(one.get('name')): str(one.get('type')).replace('::', '/').rpartition('/')[2] for one in plugins}
    if set(layers.values()) <= set(_USED_LAYERS):
        used.append('~{}/plugins'.format(GLOBAL))
    return layers


def _read_map(group: Mapping[str, Any], layers: Optional[Dict[str, str]], used: List[str], where: str) -> Optional[str]:
    name, is_there = 'static_layer', True
    if layers is None:
        is_there = _read(group, GLOBAL, _STATIC_MAP, used, where)
    else:
        name = next((name for name, kind in layers.items() if kind == _USED_LAYERS[0]), '')
    own = group.get(name)
    layer, path = own if isinstance(own, dict) else {}, '{}/{}'.format(GLOBAL, name)
    topic: Optional[str] = _read(layer, path, _MAP_TOPIC, used, where)
    is_there = _read(layer, path, _ENABLED, used, where) and is_there and bool(name)
    return _read(group, GLOBAL, replace(_MAP_TOPIC, default=topic), used, where) if is_there else None


def _read_inflation(group: Mapping[str, Any], layers: Optional[Dict[str, str]], used: List[str], where: str) -> float:
    names = [name for name, kind in (_OF_OLD if layers is None else layers).items() if kind == _USED_LAYERS[1]]
    if not names:
        return 0.0
    own = group.get(names[0])
    layer, path = own if isinstance(own, dict) else {}, '{}/{}'.format(GLOBAL, names[0])
    inner = _read(layer, path, _INFLATION_RADIUS, used, where)
    outer = _read(group, GLOBAL, _INFLATION_RADIUS, used, where)  # costmap_2d copies it into its layer
    is_on: bool = _read(layer, path, _ENABLED, used, where)
    inflation: float = inner if math.isinf(outer) else outer
    return inflation if is_on else 0.0


def _distance_to(begin: Tuple[float, float], end: Tuple[float, float]) -> float:
    """Return the distance from (0, 0) to the straight piece between two points (x, y) [m]."""
    share = share_along(begin, end, 0.0, 0.0)
    return math.hypot(*(one + share * (other - one) for one, other in zip(begin, end)))


def _group(raw: Mapping[str, Any], costmap: str) -> Dict[str, Any]:
    group = raw.get(costmap)
    return group if isinstance(group, dict) else {}


def _read(group: Mapping[str, Any], path: str, parameter: Parameter, used: List[str],
          where: str) -> Any:
    """Return the value of ``parameter`` in ``group``, which is below ``path``, or the default; note it in ``used``."""
    if parameter.name not in group:
        return parameter.default
    name = '{}/{}'.format(path, parameter.name).lstrip('/')
    used.append('~' + name)
    return checked(group[parameter.name], name, parameter, where)


def _read_footprint(raw: Mapping[str, Any], costmap: str, used: List[str], where: str) -> Footprint:
    group = _group(raw, costmap)
    points, radius = _first(raw, group, costmap, _FOOTPRINT, used, where), None
    if not points:
        radius = _first(raw, group, costmap, _ROBOT_RADIUS, used, where)
        angles = [2.0 * math.pi * number / _CORNERS for number in range(_CORNERS)]
        points = [(radius * math.cos(angle), radius * math.sin(angle)) for angle in angles]
    padding = _read(group, costmap, _FOOTPRINT_PADDING, used, where)
    return Footprint(tuple((_padded(x, padding), _padded(y, padding)) for x, y in points), tuple(points), radius)


def _first(raw: Mapping[str, Any], group: Mapping[str, Any], costmap: str, parameter: Parameter, used: List[str],
           where: str) -> Any:
    if parameter.name in group:
        return _read(group, costmap, parameter, used, where)
    return _read(raw, '', parameter, used, where)


def _padded(value: float, padding: float) -> float:
    return value + math.copysign(padding, value) if value else value


def _points(value: Any) -> Tuple[Tuple[float, float], ...]:
    """Return ((x, y), ...) of a footprint that is given as a list or as a text; either may be empty.

    :raises ValueError: if it is anything else.
    """
    if isinstance(value, str):
        value = _parse(value)
    if not isinstance(value, (list, tuple)) or not (len(value) == 0 or 3 <= len(value) <= _MAX_POINTS):
        raise ValueError
    single = number()
    points = []
    for point in value:
        if not isinstance(point, (list, tuple)) or len(point) != 2:
            raise ValueError
        points.append((single(point[0]), single(point[1])))
    return tuple(points)


def _parse(text: str) -> List[List[float]]:
    """Return the list of lists of numbers in ``text``, as costmap_2d reads it: commas count as blanks."""
    if len(text) > _MAX_TEXT:
        raise ValueError
    points: List[List[float]] = []
    point: List[float] = []
    depth = 0
    for token in re.findall(r'[\[\]]|[^\s,\[\]]+', text):
        if token == '[':
            depth += 1
            point = []
        elif token == ']':
            depth -= 1
            if depth == 1:
                points.append(point)
        elif depth == 2:
            point.append(as_number(token))
        else:
            raise ValueError
        if not 0 <= depth <= 2:
            raise ValueError
    if depth:
        raise ValueError
    return points


_FOOTPRINT = Parameter('footprint', None, _points, allowed=_POINTS)
