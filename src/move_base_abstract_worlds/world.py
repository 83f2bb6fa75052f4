"""A scenario for the checks: where robots start, their planners, and where they may be sent."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, List, NamedTuple, Optional, Sequence, Tuple, Union

from move_base_abstract.common.bounded_yaml import load_yaml_file
from move_base_abstract.fleet.dispatch_world import chargers_of
from move_base_abstract.fleet.robot_parts import make_planner
from move_base_abstract.maps.lane_map import LaneMap
from move_base_abstract.maps.map_check import MapCheck
from move_base_abstract.maps.map_files import load_map, read_description
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import read_scenario
from move_base_abstract.tasks.arrivals import Listed

if TYPE_CHECKING:
    from pathlib import Path

    from move_base_abstract.config.settings import RobotSettings
    from move_base_abstract.maps.grid_planner import GridPlanner
    from move_base_abstract.maps.lane_planner import LanePlanner
    from move_base_abstract.maps.occupancy import OccupancyMap
    from move_base_abstract.maps.planning import StraightLinePlanner
    from move_base_abstract.scenario import Scenario

_MAP = 'map.yaml'  # the name of the map beside a scenario, as `scenario make` writes it
_MOST_GOALS = 2_000  # the largest number of goals from files of tasks that are checked


class Target(NamedTuple):
    """A target of robots: ``what`` it is ('place', 'charger', 'goal'), its name, its pose, ``where`` it is defined."""

    what: str
    name: str
    pose: Pose2D
    where: str

    @property
    def xy(self) -> Tuple[float, float]:
        """The position (x, y) [m]."""
        return self.pose.x, self.pose.y


class Start(NamedTuple):
    """A robot (RobotSpec), and ``where`` in the file it is defined."""

    spec: Any
    where: str

    @property
    def xy(self) -> Tuple[float, float]:
        """The position (x, y) [m] at which the robot starts."""
        return self.spec.settings.start.x, self.spec.settings.start.y

    @property
    def radius(self) -> float:
        """The radius of the largest circle in the robot's footprint [m]."""
        return self.spec.settings.costmaps.global_footprint.inscribed_radius


class Drivers(NamedTuple):
    """Robots (Start) that plan their ways alike, by one ``planner``; None: they need a map, and there is none."""

    planner: Any
    starts: Tuple[Start, ...]

    @property
    def settings(self) -> RobotSettings:
        """The settings of the first robot."""
        return self.starts[0].spec.settings

    @property
    def lanes(self) -> Optional[LaneMap]:
        """The net of lanes on which they drive, or None."""
        network = self.settings.network
        return network if isinstance(network, LaneMap) else None


@dataclass
class World:
    """A scenario, from the file ``path``, and its map (OccupancyMap), from ``map_path``, prepared for the checks."""

    path: str
    scenario: Any
    map_path: Optional[str]
    occupancy: Any
    starts: List[Start]
    drivers: List[Drivers]
    targets: List[Target]

    @property
    def nets(self) -> Dict[str, LaneMap]:
        """The nets of lanes on which robots drive, {path: LaneMap}."""
        return {drivers.lanes.source: drivers.lanes for drivers in self.drivers if drivers.lanes is not None}

    def drivers_on(self, net: LaneMap) -> List[Drivers]:
        """Return the Drivers on a net (LaneMap)."""
        return [drivers for drivers in self.drivers if drivers.lanes is not None and drivers.lanes.source == net.source]


def read_world(path: Union[str, Path], map_path: Any = None) -> World:
    """Return the :class:`World` of a scenario.

    ``map_path``: the YAML file of the map; None: ``map.yaml`` beside the scenario, if there is one.

    :raises ConfigurationError: if a file cannot be read or used.
    """
    path = str(path)
    if map_path is None:
        beside: Any = os.path.join(os.path.dirname(path), _MAP)
        map_path = beside if os.path.isfile(beside) else None
    occupancy = None if map_path is None else load_map(read_description(map_path))
    scenario = read_scenario(path, None if occupancy is None else {'use_map': True})
    starts = [Start(spec, where) for spec, where in zip(scenario.robots, _wheres(path))]
    return World(path, scenario, map_path, occupancy, starts, _drivers(starts, occupancy), _targets(path, scenario))


def _wheres(path: str) -> List[str]:
    """Return where in the file each robot is defined, in the order of the robots."""
    name = os.path.basename(path)
    return ['{}: robots[{}]'.format(name, index) for index, group in enumerate(load_yaml_file(path).get('robots') or [])
            for _ in range(group.get('count', 1))]


def _drivers(starts: Sequence[Start], occupancy: Optional[OccupancyMap]) -> List[Drivers]:
    groups: Dict[Any, Any] = {}
    for start in starts:
        settings = start.spec.settings
        values = settings.values
        key = (values['routes'], getattr(settings.network, 'source', None), settings.limits, settings.tolerances,
               values['corners'], values['use_map'], values['allow_unknown'], values['allow_occupied_goals'],
               values['leave_obstacles'], start.radius, settings.bounds, values['calibration'],
               values['compatible_with'],
               values['travel_matrix'], settings.battery and (settings.battery.mechanics, settings.battery.energy,
                                                              settings.battery.ambient_power))
        groups.setdefault(key, []).append(start)
    return [Drivers(_planner(group[0].spec.settings, occupancy), tuple(group)) for group in groups.values()]


def _planner(settings: RobotSettings,
             occupancy: Optional[OccupancyMap]) -> Optional[Union[GridPlanner, LanePlanner, StraightLinePlanner]]:
    values = settings.values
    check = None
    if occupancy is not None and values['use_map']:
        check = MapCheck(occupancy, values['allow_unknown'], values['allow_occupied_goals'])
    return None if check is None and values['routes'] == 'grid' else make_planner(settings, check)


def _targets(path: str, scenario: Scenario) -> List[Target]:
    name = os.path.basename(path)
    places = [Target('place', place.name, place.pose, '{}: places[{}]'.format(name, index))
              for index, place in enumerate((scenario.places or {}).values())]
    index_of = {zone.name: index for index, zone in enumerate(scenario.zones)}
    chargers = [Target('charger', charger.name, charger.pose, '{}: zones[{}]'.format(name, index_of[charger.name]))
                for charger in chargers_of(scenario)]
    goals = [Target('goal', task.task_id, task.pose, '{}: arrivals[{}], row {}'.format(name, index, number))
             for index, arrivals in enumerate(scenario.arrivals) if isinstance(arrivals, Listed)
             for number, task, _ in arrivals.rows if not task.place]
    return places + chargers + goals[:_MOST_GOALS]

