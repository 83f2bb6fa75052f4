"""Maps of topological navigation, of L-CAS (``tmap2``) and of STRANDS (``tmap``), read as lanes.

They have nodes, and edges in one direction each. A tmap is the bare list of the nodes of a tmap2, and its edges have a
``top_vel`` in the place of a ``config``; or it is a text: for each node the lines `node:`, its name, `waypoint:` with
x, y, z, qx, qy, qz, qw, `edges:` with a node and an action each, `vertices:`. An orientation of zeros only, which these
files have, is the yaw 0. In a tmap2 of early 2021, a ``config`` is a mapping with a ``top_vel``.

The format is described at https://github.com/LCAS/topological_navigation. We use the name and the pose of a node, the
nodes to which its edges lead, and the top speed that ``config`` of an edge sets for a local planner. A node whose
``parent_frame`` is the child frame of the map's ``transformation`` is transformed into the parent frame. Actions, areas
of influence, policies and restrictions are ignored.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List, Mapping

from ..common import bounded_yaml
from ..common.errors import ConfigurationError
from ..common.input_files import open_text_input
from ..common.kinds import as_number
from ..common.shown import shown
from ..motion.geometry import Pose2D, quaternion_fault, yaw_of_quaternion

if TYPE_CHECKING:
    from ..common.type_names import StrPath

#: parts of a node in a tmap that is a text
_PARTS = ('waypoint:', 'edges:', 'vertices:')
#: the names of parameters for the top speed of a local planner
_SPEEDS = ('max_vel_x', 'max_vel_trans', 'max_trans_vel')


def is_topological_map(raw: Any) -> bool:
    """Return whether the document ``raw`` is a tmap or tmap2: each entry of its nodes has a key ``node``."""
    nodes = raw.get('nodes') if isinstance(raw, dict) else raw
    return isinstance(nodes, list) and bool(nodes) and isinstance(nodes[0], dict) and 'node' in nodes[0]


def nodes_of_text(path: StrPath) -> List[Dict[str, Any]]:
    """Return the nodes in a tmap that is a text as those of one in YAML; [] if the file does not begin like a text.

    :raises ConfigurationError: if the file cannot be read.
    """
    found: List[Dict[str, Any]] = []
    part = ''
    with open_text_input(path, bounded_yaml.FILE.size, what='file of lanes', errors='replace') as stream:
        for line in stream:
            text = line.strip()
            if line.startswith('node:'):
                found.append({'node': {'edges': []}})
                part = 'name'
            elif not found:
                break
            elif text in _PARTS:
                part = text
            elif part == 'name':
                found[-1]['node']['name'] = text
            elif part == 'waypoint:':
                numbers = [one.strip() for one in text.split(',')]
                found[-1]['node']['pose'] = {'position': dict(zip('xyz', numbers)),
                                             'orientation': dict(zip('xyzw', numbers[3:]))}
            elif part == 'edges:' and text:
                found[-1]['node']['edges'].append({'node': text.partition(',')[0].strip()})
    return found


def plain_map(raw: Any, where: str) -> Dict[str, List[Dict[str, Any]]]:
    """Return the tmap or tmap2 ``raw`` as nodes and edges in our own form.

    Of several edges to one node the first counts.

    :raises ConfigurationError: if a part of it does not have the format; the text begins with ``where``.
    """
    nodes, edges = [], []
    is_tmap = isinstance(raw, list)  # in which zeros only are no orientation
    raw = {'nodes': raw} if is_tmap else raw
    for index, entry in enumerate(raw['nodes']):
        place = '{}: nodes[{}]'.format(where, index)
        try:
            node = entry['node']
            pose = _origin(raw, node).compose(_pose(node['pose']['position'], node['pose']['orientation'], is_tmap))
            nodes.append({'name': node['name'], 'x': pose.x, 'y': pose.y, 'yaw': pose.yaw})
            edges += _edges(node)
        except (KeyError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
            raise ConfigurationError('{}: got {}, which is not a node of a topological map ({}: {})'.format(
                place, shown(entry), type(error).__name__, shown(str(error)))) from None
    return {'nodes': nodes, 'edges': edges}


def _origin(raw: Mapping[str, Any], node: Any) -> Pose2D:
    """Return the pose (Pose2D, global frame) of the frame in which the node is given."""
    transformation = raw.get('transformation')
    if not transformation or node.get('parent_frame') != transformation['child']:
        return Pose2D()
    return _pose(transformation['translation'], transformation['rotation'])


def _pose(position: Dict[str, float], orientation: Dict[str, float], may_be_zeros: bool = False) -> Pose2D:
    x, y, z, w = (as_number(orientation[axis]) for axis in 'xyzw')
    quaternion = x, y, z, w
    fault = quaternion_fault(quaternion) if any(quaternion) or not may_be_zeros else ''
    if fault:
        raise ValueError(fault)
    return Pose2D(as_number(position['x']), as_number(position['y']), yaw_of_quaternion(quaternion))


def _edges(node: Dict[str, Any]) -> List[Dict[str, Any]]:
    edges: Dict[Any, Any] = {}
    for edge in node.get('edges') or ():
        config = edge.get('config') or ()
        has_top_vel = edge
        if isinstance(config, dict):  # a tmap2 of early 2021
            has_top_vel, config = config, ()
        speeds = [as_number(entry['value']) for entry in config if entry['name'] in _SPEEDS]
        top_vel = as_number(has_top_vel.get('top_vel') or 0.0)
        speeds += [top_vel] if top_vel > 0.0 else []  # others mean the default of who follows the edge
        speed = {'speed': min(speeds)} if speeds else {}
        edges.setdefault(edge['node'], {'from': node['name'], 'to': edge['node'], 'one_way': True, **speed})
    return list(edges.values())
