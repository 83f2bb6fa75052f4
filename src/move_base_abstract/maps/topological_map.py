"""Maps of the topological navigation of L-CAS (``tmap2``), read as lanes: nodes, and edges in one direction each.

The format is described at https://github.com/LCAS/topological_navigation. We use the name and the pose of a node, the
nodes to which its edges lead, and the top speed that ``config`` of an edge sets for a local planner. A node whose
``parent_frame`` is the child frame of the map's ``transformation`` is transformed into the parent frame. Actions, areas
of influence, policies and restrictions are ignored.
"""
from __future__ import annotations

from typing import Any, Dict, List, Mapping

from ..common.errors import ConfigurationError
from ..common.kinds import as_number
from ..common.shown import shown
from ..motion.geometry import Pose2D, quaternion_fault, yaw_of_quaternion

#: the names of parameters for the top speed of a local planner
_SPEEDS = ('max_vel_x', 'max_vel_trans', 'max_trans_vel')


def is_topological_map(raw: Mapping[str, Any]) -> bool:
    """Return whether the document ``raw`` is a tmap2: each entry of its nodes has a key ``node``."""
    nodes = raw.get('nodes') if isinstance(raw, dict) else None
    return isinstance(nodes, list) and bool(nodes) and isinstance(nodes[0], dict) and 'node' in nodes[0]


def plain_map(raw: Mapping[str, Any], where: str) -> Dict[str, List[Dict[str, Any]]]:
    """Return the tmap2 ``raw`` as nodes and edges in our own form; of several edges to one node the first counts.

    :raises ConfigurationError: if a part of it does not have the format; the text begins with ``where``.
    """
    nodes, edges = [], []
    for index, entry in enumerate(raw['nodes']):
        place = '{}: nodes[{}]'.format(where, index)
        try:
            node = entry['node']
            pose = _origin(raw, node).compose(_pose(node['pose']['position'], node['pose']['orientation']))
            nodes.append({'name': node['name'], 'x': pose.x, 'y': pose.y, 'yaw': pose.yaw})
            edges += _edges(node)
        except (KeyError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
            raise ConfigurationError('{}: got {}, which is not a node of a tmap2 ({}: {})'.format(
                place, shown(entry), type(error).__name__, shown(str(error)))) from None
    return {'nodes': nodes, 'edges': edges}


def _origin(raw: Mapping[str, Any], node: Any) -> Pose2D:
    """Return the pose (Pose2D, global frame) of the frame in which the node is given."""
    transformation = raw.get('transformation')
    if not transformation or node.get('parent_frame') != transformation['child']:
        return Pose2D()
    return _pose(transformation['translation'], transformation['rotation'])


def _pose(position: Dict[str, float], orientation: Dict[str, float]) -> Pose2D:
    x, y, z, w = (as_number(orientation[axis]) for axis in 'xyzw')
    quaternion = x, y, z, w
    fault = quaternion_fault(quaternion)
    if fault:
        raise ValueError(fault)
    return Pose2D(as_number(position['x']), as_number(position['y']), yaw_of_quaternion(quaternion))


def _edges(node: Dict[str, Any]) -> List[Dict[str, Any]]:
    edges: Dict[Any, Any] = {}
    for edge in node.get('edges') or ():
        speeds = [as_number(entry['value']) for entry in edge.get('config') or () if entry['name'] in _SPEEDS]
        speed = {'speed': min(speeds)} if speeds else {}
        edges.setdefault(edge['node'], {'from': node['name'], 'to': edge['node'], 'one_way': True, **speed})
    return list(edges.values())
