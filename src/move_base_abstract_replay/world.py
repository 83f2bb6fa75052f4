"""The world of a scenario for the page: zones, lanes, nodes, places, and where robots stand at first."""
from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple, Union

from move_base_abstract.maps.lane_map import LaneMap
from move_base_abstract.scenario import read_scenario

from .recording import ReplayError

if TYPE_CHECKING:
    from move_base_abstract.motion.geometry import Pose2D

    from .recording import Recording

_BESIDE = 'scenario.yaml'  # beside a log
_MAP = 'map.yaml'  # beside a scenario
_MOST_THINGS = 20_000
#: (x_min, y_min, x_max, y_max) [m]
Box = Tuple[float, float, float, float]


class Start(NamedTuple):
    """Where a robot stands at first, and its BatterySettings or None."""

    pose: Pose2D
    battery: Any


@dataclass
class World:
    """The world that the page shows.

    ``things``: zones, lanes, nodes with a capacity (their points: their own one, then the spots) and places as
    dictionaries for the page, a zone's ``max_speed`` [m/s, 0: none] as at the start; ``levels``: the states of charge
    of the scenario's dispatcher at or below which a charge is ('critical') and from which on it is ('good'), {}: the
    scenario has none; ``nodes``: [name, x, y] of the lanes' nodes [m];
    ``starts``: {robot: Start}; ``currents``: {zone: its charger's current [A], True: the robot's own}; ``map_file``:
    the map beside the scenario, None if there is none.
    """

    things: List[Dict[str, Any]] = field(default_factory=list)
    nodes: List[Any] = field(default_factory=list)
    starts: Dict[str, Start] = field(default_factory=dict)
    currents: Dict[str, Any] = field(default_factory=dict)
    map_file: Optional[str] = None
    levels: Dict[str, float] = field(default_factory=dict)

    @property
    def numbers(self) -> Dict[str, int]:
        """The place of each thing among ``things``, by its name in the log: 'zone gate', 'place dock'."""
        return {'{kind} {name}'.format(**thing): number for number, thing in enumerate(self.things)}

    @property
    def points(self) -> List[Tuple[float, float]]:
        """All points that the map must show, [(x, y)] [m]."""
        starts = [(start.pose.x, start.pose.y) for start in self.starts.values()]
        return [*(tuple(point) for thing in self.things for point in thing['points']),
                *(tuple(node[1:]) for node in self.nodes), *starts]


def find_world(scenario: Any, recordings: Sequence[Recording]) -> World:
    """Return the :class:`World` of a ``scenario``: a path, a Scenario, or None for the file beside the first log.

    A file beside the log counts only if one of the Recordings names a robot of it. Otherwise the World is empty.

    :raises ConfigurationError: if the file cannot be read. :raises ReplayError: if a scenario that was given has none
        of the robots in the logs.
    """
    is_given = scenario is not None
    if not is_given:
        scenario = os.path.join(os.path.dirname(recordings[0].path), _BESIDE)
        if not os.path.isfile(scenario):
            return World()
    where, map_file = 'scenario', None
    if isinstance(scenario, (str, os.PathLike)):
        where = os.fspath(scenario)
        scenario = read_scenario(where)
        map_file = os.path.join(os.path.dirname(where), _MAP)
    world = make_world(scenario)
    world.map_file = map_file if map_file and os.path.isfile(map_file) else None
    names = [name for recording in recordings for name in recording.name_of]
    if names and world.starts and not any(name in world.starts for name in names):
        if is_given:
            raise ReplayError('{}: got robots none of which is in the log; allowed: the scenario of the run'.format(
                where))
        return World()
    return world


def make_world(scenario: Any) -> World:
    """Return the :class:`World` of a Scenario."""
    world = World()
    for zone in scenario.zones:
        world.things.append(_thing('zone', zone.name, zone.outline.points, zone.capacity,
                                   charger=zone.charger is not None, max_speed=zone.max_speed or 0.0))
        if zone.charger is not None:
            world.currents[zone.name] = zone.charger
    nets = {spec.settings.network.source: spec.settings.network for spec in scenario.robots
            if isinstance(spec.settings.network, LaneMap)}
    for net in nets.values():
        world.nodes += [[name, pose.x, pose.y] for name, pose in net.nodes.items()]
        world.things += [_thing('lane', '{} - {}'.format(edge.begin, edge.end), edge.points, edge.capacity,
                                one_way=edge.one_way) for edge in net.edges]
        world.things += [_thing('node', name, [(net.nodes[name].x, net.nodes[name].y), *net.spots.get(name, ())],
                                capacity) for name, capacity in net.capacities.items()]
    for place in (scenario.places or {}).values():
        world.things.append(_thing('place', place.name, [(place.pose.x, place.pose.y)], place.capacity,
                                   reach=place.reach, parking=place.parking))
    if len(world.things) > _MOST_THINGS:
        raise ReplayError('replay: got {} zones, lanes, nodes and places; allowed: at most {}'.format(
            len(world.things), _MOST_THINGS))
    settings = scenario.dispatcher
    if settings is not None:
        world.levels = {'critical': settings.charge_below,
                        'good': max(settings.charge_below, settings.charge_when_idle)}
    for spec in scenario.robots:
        world.starts[spec.name] = Start(spec.settings.start, spec.settings.battery)
    return world


def box_of(points: Iterable[Sequence[float]]) -> Optional[Box]:
    """Return the Box around points (x, y, ...), None if there are none."""
    xs_and_ys = list(zip(*(point[:2] for point in points)))
    return (*map(min, xs_and_ys), *map(max, xs_and_ys)) if xs_and_ys else None


def _thing(kind: str, name: str, points: Sequence[Tuple[float, float]], capacity: Optional[int],
           **more: Union[bool, float]) -> Dict[str, Any]:
    return {'kind': kind, 'name': name, 'points': [list(point) for point in points], 'capacity': capacity, **more}
