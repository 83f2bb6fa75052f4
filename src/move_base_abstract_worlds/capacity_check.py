"""Capacities that can lock: circles of zones and lanes whose robots may all wait for the next one, for ever.

A robot that waits at the border of an area keeps its place in those that it comes out of (:mod:`.traffic.control`). So
there is an arrow from area to area wherever a way of some robot comes into the second one before it has left the
first. Robots wait for one another for ever only where full areas lie in a circle of arrows; the fewest robots that
do it are the least sum of capacities over such a circle. Where all who would wait are in one more area, which has
place for fewer, it cannot be: such an area is a guard. With ``blocks`` a robot asks for room in areas farther ahead,
too. Then the last one that came into a circle was let in though its next area there was full, so that it cannot have
looked for room in it: at least one arrow of a circle must be of that kind.
"""
import os

import networkx

from move_base_abstract.maps.lane_planner import NEAR
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.traffic.area import Area
from move_base_abstract.traffic.outline import BORDER
from move_base_abstract.traffic.rules import DeadlockPolicy
from move_base_abstract.traffic.safe_states import needs_of
from move_base_abstract.traffic.way import ZoneIndex, crossings, stays_on_lanes, with_groups

from .findings import Finding
from .ways import MOST_WAYS, leg_between

_MOST_CIRCLES = 5_000
_SLACK = 0.01  # m, by which boxes are larger than what they hold


def check_capacities(world):
    """Yield one :class:`.Finding` for each set of areas that hang together by circles: the least of these."""
    areas = Areas(world)
    arrows = networkx.DiGraph()
    arrows.add_nodes_from(areas.all)
    for drivers in world.drivers if world.scenario.traffic.policy is not DeadlockPolicy.AVOID and areas.touch() else ():
        if drivers.planner is None:
            continue
        pairs = list(dict.fromkeys(_pairs(world, drivers, areas.has_zones or world.scenario.traffic.blocks > 1)))
        if len(pairs) > MOST_WAYS:
            yield Finding('not_checked', 'capacities', 'robots with zones that have a capacity, or with blocks, have {} '
                          'ways between nodes, starts and places, more than {}'.format(len(pairs), MOST_WAYS),
                          os.path.basename(world.path), 'check a scenario with fewer of them')
            pairs = []
        for begin, end in pairs:
            for one, other, held, late in areas.arrows(drivers, begin, end):
                known = arrows.edges[one, other] if arrows.has_edge(one, other) else {'held': held, 'late': False}
                arrows.add_edge(one, other, held=known['held'] & held, late=known['late'] or late)
    for area_numbers in _parts(arrows):
        yield from _least_circle(world, areas, arrows, area_numbers)


class Areas:
    """All zones, lanes and groups of a World in which robots have places; known by their numbers in ``all``.

    In ``all`` are those that may keep robots waiting: not those with room for as many robots as their group.
    """

    def __init__(self, world):
        self._file, self._rules = os.path.basename(world.path), world.scenario.traffic
        self._areas, self._wheres, self._ways = [], [], []
        self._groups = {}
        zones = []
        for index, zone in enumerate(world.scenario.zones):
            line = (*zone.outline.points, zone.outline.points[0])
            group = self._group(zone.group, line)
            zones.append(self._add(Area('zone', zone.name, zone.capacity, zone.outline, group),
                                   '{}: zones[{}]'.format(self._file, index), line))
        self._index = ZoneIndex(zones)
        self._lanes = {}
        for source, net in world.nets.items():
            for index, edge in enumerate(net.edges):
                if edge.is_counted:
                    self._lanes[source, index] = self._add(
                        Area('lane', '{} - {}'.format(edge.begin, edge.end), edge.capacity, None,
                             self._group(edge.group, edge.points)),
                        '{}: edges[{}]'.format(os.path.basename(source), index), edge.points)
        self._numbers = {area: number for number, area in enumerate(self._areas)}
        self.all = [number for area, number in self._numbers.items() if area.capacity is not None and (
            area.group is None or area.capacity < area.group.capacity)]
        self._counted = frozenset(self.all)
        #: whether any zone may keep robots waiting
        self.has_zones = any(area.outline is not None for area in (self._areas[number] for number in self.all)) or any(
            zone.group is not None for zone in world.scenario.zones)

    def _add(self, area, where, line):
        self._areas.append(area)
        self._wheres.append(where)
        self._ways.append(line)
        return area

    def _group(self, name, line):
        if name is None:
            return None
        if name not in self._groups:
            self._groups[name] = self._add(Area('group', name, self._rules.groups.get(name, 1)),
                                           '{}: groups'.format(self._file), line)
        return self._groups[name]

    def touch(self):
        """Return whether any two of them may touch: else nobody comes from one into another."""
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

    def capacity(self, number):
        """Return for how many robots there is place."""
        return self._areas[number].capacity

    def name(self, number):
        """Return the name of an area, as 'zone gate'."""
        return self._areas[number].name

    def where(self, number):
        """Return where in which file it is said."""
        return self._wheres[number]

    def way(self, number):
        """Return its line ((x, y), ...) [m]: the lane, or the border of the zone."""
        return self._ways[number]

    def arrows(self, drivers, begin, end):
        """Return [(area, area, held, late), ...] of a way (x, y) to (x, y): who is in the first asks for the second.

        ``held``: all areas in which it is then (frozenset of numbers); ``late``: it has not looked for room in the
        second one when it came into the first.
        """
        leg = leg_between(drivers, Pose2D(*begin), Pose2D(*end))
        if leg is None or not leg.distance > BORDER:
            return []
        stays = list(self._index.stays(leg.way))
        at_rest = [stay.area for stay in stays if stay.begin <= BORDER and stay.area.outline.contains(*begin)]
        if drivers.lanes is not None:
            on_lanes = stays_on_lanes(leg, lambda edge: self._lanes.get((drivers.lanes.source, edge)))
            is_at_node = any(abs(pose.x - begin[0]) <= NEAR and abs(pose.y - begin[1]) <= NEAR
                             for pose in drivers.lanes.nodes.values())
            at_rest += [stay.area for stay in on_lanes if stay.begin <= BORDER and not is_at_node]
            stays += on_lanes  # who ended its goal before on a lane has its place still
        held = dict.fromkeys([*at_rest, *(area.group for area in at_rest if area.group is not None)], True)
        return list(self._arrows_along(crossings(with_groups(stays), held), held))

    def _arrows_along(self, ahead, held):
        """Yield the arrows of who comes to the crossings ``ahead`` with places in ``held``, as a Traveller does."""
        blocks = self._rules.blocks
        seen = dict.fromkeys(held, ())  # for room in which areas it looked when it came in
        for number, crossing in enumerate(ahead):
            enters = [area for area in crossing.enters if area not in held]
            wanted = list(enters)
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


def _pairs(world, drivers, takes_all):
    """Yield ((x, y), (x, y)) of the ways that show all arrows of robots between nodes, starts and targets.

    On lanes alone ways over two lanes do: of a longer way each part is a way of the planner, too, also where several
    are equally short. What lies on a lane stands for itself. With zones and blocks all ways are needed (``takes_all``).
    """
    others = dict.fromkeys([start.xy for start in drivers.starts] + [target.xy for target in world.targets])
    nodes = {} if drivers.lanes is None else {(pose.x, pose.y): name for name, pose in drivers.lanes.nodes.items()}
    if takes_all:
        ends = [*nodes, *others]
        yield from ((begin, end) for begin in ends for end in ends if begin != end)
        return
    if drivers.lanes is not None and drivers.lanes.has_capacities:
        after = {}
        for edge in drivers.lanes.edges:
            for begin, end in [(edge.begin, edge.end)] + [(edge.end, edge.begin)] * (not edge.one_way):
                after.setdefault(begin, []).append(end)
        places = {name: xy for xy, name in nodes.items()}
        for begin, middle in ((begin, middle) for begin, ends in after.items() for middle in ends):
            yield from ((places[begin], places[end]) for end in after.get(middle, ())
                        if begin != end and begin in places and end in places)
        for other in others:
            if other not in nodes:
                yield from ((pair for node in [*nodes, *others] for pair in ((other, node), (node, other))
                             if node != other))


def _parts(arrows):
    """Return the sets of areas that hang together by circles, each sorted, by their first areas."""
    return sorted(sorted(part) for part in networkx.strongly_connected_components(arrows) if len(part) > 1)


def _least_circle(world, areas, arrows, part):
    """Yield the Finding of the least circle in a part, if there are as many robots as it takes, and no guard."""
    graph = arrows.subgraph(part)
    best, circle = len(world.starts) + 1, None
    is_guarded = False
    for begin in part:
        left = best - areas.capacity(begin) - 1  # what all others may sum up to, to be less
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
    if circle is None and is_guarded:  # the shortest circles cannot be: any other one?
        circle, is_over = _any_circle(areas, graph, len(world.starts))
        if is_over:
            yield Finding('not_checked', 'capacities', 'of the circles among {} zones and lanes the first {} cannot '
                          'lock, more were not looked at'.format(len(part), _MOST_CIRCLES), areas.where(part[0]),
                          'take fewer zones and lanes with a capacity')
    if circle is None:
        return
    best = _sum(areas, circle)
    names = [areas.name(number) for number in circle]
    shown = names if len(names) <= 8 else names[:7] + ['... {} more'.format(len(names) - 7)]
    yield Finding(
        'can_lock', names[0], '{} robots can lock up for good: in {}, and from there in {} again, each robot waits for '
        'the next. It is the least of the circles among {} zones and lanes'.format(
            best, ' -> '.join(shown), names[0], len(part)),
        areas.where(circle[0]), 'more room on one of them, one-way lanes, a zone around all of them with capacity {}, '
        'deadlock: avoid, or a coordinator that sends fewer robots there'.format(best - 1), (),
        tuple(areas.way(one) for one in circle))


def _sum(areas, circle):
    return sum(areas.capacity(number) for number in circle)


def _is_possible(areas, graph, circle):
    """Return whether the last robot comes in, and no guard keeps so many robots out as it takes to fill a circle."""
    if not any(graph.edges[one, other]['late'] for one, other in zip(circle, circle[1:] + circle[:1])):
        return False
    held = [graph.edges[one, other]['held'] for one, other in zip(circle, circle[1:] + circle[:1])]
    guards = frozenset.intersection(*held) - frozenset(circle)
    return all(areas.capacity(guard) >= _sum(areas, circle) for guard in sorted(guards))


def _any_circle(areas, graph, most):
    """Return (a circle that is possible with ``most`` robots, or None; whether there were too many to look at)."""
    for number, circle in enumerate(networkx.simple_cycles(graph)):
        if number == _MOST_CIRCLES:
            return None, True
        if _sum(areas, circle) <= most and _is_possible(areas, graph, circle):
            return circle, False
    return None, False
