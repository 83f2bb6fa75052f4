"""Find places that bar ways when a robot stands there, and robots that cannot pass each other.

In a well-formed infrastructure (Cap, Vokrinek, Kleiner 2015) there is a way between any two places where robots may
stop that leads through no third one. Then every robot can come to its goal, whoever stands at the others. The places
here are the nodes at which robots start, work or charge, or to which files send them. A node bars ways only if it can
be full. Two robots can pass each other if they alone can exchange their starts: an exact search over their joint
places says so (:mod:`.traffic.joint_search`).
"""
from __future__ import annotations

import itertools
import os
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Sequence, Tuple

import networkx

from move_base_abstract.traffic.joint_search import Net, TooManyStates, find_moves

from .capacity_check import Areas
from .findings import Finding, listed
from .net_check import graph_of, node_place

if TYPE_CHECKING:
    from move_base_abstract.maps.lane_map import LaneMap
    from move_base_abstract.traffic.lane_places import LanePlaces

    from .world import World

_MOST_PLACES = 300  # the time goes with the square of their number
_MOST_PAIRS = 500  # pairs of robots
_MOST_STATES = 20_000  # joint places of two robots


def check_passing(world: World) -> Iterator[Finding]:
    """Yield a :class:`.Finding` for each place that bars ways, and for each two robots that cannot pass each other."""
    areas = Areas(world)
    for net in world.nets.values():
        places = areas.lane_places(net)
        starts = {start.spec.name: places.node_at(*start.xy) for drivers in world.drivers_on(net)
                  for start in drivers.starts}
        ends = dict.fromkeys(node for node in [*starts.values(), *(places.node_at(*target.xy)
                                                                   for target in world.targets)] if node is not None)
        if not any(places.areas.values()):
            continue  # robots that stand are in nobody's way, and pass one another at any node
        if len(ends) > _MOST_PLACES:
            yield Finding('not_checked', 'ways past places', 'robots may stop at {} nodes, more than {}'.format(
                len(ends), _MOST_PLACES), os.path.basename(net.source), 'check a part of the net')
        else:
            yield from _bars(net, places, list(ends), len(starts))
        if places.same:
            yield Finding('not_checked', 'robots that pass', 'nodes {} and {} are at one point, so nobody can tell at '
                          'which of them a robot is; for the same reason deadlock: avoid searches no way out of '
                          'jams'.format(*places.same), node_place(net, places.same[0]), 'one node for both')
            continue
        yield from _pairs(world, net, places, {name: node for name, node in starts.items() if node is not None})


def _bars(net: LaneMap, places: LanePlaces, ends: Sequence[str], robots: int) -> Iterator[Finding]:
    """Yield a Finding for each of ``ends`` that bars the way between others when it is full."""
    graph = graph_of(net)
    barring = {node for node in ends if any(area.capacity < robots for area in places.areas[node])}  # type: ignore[operator]
    open_nodes = {node: True for node in graph if node not in barring}
    barred: Dict[str, List[Tuple[str, str]]] = {}
    for begin in ends:
        weights = {node: 0 if node in open_nodes or node == begin else 1 for node in graph}
        paths = networkx.single_source_dijkstra_path(graph, begin, weight=lambda _one, other, _, w=weights: w[other])
        for end in ends:
            for node in paths.get(end, [])[1:-1]:
                if node in barring and node != end:
                    barred.setdefault(node, []).append((begin, end))
    for node in (node for node in ends if node in barred):
        pairs = barred[node]
        begin, end = pairs[0]
        yield Finding(
            'bars_ways', 'node {}'.format(node), 'a robot that stands here bars the way from {} to {}{}: no '
            'other way leads past the places where robots stop'.format(
                begin, end, '' if len(pairs) == 1 else ' (and {} more)'.format(len(pairs) - 1)),
            node_place(net, node), 'a lane round it, a node of its own beside the way for those who stop, or more room',
            ((net.nodes[node].x, net.nodes[node].y),), (_line(net, graph, begin, end),))


def _pairs(world: World, net: LaneMap, places: LanePlaces, starts: Dict[str, str]) -> Iterator[Finding]:
    """Yield a Finding for each two robots that cannot exchange their ``starts`` {robot: node}, even alone.

    Where one of the starts has room for both, they can: one after the other drives the whole way.
    """
    graph = graph_of(net)
    on_net = Net(places.areas, places.steps, {area: area.capacity or 0 for areas in [
        *places.areas.values(), *places.on_edges] for area in areas})
    known: Dict[Any, bool] = {}
    tight = {name: node for name, node in starts.items()
             if any((area.capacity or 0) < 2 for area in places.areas[node])}
    pairs = [pair for pair in itertools.combinations(tight.items(), 2) if pair[0][1] != pair[1][1]]
    for (one, begin), (other, end) in pairs[:_MOST_PAIRS]:
        if not (networkx.has_path(graph, begin, end) and networkx.has_path(graph, end, begin)):
            continue
        key = tuple(sorted((begin, end)))
        if key not in known:
            try:
                known[key] = find_moves(on_net, (begin, end), (end, begin), _MOST_STATES) is not None
            except TooManyStates:
                known[key] = True
                yield Finding('not_checked', 'robots {} and {}'.format(one, other), 'whether they can pass each other: '
                              'there are more than {} joint places'.format(_MOST_STATES), node_place(net, begin),
                              'check a part of the net')
        if not known[key]:
            wheres = {start.spec.name: start.where for start in world.starts}
            yield Finding(
                'cannot_pass', 'robots {} and {}'.format(one, other), 'they cannot pass each other between {} and {}, '
                'even if no other robot is there'.format(begin, end), listed([wheres[one], wheres[other]]),
                'a siding between them (a node with a lane of its own), a second way, or more room at a node',
                ((net.nodes[begin].x, net.nodes[begin].y), (net.nodes[end].x, net.nodes[end].y)),
                (_line(net, graph, begin, end),))
    if len(pairs) > _MOST_PAIRS:
        yield Finding('not_checked', 'robots that pass', 'the first {} of {} pairs of robots were looked at'.format(
            _MOST_PAIRS, len(pairs)), os.path.basename(world.path), 'check a part of the fleet')


def _line(net: LaneMap, graph: networkx.DiGraph, begin: str, end: str) -> Tuple[Tuple[float, float], ...]:
    """Return the nodes of a shortest way ((x, y), ...) [m]."""
    return tuple((net.nodes[node].x, net.nodes[node].y) for node in networkx.shortest_path(graph, begin, end))
