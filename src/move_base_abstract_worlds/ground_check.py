"""Check where robots, places and lanes are: not in walls, out of bounds, on one another, or where no way leads."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Sequence

from move_base_abstract.maps.way_clearance import way_clearance

from .findings import Finding, listed
from .net_check import node_place
from .ways import MOST_WAYS, alike, too_many

if TYPE_CHECKING:
    from move_base_abstract.maps.lane_map import LaneMap

    from .world import Target, World


def check_ground(world: World) -> Iterator[Finding]:
    """Yield the findings about starts, targets and nets of lanes: against the map, the bounds and one another."""
    if world.occupancy is None and any(drivers.planner is None for drivers in world.drivers):
        yield Finding('not_checked', 'map', 'robots have routes: grid, and there is no map: their ways were not looked '
                      'at', os.path.basename(world.path), 'name the map: --map MAP.yaml')
    yield from _starts_in_walls(world)
    yield from _overlaps(world)
    yield from _targets(world)
    for net in world.nets.values():
        yield from _net_in_walls(world, net)


def _starts_in_walls(world: World) -> Iterator[Finding]:
    for start in world.starts:
        settings = start.spec.settings
        if not settings.bounds.contains(settings.start):
            what = 'starts at ({:g}, {:g}), outside of world_bounds'.format(*start.xy)
        elif world.occupancy is None or not settings.values['use_map']:
            continue
        elif not world.occupancy.is_free(settings.start, settings.values['allow_unknown']):
            what = 'starts at ({:g}, {:g}), which is {} on the map'.format(
                *start.xy, world.occupancy.ground_at(*start.xy).value)
        else:
            clearance = way_clearance(world.occupancy, [start.xy])
            if clearance >= start.radius - world.occupancy.resolution:  # the clearance is known to one cell
                continue
            what = 'starts {:.2f} m from what is occupied; its radius is {:.2f} m'.format(clearance, start.radius)
        yield Finding('start_in_wall', start.spec.name, what, start.where, 'put it where it is free: start_x, start_y',
                      (start.xy,))


def _overlaps(world: World) -> Iterator[Finding]:
    """Yield a Finding for each robot whose circle overlaps that of a robot before it; it names the first such one."""
    widest = max((start.radius for start in world.starts), default=0.0)
    side = 2.0 * widest or 1.0
    cells: Dict[Any, Any] = {}
    for start in world.starts:
        x, y = start.xy
        column, row = x // side, y // side
        near = [other for dx in (-1, 0, 1) for dy in (-1, 0, 1) for other in cells.get((column + dx, row + dy), ())
                if (other.xy[0] - x) ** 2 + (other.xy[1] - y) ** 2 < (other.radius + start.radius) ** 2 * (1.0 - 1e-9)]
        if near or widest == 0.0 and start.xy in [other.xy for other in cells.get((column, row), ())]:
            other = near[0] if near else cells[column, row][0]
            yield Finding('starts_overlap', start.spec.name, 'starts at ({:g}, {:g}) on robot {}, which starts at '
                          '({:g}, {:g})'.format(x, y, other.spec.name, *other.xy), start.where,
                          'put it elsewhere: start_x, start_y, or step_x, step_y of a group', (start.xy,))
        else:  # robots on others are not compared with again: a thousand at one place give a thousand findings only
            cells.setdefault((column, row), []).append(start)


def _targets(world: World) -> Iterator[Finding]:
    """Yield a Finding for each target that is refused, or to which no way leads from some starts."""
    batteries = any(start.spec.settings.battery is not None for start in world.starts)
    targets = [target for target in world.targets if target.what != 'charger' or batteries]
    groups = [(drivers, starts) for drivers in world.drivers for starts in alike(drivers)]
    if len(targets) * len(groups) > MOST_WAYS:
        yield too_many(world, 'ways', '{} robots and {} places are'.format(len(world.starts), len(targets)))
        return
    for target in targets:
        refused: List[Any] = []
        lost: List[Any] = []
        whys: List[Any] = []
        for drivers, starts in groups:
            begin, planner = starts[0].spec.settings.start, drivers.planner
            if planner is not None and planner.corners(begin, target.pose) is None:
                names = refused if not planner.reachable(target.pose) else lost
                names += [start.spec.name for start in starts]
                whys.append(planner.refusal_of_way(begin, target.pose) or '')
        if whys:
            yield _of_target(target, 'place_in_wall' if refused else 'unreachable', refused + lost, len(world.starts),
                             whys[0])


def _of_target(target: Target, kind: str, names: Sequence[str], count: int, why: str) -> Finding:
    who = 'all robots' if len(names) == count else '{} of {} robots ({})'.format(len(names), count, listed(names, 3))
    advice = 'put it where it is free, and within world_bounds' if kind == 'place_in_wall' else (
        'add the lanes, or the gap in the wall, that are missing, or put it elsewhere')
    return Finding(kind, '{} {}'.format(target.what, target.name), 'cannot be reached by {}: {}'.format(who, why),
                   target.where, advice, (target.xy,))


def _net_in_walls(world: World, net: LaneMap) -> Iterator[Finding]:
    radius = max(start.radius for drivers in world.drivers_on(net) for start in drivers.starts)
    if world.occupancy is None:
        return
    for name, pose in net.nodes.items():
        if way_clearance(world.occupancy, [(pose.x, pose.y)]) == 0.0:
            yield Finding('node_in_wall', 'node {}'.format(name), 'lies at ({:g}, {:g}), which is occupied on the '
                          'map'.format(pose.x, pose.y), node_place(net, name), 'put it where it is free',
                          ((pose.x, pose.y),))
    for index, edge in enumerate(net.edges):
        clearance = way_clearance(world.occupancy, edge.points)
        if clearance == 0.0 or clearance < radius - world.occupancy.resolution:
            what = 'leads through what is occupied on the map' if clearance == 0.0 else (
                'comes as near as {:.2f} m to what is occupied; the radius of its robots is {:.2f} m'.format(
                    clearance, radius))
            yield Finding('node_in_wall', 'lane {} - {}'.format(edge.begin, edge.end), what, '{}: edges[{}]'.format(
                os.path.basename(net.source), index), 'lead it around, by points', (), (edge.points,))
