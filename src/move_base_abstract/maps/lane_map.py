"""Lanes: a net of nodes and edges on which robots drive, read from a file.

    nodes:
      - {name: depot, x: 0.0, y: 0.0, yaw: 1.57, spots: [[-1, 1], [-1, -1]]}
      - {name: gate, x: 10.0, y: 0.0, capacity: 1}
    edges:
      - {from: depot, to: gate, speed: 0.5, capacity: 1}
      - {from: gate, to: depot, one_way: true, points: [[10, 4], [0, 4]]}

Maps of topological navigation (``tmap`` and ``tmap2``) are read, too: see :mod:`.topological_map`.
"""
from __future__ import annotations

import math
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from ..common.bounded_yaml import load_yaml_file
from ..common.errors import ConfigurationError
from ..common.kinds import COORDINATE, FLAG, check_keys, error, integer, number, string, text
from ..common.parameter_table import Parameter, checked, kept_per_file, read_mapping
from ..common.ros_names import ROBOT_NAME_RULE, robot_name
from ..common.shown import shown
from ..motion.geometry import Pose2D
from .topological_map import is_topological_map, nodes_of_text, plain_map

NEAR = 0.01  # m; a robot as near as this to a node or a lane is there
#: the name of a node, or of a place of a travel matrix
NAME = Parameter('name', None, text(200))
_NODE_NAME = string('the name of a node')


def _points(value: Any) -> Tuple[Tuple[float, float], ...]:
    if not isinstance(value, (list, tuple)):
        raise ValueError
    return tuple((COORDINATE(x), COORDINATE(y)) for x, y in value)


_POINTS = 'a list of [x, y] [m, global frame, within +-1e9]'
_CAPACITY = Parameter('capacity', None, integer(1))
_NODE_TABLE = (NAME, Parameter('x', None, COORDINATE), Parameter('y', None, COORDINATE),
               Parameter('yaw', 0.0, number(unit='rad')), _CAPACITY, Parameter('spots', (), _points, allowed=_POINTS))
#: the capacity of all nodes of a net that have none of their own
_NODE_CAPACITY = Parameter('node_capacity', None, integer(1))
#: also the key of a zone
GROUP = Parameter('group', None, robot_name, allowed=ROBOT_NAME_RULE)
_EDGE_TABLE = (
    Parameter('from', None, _NODE_NAME),
    Parameter('to', None, _NODE_NAME),
    Parameter('points', (), _points, allowed=_POINTS),
    Parameter('length', None, number(1e-6, 1e9, unit='m')),
    Parameter('speed', None, number(1e-6, 1e6, unit='m/s')),
    _CAPACITY,
    Parameter('one_way', False, FLAG),
    GROUP,
)


class Edge(NamedTuple):
    """A lane from the node ``begin`` to the node ``end`` along ``points`` ((x, y), ...) [m], including both nodes.

    ``speed`` [m/s] and ``capacity`` [robots], None: no limit; ``capacity`` counts both directions together. ``share``:
    the part of its speed with which a robot drives, so that the lane takes as long as one of the given ``length``; 1
    if no length is given. ``group``: the name of the group with which the lane shares places, None: it has none.
    """

    begin: str
    end: str
    points: Tuple[Tuple[float, float], ...]
    speed: Optional[float]
    capacity: Optional[int]
    one_way: bool
    share: float
    group: Optional[str] = None

    @property
    def is_counted(self) -> bool:
        """Whether a robot on it holds a place."""
        return self.capacity is not None or self.group is not None


class LaneMap(NamedTuple):
    """``nodes`` {name: Pose2D} and ``edges`` (Edge, ...), both in the order of the file; ``source``: its path.

    ``capacities``: {node: the number of robots that have place there}; nodes that are not in it hold any number.
    ``spots``: {node: ((x, y), ...) [m]}, where as many robots stand at a node as have place there; at nodes that are
    not in it, robots stand at the node's own point.
    """

    nodes: Dict[str, Pose2D]
    edges: Tuple[Edge, ...]
    source: str
    capacities: Mapping[str, int] = {}
    spots: Mapping[str, Tuple[Tuple[float, float], ...]] = {}

    @property
    def has_capacities(self) -> bool:
        """Whether any edge or node has place for a limited number of robots."""
        return bool(self.capacities) or any(edge.is_counted for edge in self.edges)

    @property
    def has_speeds(self) -> bool:
        """Whether any edge limits the speed of robots."""
        return any(edge.speed is not None or edge.share != 1.0 for edge in self.edges)


@kept_per_file('lanes')
def read_lane_map(path: str) -> LaneMap:
    """Return the :class:`LaneMap` in the file ``path``; the second argument is the namespace of its parameter.

    :raises ConfigurationError: if there is none, or it cannot be used.
    """
    return make_lane_map(nodes_of_text(path) or load_yaml_file(path), path)


def make_lane_map(raw: Any, where: str = 'lanes') -> LaneMap:
    """Return the :class:`LaneMap` in the document ``raw``, in our own form or as a topological map.

    :raises ConfigurationError: for unknown keys and nodes, for values that are not allowed, and for nodes and edges
        that are there twice; the text begins with ``where``.
    """
    if is_topological_map(raw):
        raw = plain_map(raw, where)
    if not isinstance(raw, dict) or not all(isinstance(raw.get(key), list) for key in ('nodes', 'edges')):
        raise error(where, raw, 'a mapping with the lists nodes and edges, or a topological map')
    check_keys(raw, ('nodes', 'edges', _NODE_CAPACITY.name), where, '')
    of_all = 0 if raw.get(_NODE_CAPACITY.name) is None else checked(
        raw[_NODE_CAPACITY.name], _NODE_CAPACITY.name, _NODE_CAPACITY, where)
    nodes: Dict[str, Pose2D] = {}
    capacities: Dict[str, int] = {}
    spots: Dict[str, Tuple[Tuple[float, float], ...]] = {}
    for index, entry in enumerate(raw['nodes']):
        here = '{}: nodes[{}]'.format(where, index)
        values = read_mapping(entry, _NODE_TABLE, here, ('name', 'x', 'y'))
        if values['name'] in nodes:
            raise ConfigurationError('{}: the name {} is there twice'.format(here, shown(values['name'])))
        nodes[values['name']] = Pose2D(values['x'], values['y'], values['yaw'])
        capacity: int = values['capacity'] or len(values['spots']) or of_all
        if capacity:
            capacities[values['name']] = capacity
        if values['spots']:
            spots[values['name']] = values['spots']
            if len(values['spots']) != capacity:
                raise error(f'{here}: spots', values['spots'], f'{capacity} spots', f' with capacity: {capacity}')
    if not nodes:
        raise ConfigurationError('{}: nodes: got none; allowed: at least one'.format(where))
    edges = [_edge(entry, nodes, '{}: edges[{}]'.format(where, index)) for index, entry in enumerate(raw['edges'])]
    _check_different(edges, where)
    for name, own in spots.items():
        _check_spots(name, own, nodes, where)
    return LaneMap(nodes, tuple(edges), where, capacities, spots)


def _edge(raw: Any, nodes: Dict[str, Pose2D], where: str) -> Edge:
    values = read_mapping(raw, _EDGE_TABLE, where, ('from', 'to'))
    for key in ('from', 'to'):
        if values[key] not in nodes:
            raise error(f'{where}: {key}', values[key], _NODE_NAME.allowed)
    if values['from'] == values['to']:
        raise ConfigurationError('{}: got from and to {}; allowed: two nodes'.format(where, shown(values['to'])))
    begin, end = nodes[values['from']], nodes[values['to']]
    points = ((begin.x, begin.y), *values['points'], (end.x, end.y))
    length = path_length(points)
    if not all(one != other for one, other in zip(points, points[1:])):
        raise ConfigurationError('{}: got the same place twice in a row; allowed: places that differ'.format(where))
    share = 1.0 if values['length'] is None else length / values['length']
    return Edge(values['from'], values['to'], points, values['speed'], values['capacity'], values['one_way'], share,
                values['group'])


def path_length(points: Sequence[Tuple[float, float]]) -> float:
    """Return the length [m] of the way along ``points`` ((x, y), ...)."""
    return math.fsum(math.hypot(x - a, y - b) for (a, b), (x, y) in zip(points, points[1:]))


def _check_spots(name: str, spots: Sequence[Tuple[float, float]], nodes: Dict[str, Pose2D], where: str) -> None:
    """Check that the ``spots`` of a node are not at one another, and that no other node is as near to one.

    :raises ConfigurationError: if they are not so; robots leave a spot for the node that is nearest.
    """
    for index, spot in enumerate(spots):
        near = min(nodes, key=lambda one: (math.dist(spot, (nodes[one].x, nodes[one].y)), one != name))
        if near != name or any(math.dist(spot, other) <= 2.0 * NEAR for other in spots[:index]):
            raise error(f'{where}: node {shown(name)}: spots', list(spot), 'a spot more than {:g} m from the other '
                        'spots, to which no other node is nearer'.format(2.0 * NEAR))


def _check_different(edges: List[Edge], where: str) -> None:
    """Check that no two edges lead in the same direction between the same nodes.

    :raises ConfigurationError: if there are two.
    """
    indices: Dict[Tuple[str, str], int] = {}
    for index, edge in enumerate(edges):
        for pair in [(edge.begin, edge.end)] + [(edge.end, edge.begin)] * (not edge.one_way):
            first = indices.setdefault(pair, index)
            if first != index:
                raise ConfigurationError('{}: edges[{}]: edges[{}] leads from {} to {}, too; each direction has '
                                         'one edge'.format(where, index, first, *map(shown, pair)))
