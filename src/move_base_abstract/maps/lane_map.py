"""Lanes: a net of nodes and edges on which robots drive, read from a file.

    nodes:
      - {name: depot, x: 0.0, y: 0.0, yaw: 1.57}
      - {name: gate, x: 10.0, y: 0.0}
    edges:
      - {from: depot, to: gate, speed: 0.5, capacity: 1}
      - {from: gate, to: depot, one_way: true, points: [[10, 4], [0, 4]]}

Maps of the topological navigation of L-CAS (``tmap2``) are read, too: see :mod:`.topological_map`.
"""
from __future__ import annotations

import math
import os
from functools import lru_cache
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from ..common.bounded_yaml import file_version, load_yaml_file
from ..common.errors import ConfigurationError
from ..common.kinds import FLAG, check_keys, integer, number
from ..common.parameter_table import Parameter, checked
from ..common.ros_names import is_robot_name
from ..common.shown import shown
from ..motion.geometry import Pose2D
from .topological_map import is_topological_map, plain_map

NEAR = 0.01  # m; a robot as near as this to a node or a lane is there
_COORDINATE = number(-1e9, 1e9, unit='m, global frame')
_NODE_TABLE = {
    'x': Parameter('x', None, _COORDINATE),
    'y': Parameter('y', None, _COORDINATE),
    'yaw': Parameter('yaw', 0.0, number(unit='rad')),
}


def _points(value: Any) -> Tuple[Tuple[float, float], ...]:
    if not isinstance(value, (list, tuple)):
        raise ValueError
    return tuple((_COORDINATE(x), _COORDINATE(y)) for x, y in value)


def _group(value: Any) -> str:
    if not isinstance(value, str) or not is_robot_name(value):
        raise ValueError
    return value


#: also the key of a zone
GROUP = Parameter('group', None, _group, allowed="letters, digits and '_', a letter first")
_EDGE_TABLE = {
    'points': Parameter('points', (), _points, allowed='a list of [x, y] [m, global frame, within +-1e9]'),
    'length': Parameter('length', None, number(1e-6, 1e9, unit='m')),
    'speed': Parameter('speed', None, number(1e-6, 1e6, unit='m/s')),
    'capacity': Parameter('capacity', None, integer(1)),
    'one_way': Parameter('one_way', False, FLAG),
    'group': GROUP,
}


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
    """``nodes`` {name: Pose2D} and ``edges`` (Edge, ...), both in the order of the file; ``source``: its path."""

    nodes: Dict[str, Pose2D]
    edges: Tuple[Edge, ...]
    source: str

    @property
    def has_capacities(self) -> bool:
        """Whether any edge has place for a limited number of robots."""
        return any(edge.is_counted for edge in self.edges)

    @property
    def has_speeds(self) -> bool:
        """Whether any edge limits the speed of robots."""
        return any(edge.speed is not None or edge.share != 1.0 for edge in self.edges)


def read_lane_map(path: str, where: str) -> LaneMap:
    """Return the :class:`LaneMap` in the file ``path``.

    :raises ConfigurationError: if there is none, or it cannot be used; ``where`` is the namespace of the parameter.
    """
    return _lane_map_in(*found(path, 'lanes', where))


def found(path: str, key: str, where: str) -> Tuple[str, int, int]:
    """Return (path, time of the last change [ns], size [bytes]) of the file that the parameter ``key`` names.

    :raises ConfigurationError: if the path is not absolute, or there is no such file.
    """
    if not os.path.isabs(path):
        raise ConfigurationError('parameter {}/{}: got {}; allowed: an absolute path; in a scenario file also a path '
                                 'from its folder'.format(where.rstrip('/'), key, shown(path)))
    return (path, *file_version(path, 'parameter {}/{}'.format(where.rstrip('/'), key)))


@lru_cache(maxsize=16)
def _lane_map_in(path: str, _mtime_ns: int, _size: int) -> LaneMap:
    """Return the lanes in a file; they are cached, since many robots ask for the same file."""
    return make_lane_map(load_yaml_file(path), path)


def make_lane_map(raw: Mapping[str, Any], where: str = 'lanes') -> LaneMap:
    """Return the :class:`LaneMap` in the dictionary ``raw``, in our own form or as a tmap2.

    :raises ConfigurationError: for unknown keys and nodes, for values that are not allowed, and for nodes and edges
        that are there twice; the text begins with ``where``.
    """
    if is_topological_map(raw):
        raw = plain_map(raw, where)
    if not isinstance(raw, dict) or not all(isinstance(raw.get(key), list) for key in ('nodes', 'edges')):
        raise ConfigurationError('{}: got {}; allowed: a mapping with the lists nodes and edges, or a tmap2'.format(
            where, shown(raw)))
    check_keys(raw, ('nodes', 'edges'), where, '')
    nodes: Dict[str, Pose2D] = {}
    for index, entry in enumerate(raw['nodes']):
        name, pose = _node(entry, '{}: nodes[{}]'.format(where, index))
        if name in nodes:
            raise ConfigurationError('{}: nodes[{}]: the name {} is there twice'.format(where, index, shown(name)))
        nodes[name] = pose
    if not nodes:
        raise ConfigurationError('{}: nodes: got none; allowed: at least one'.format(where))
    edges = [_edge(entry, nodes, '{}: edges[{}]'.format(where, index)) for index, entry in enumerate(raw['edges'])]
    _check_different(edges, where)
    return LaneMap(nodes, tuple(edges), where)


def is_place_name(value: Any) -> bool:
    """Return whether ``value`` can be the name of a node or a place: a text of 1 to 200 printable characters."""
    return isinstance(value, str) and 0 < len(value) <= 200 and value.isprintable()


def _node(raw: Mapping[str, Any], where: str) -> Tuple[str, Pose2D]:
    _check_mapping(raw, ('name', *_NODE_TABLE), ('name', 'x', 'y'), where)
    if not is_place_name(raw['name']):
        raise ConfigurationError('{}: name: got {}; allowed: 1 to 200 characters'.format(where, shown(raw['name'])))
    return raw['name'], Pose2D(*(checked(raw.get(key, parameter.default), key, parameter, where)
                                 for key, parameter in _NODE_TABLE.items()))


def _edge(raw: Mapping[str, Any], nodes: Dict[str, Pose2D], where: str) -> Edge:
    _check_mapping(raw, ('from', 'to', *_EDGE_TABLE), ('from', 'to'), where)
    for key in ('from', 'to'):
        if not isinstance(raw[key], str) or raw[key] not in nodes:
            raise ConfigurationError('{}: {}: got {}; allowed: the name of a node'.format(where, key, shown(raw[key])))
    if raw['from'] == raw['to']:
        raise ConfigurationError('{}: got from and to {}; allowed: two nodes'.format(where, shown(raw['to'])))
    values = {key: checked(raw[key], key, parameter, where) if key in raw else parameter.default
              for key, parameter in _EDGE_TABLE.items()}
    begin, end = nodes[raw['from']], nodes[raw['to']]
    points = ((begin.x, begin.y), *values['points'], (end.x, end.y))
    length = path_length(points)
    if not all(one != other for one, other in zip(points, points[1:])):
        raise ConfigurationError('{}: got the same place twice in a row; allowed: places that differ'.format(where))
    share = 1.0 if values['length'] is None else length / values['length']
    return Edge(raw['from'], raw['to'], points, values['speed'], values['capacity'], values['one_way'], share,
                values['group'])


def path_length(points: Sequence[Tuple[float, float]]) -> float:
    """Return the length [m] of the way along ``points`` ((x, y), ...)."""
    return math.fsum(math.hypot(x - a, y - b) for (a, b), (x, y) in zip(points, points[1:]))


def _check_mapping(raw: Mapping[str, Any], known: Tuple[str, ...], needed: Tuple[str, ...], where: str) -> None:
    if not isinstance(raw, dict):
        raise ConfigurationError('{}: got {}; allowed: a mapping with {}'.format(where, shown(raw), ', '.join(needed)))
    check_keys(raw, known, where, '')
    missing = [key for key in needed if key not in raw]
    if missing:
        raise ConfigurationError('{}: {} is missing; needed are {}'.format(
            where, missing[0], ', '.join(needed)))


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
