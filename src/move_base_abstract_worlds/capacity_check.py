"""Find capacities that can lock: circles of areas in which each robot waits for room in the next one, for ever.

Areas are zones, lanes and nodes with a capacity, and groups.

A robot that waits at the border of an area keeps its room in the areas that it leaves (:mod:`.traffic.control`). So
there is an arrow from one area to another if the way of some robot enters the second one before it has left the first.
Robots can wait for one another for ever only if full areas form a circle of arrows. The fewest robots that can do so
are the least sum of capacities over such a circle. It cannot happen if all these robots would be in one more area that
has room for fewer robots: such an area is a guard. With ``blocks``, a robot asks for room in areas farther ahead, too.
Then the last robot that came into a circle was let in although its next area there was full. So it has not asked for
room in that area, and at least one arrow of a circle must be of that kind (``late``).
"""
from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING, Any, Dict, FrozenSet, Iterator, List, Optional, Sequence, Tuple

import networkx

from move_base_abstract.maps.lane_map import NEAR
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.traffic.area import Area
from move_base_abstract.traffic.lane_places import LanePlaces
from move_base_abstract.traffic.nodes import NodeAreas
from move_base_abstract.traffic.outline import BORDER
from move_base_abstract.traffic.rules import DeadlockPolicy
from move_base_abstract.traffic.safe_states import needs_of
from move_base_abstract.traffic.way import ZoneIndex, crossings, stays_of, with_groups

from .findings import Finding
from .ways import MOST_WAYS, leg_between, too_many

if TYPE_CHECKING:
    from move_base_abstract.maps.lane_map import LaneMap
    from move_base_abstract.traffic.way import Crossing, Stay

    from .world import Drivers, World

_MOST_CIRCLES = 5_000
_MOST_LANES = 3_000  # the time goes with the square of their number, 10 s for these
_SLACK = 0.01  # m; boxes are larger than their content by this much


def check_capacities(world: World) -> Iterator[Finding]:
    """Yield one :class:`.Finding` for each set of areas that circles connect: the circle with the fewest robots."""
    areas = Areas(world)
    arrows = networkx.DiGraph()
    arrows.add_nodes_from(areas.all)
    rules = world.scenario.traffic
    for drivers in world.drivers if rules.policy is not DeadlockPolicy.AVOID and areas.touch() else ():
        if drivers.planner is None:
            continue
        if drivers.lanes is not None and len(drivers.lanes.edges) > _MOST_LANES:
            yield Finding('not_checked', 'capacities', 'the net has {} lanes; capacities are checked on at most '
                          '{}'.format(len(drivers.lanes.edges), _MOST_LANES), os.path.basename(drivers.lanes.source),
                          'check a part of the net')
            continue
        pairs = list(dict.fromkeys(_pairs(world, drivers, areas.has_zones or rules.blocks > 1)))
        if len(pairs) > MOST_WAYS:
            yield too_many(world, 'capacities', 'robots with zones that have a capacity, or with blocks, have {} ways '
                           'between nodes, starts and places,'.format(len(pairs)))
            pairs = []
        for begin, end in pairs:
            for one, other, held, late in areas.arrows(drivers, begin, end):
                known = arrows.edges[one, other] if arrows.has_edge(one, other) else {'held': held, 'late': False}
                arrows.add_edge(one, other, held=known['held'] & held, late=known['late'] or late)
    for area_numbers in _parts(arrows):
        yield from _least_circle(world, areas, arrows, area_numbers)


class Areas:
    """The zones, lanes, nodes and groups of a World in which robots are counted. Each has a number.

    ``all`` has the numbers of those that can make robots wait, so not of those with as much room as their group.
    """

    def __init__(self, world: World) -> None:
        self._file, self._rules = os.path.basename(world.path), world.scenario.traffic
        self._areas: List[Any] = []
        self._wheres: List[Any] = []
        self._ways: List[Any] = []
        self._groups: Dict[Any, Any] = {}
        zones = []
        for index, zone in enumerate(world.scenario.zones):
            line = (*zone.outline.points, zone.outline.points[0])
            group = self._group(zone.group, line)
            zones.append(self._add(Area('zone', zone.name, zone.capacity, zone.outline, group),
                                   '{}: zones[{}]'.format(self._file, index), line))
        self._index = ZoneIndex(zones)
        self._nodes = {source: {(pose.x, pose.y) for pose in net.nodes.values()} for source, net in world.nets.items()}
        self._lanes = {}
        self._places = {source: NodeAreas(net) for source, net in world.nets.items()}
        for source, net in world.nets.items():
            for index, edge in enumerate(net.edges):
                if edge.is_counted:
                    self._lanes[source, index] = self._add(
                        Area('lane', '{} - {}'.format(edge.begin, edge.end), edge.capacity, None,
                             self._group(edge.group, edge.points)),
                        '{}: edges[{}]'.format(os.path.basename(source), index), edge.points)
            for index, (name, pose) in enumerate(net.nodes.items()):
                if name in net.capacities:
                    self._add(self._places[source].areas[name],
                              '{}: nodes[{}]'.format(os.path.basename(source), index), [(pose.x, pose.y)] * 2)
        self._numbers = {area: number for number, area in enumerate(self._areas)}
        self.all = [number for area, number in self._numbers.items() if area.capacity is not None and (
            area.group is None or area.capacity < area.group.capacity)]
        self._counted = frozenset(self.all)
        #: whether any zone can make robots wait
        self.has_zones = any(area.outline is not None for area in (self._areas[number] for number in self.all)) or any(
            zone.group is not None for zone in world.scenario.zones)

    def _add(self, area: Area, where: str, line: Sequence[Tuple[float, float]]) -> Area:
        self._areas.append(area)
        self._wheres.append(where)
        self._ways.append(line)
        return area

    def _group(self, name: Optional[str], line: Sequence[Tuple[float, float]]) -> Optional[Area]:
        if name is None:
            return None
        if name not in self._groups:
            self._groups[name] = self._add(Area('group', name, self._rules.groups.get(name, 1)),
                                           '{}: groups'.format(self._file), line)
        return self._groups[name]

    def lane_places(self, net: LaneMap) -> LanePlaces:
        """Return the nodes of a net as places of robots."""
        return LanePlaces(net, self._index, self._places[net.source],
                          lambda edge: self._lanes.get((net.source, edge)))

    def touch(self) -> bool:
        """Return whether any two areas may touch. If none do, no robot comes from one into another.

        A node's area reaches along all lanes that lead to it.
        """
        if any(area.point is not None for area in self._areas):
            return True
        boxes = []
        for way, area in zip(self._ways, self._areas):
            if area.capacity is None and area.group is None:
                continue
            xs, ys = zip(*way)
            boxes.append((min(xs) - _SLACK, min(ys) - _SLACK, max(xs) + _SLACK, max(ys) + _SLACK))
        boxes.sort()
        for number, (_, low, right, high) in enumerate(boxes):
            for other in boxes[number + 1:]:
                if other[0] > right:
                    break
                if other[1] <= high and other[3] >= low:
                    return True
        return False

    def capacity(self, number: int) -> int:
        """Return the number of robots for which an area has room."""
        return self._areas[number].capacity

    def name(self, number: int) -> str:
        """Return the name of an area, such as 'zone gate'."""
        return self._areas[number].name

    def where(self, number: int) -> str:
        """Return where an area is defined: the file and the place in it."""
        return self._wheres[number]

    def way(self, number: int) -> Tuple[Tuple[float, float], ...]:
        """Return the line of an area, ((x, y), ...) [m]: the lane, or the border of the zone."""
        return self._ways[number]

    def arrows(self, drivers: Any, begin: Tuple[float, float],
               end: Tuple[float, float]) -> List[Tuple[int, int, FrozenSet[int], bool]]:
        """Return the arrows of a way from (x, y) to (x, y): [(area, area, held, late), ...].

        A robot in the first area asks for room in the second one. ``held``: all areas in which it is then (frozenset of
        numbers); ``late``: whether it did not ask for room in the second one when it came into the first.
        """
        leg = leg_between(drivers, Pose2D(*begin), Pose2D(*end))
        if leg is None or not leg.distance > BORDER:
            return []
        net, at_rest = drivers.lanes, []
        stays: Sequence[Stay] = self._index.stays(leg.way)
        if net is not None:
            places = self._places[net.source]
            stays = stays_of(leg, self._index, lambda edge: self._lanes.get((net.source, edge)), places)
            at_rest = places.at(*begin)
        is_at_node = bool(at_rest) or net is not None and any(
            math.dist(begin, node) <= NEAR for node in self._nodes[net.source])
        # a robot that ended its last goal on a lane still has its room there
        at_rest += [stay.area for stay in stays if stay.begin <= BORDER and stay.area.point is None and (
            not is_at_node if stay.area.outline is None else stay.area.outline.contains(*begin))]
        held = dict.fromkeys([*at_rest, *(area.group for area in at_rest if area.group is not None)], True)
        return list(self._arrows_along(crossings(with_groups(stays), held), held))

    def _arrows_along(self, ahead: Sequence[Crossing],
                      held: Dict[Any, Any]) -> Iterator[Tuple[int, int, FrozenSet[int], bool]]:
        """Yield the arrows of a robot with room in ``held`` that comes to the crossings ``ahead``, as a Traveller."""
        blocks = self._rules.blocks
        seen = dict.fromkeys(held, ())  # {area: those in which the robot asked for room when it came in}
        for number, crossing in enumerate(ahead):
            enters = [area for area in crossing.enters if area not in held]
            for area in crossing.leaves_anyway():
                held.pop(area, None)
            wanted: Any = list(enters)
            if enters and blocks > 1:
                wanted += [area for area in needs_of(ahead[number:], held)
                           if area not in held and area not in enters][:max(0, blocks - len(enters))]
            counted = frozenset(self._numbers[area] for area in held) & self._counted
            for one in held:
                for other in wanted:
                    if self._numbers[one] in counted and self._numbers[other] in self._counted:
                        yield self._numbers[one], self._numbers[other], counted, other not in seen[one]
            for area in enters:
                held[area], seen[area] = True, wanted
            for area in crossing.leaves:
                held.pop(area, None)


def _pairs(world: World, drivers: Drivers,
           takes_all: bool) -> Iterator[Tuple[Tuple[float, float], Tuple[float, float]]]:
    """Yield the ends ((x, y), (x, y)) of ways that together show all arrows between nodes, starts and targets.

    With lanes alone, ways over two lanes are enough, because each part of a longer way is a way of the planner, too,
    also if several are equally short. If nodes have a capacity, ways over one lane lead from one area to another, too.
    Starts and targets on a lane need ways of their own. With zones or blocks (``takes_all``), all ways are needed.
    """
    others = dict.fromkeys([start.xy for start in drivers.starts] + [target.xy for target in world.targets])
    nodes = {} if drivers.lanes is None else {(pose.x, pose.y): name for name, pose in drivers.lanes.nodes.items()}
    if takes_all:
        ends = [*nodes, *others]
        yield from ((begin, end) for begin in ends for end in ends if begin != end)
        return
    if drivers.lanes is not None and drivers.lanes.has_capacities:
        after: Dict[Any, Any] = {}
        for edge in drivers.lanes.edges:
            for begin, end in [(edge.begin, edge.end)] + [(edge.end, edge.begin)] * (not edge.one_way):
                after.setdefault(begin, []).append(end)
        places = {name: xy for xy, name in nodes.items()}
        for begin, middle in ((begin, middle) for begin, ends in after.items() for middle in ends):
            if drivers.lanes.capacities and begin in places and middle in places:
                yield places[begin], places[middle]
            yield from ((places[begin], places[end]) for end in after.get(middle, ())
                        if begin != end and begin in places and end in places)
        for other in others:
            if other not in nodes:
                yield from ((pair for node in [*nodes, *others] for pair in ((other, node), (node, other))
                             if node != other))


def _parts(arrows: networkx.DiGraph) -> List[List[int]]:
    """Return the sets of areas that circles connect, each sorted, in the order of their first areas."""
    return sorted(sorted(part) for part in networkx.strongly_connected_components(arrows) if len(part) > 1)


def _least_circle(world: World, areas: Areas, arrows: networkx.DiGraph, part: Sequence[int]) -> Iterator[Finding]:
    """Yield the Finding of the least circle in a part, if there are enough robots for it, and no guard."""
    graph = arrows.subgraph(part)
    best, circle = len(world.starts) + 1, None
    is_guarded = False
    for begin in part:
        left = best - areas.capacity(begin) - 1  # the sum of all others must not be larger than this
        if left < 0:
            continue
        sums, paths = networkx.single_source_dijkstra(graph, begin, cutoff=left,
                                                      weight=lambda _one, other, _: areas.capacity(other))
        for total, end in sorted((sums[end], end) for end in graph.predecessors(begin)
                                 if end in sums and graph.edges[end, begin]['late']):
            if _is_possible(areas, graph, paths[end]):
                best, circle = total + areas.capacity(begin), paths[end]
                break
            is_guarded = True
    if circle is None and is_guarded:  # the shortest circles cannot lock; another one may
        circle, is_over = _any_circle(areas, graph, len(world.starts))
        if is_over:
            yield Finding('not_checked', 'capacities', 'of the circles among {} zones, lanes and nodes the first {} '
                          'cannot lock, more were not looked at'.format(len(part), _MOST_CIRCLES), areas.where(part[0]),
                          'take fewer of them with a capacity')
    if circle is None:
        return
    best = _sum(areas, circle)
    names = [areas.name(number) for number in circle]
    shown = names if len(names) <= 8 else names[:7] + ['... {} more'.format(len(names) - 7)]
    yield Finding(
        'can_lock', names[0], '{} robots can lock up for good: in {}, and from there in {} again, each robot waits for '
        'the next. It is the least of the circles among {} zones, lanes and nodes'.format(
            best, ' -> '.join(shown), names[0], len(part)),
        areas.where(circle[0]), 'more room on one of them, one-way lanes, a zone around all of them with capacity {}, '
        'deadlock: avoid, or a coordinator that sends fewer robots there'.format(best - 1), (),
        tuple(areas.way(one) for one in circle))


def _sum(areas: Areas, circle: Sequence[int]) -> int:
    return sum(areas.capacity(number) for number in circle)


def _is_possible(areas: Areas, graph: networkx.DiGraph, circle: Any) -> bool:
    """Return whether a circle can fill: its last robot is let in, and no guard keeps out robots that it needs."""
    if not any(graph.edges[one, other]['late'] for one, other in zip(circle, circle[1:] + circle[:1])):
        return False
    held = [graph.edges[one, other]['held'] for one, other in zip(circle, circle[1:] + circle[:1])]
    guards = frozenset.intersection(*held) - frozenset(circle)
    return all(areas.capacity(guard) >= _sum(areas, circle) for guard in sorted(guards))


def _any_circle(areas: Areas, graph: networkx.DiGraph, most: int) -> Tuple[None, bool]:
    """Return (a circle that can fill with ``most`` robots, or None; whether there were too many circles to try)."""
    for number, circle in enumerate(networkx.simple_cycles(graph)):
        if number == _MOST_CIRCLES:
            return None, True
        if _sum(areas, circle) <= most and _is_possible(areas, graph, circle):
            return circle, False
    return None, False
