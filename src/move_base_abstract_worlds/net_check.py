"""Check the net of lanes: nodes that no robot reaches, dead ends, and targets off the net."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Iterator

import networkx

from move_base_abstract.maps.lane_map import NEAR
from move_base_abstract.maps.lane_planner import LaneWays

from .findings import Finding, listed

if TYPE_CHECKING:
    from move_base_abstract.maps.lane_map import LaneMap

    from .world import World


def check_net(world: World) -> Iterator[Finding]:
    """Yield the findings (:class:`.Finding`) about all nets of lanes."""
    for net in world.nets.values():
        graph = graph_of(net)
        yield from _dead_ends(net, graph)
        yield from _unreachable(world, net, graph)
        yield from _off_net(world, net)


def graph_of(net: LaneMap) -> networkx.DiGraph:
    """Return the directed graph of a LaneMap: one edge for each direction in which a lane may be driven."""
    graph = networkx.DiGraph()
    graph.add_nodes_from(net.nodes)
    for edge in net.edges:
        graph.add_edge(edge.begin, edge.end)
        if not edge.one_way:
            graph.add_edge(edge.end, edge.begin)
    return graph


def node_place(net: LaneMap, name: str) -> str:
    """Return where a node is defined, as a text: the file and the place in it."""
    return '{}: nodes[{}]'.format(os.path.basename(net.source), list(net.nodes).index(name))


def _dead_ends(net: LaneMap, graph: networkx.DiGraph) -> Iterator[Finding]:
    """Yield a Finding for each part of the net that robots can enter and never leave.

    Such a part is a strongly connected component without a lane that leads out of it.
    """
    order: Any = {name: number for number, name in enumerate(net.nodes)}
    parts = networkx.condensation(graph)
    sinks = [sorted(parts.nodes[part]['members'], key=order.get) for part in parts
             if not parts.out_degree(part) and parts.in_degree(part)]
    for names in sorted(sinks, key=lambda names: order[names[0]]):
        points = tuple((net.nodes[name].x, net.nodes[name].y) for name in names)
        what = ('no lane leads away from it: a robot that comes there stays there' if len(names) == 1 else
                'a robot that comes to these {} nodes never leaves them again'.format(len(names)))
        yield Finding('dead_end', 'node{} {}'.format('s' * (len(names) > 1), listed(names)), what,
                      node_place(net, names[0]), 'add a lane that leads away, or make one of those that lead there '
                      'two-way', points)


def _unreachable(world: World, net: LaneMap, graph: networkx.DiGraph) -> Iterator[Finding]:
    """Yield a Finding for each node to which no lanes lead from the start of some robot."""
    reached = dict.fromkeys(net.nodes, 0)
    without: Any = {name: [] for name in net.nodes}
    known = {}
    starts = [(drivers, start) for drivers in world.drivers_on(net) for start in drivers.starts]
    for drivers, start in starts:
        begins = tuple(LaneWays.on(net, drivers.settings.limits.max_speed).meeting_nodes(start.xy))
        if begins not in known:
            known[begins] = set(begins).union(*(networkx.descendants(graph, node) for node in begins))
        for name in net.nodes:
            if name in known[begins]:
                reached[name] += 1
            elif len(without[name]) < 4:
                without[name].append(start.spec.name)
    for name, count in reached.items():
        if count < len(starts):
            what = 'no lanes lead there from where robots start' if not count else (
                'no lanes lead there from the start of {} of {} robots ({})'.format(
                    len(starts) - count, len(starts), listed(without[name], 3)))
            yield Finding('unreachable', 'node {}'.format(name), what, node_place(net, name),
                          'add a lane that leads there, turn a one-way lane round, or take the node out',
                          ((net.nodes[name].x, net.nodes[name].y),))


def _off_net(world: World, net: LaneMap) -> Iterator[Finding]:
    """Yield a Finding for each target off the net: robots go straight to it from the nearest node, through anything."""
    ways = LaneWays.on(net, world.drivers_on(net)[0].settings.limits.max_speed)
    for target in world.targets:
        far = ways.distance_to(target.xy)
        if far > NEAR:
            node = ways.meeting_nodes(target.xy, to_goal=True)[0]
            yield Finding('off_net', '{} {}'.format(target.what, target.name), 'lies {:.2f} m from the nearest lane or '
                          'node: robots leave the net at node {} and go straight there, whatever lies between'.format(
                              far, node), target.where, 'put a node there, with a lane to it', (target.xy,),
                          ((target.xy, (net.nodes[node].x, net.nodes[node].y)),))
