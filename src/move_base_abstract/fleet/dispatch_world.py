"""A dispatcher on a scenario: what it knows beforehand (robots, chargers, all distances), and when it decides."""
from __future__ import annotations

import math
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional, Sequence

from ..common.errors import ConfigurationError, SimulatorError
from ..common.ros_names import natural_order
from ..common.units import NS_PER_S
from ..energy.consumption import energy_of_way
from ..maps.lane_map import LaneMap
from ..motion.geometry import Pose2D
from ..motion.leg import trip
from ..orders.charging import Charger
from ..orders.dispatcher import Command, Dispatcher
from ..orders.fleet_state import RobotStart
from ..orders.policies import Point
from .robot_parts import make_planner

if TYPE_CHECKING:
    from ..config.settings import RobotSettings
    from ..energy.battery import BatterySettings
    from ..engine.event_queue import EventQueue
    from ..orders.policies import Policy
    from ..orders.rows import Row
    from ..orders.settings import DispatchSettings
    from ..scenario import Scenario
    from ..traffic.outline import Outline

#: if orders or robots wait for a robot that charges, time goes on, and the dispatcher looks again after this [ns]
CHARGE_LOOK_NS = 60 * NS_PER_S
_KEPT_WAYS = 10_000
_MM = 1000.0
_MOST_TOLD = 5  # levels in an error


class Decisions:
    """When the dispatcher (:attr:`core`) of a scenario decides: once, after all of an instant at which it heard news.

    ``index``: the place of a decision at its instant in ``queue`` (EventQueue). ``act(commands, now_ns)`` carries out
    what was decided; ``tell``: see Dispatcher. ``failed(error)`` gets a SimulatorError of a decision; None: it is
    raised.
    """

    def __init__(self, scenario: Scenario, settings: DispatchSettings, policy: Policy, queue: EventQueue, index: int,
                 tell: Callable[[Row], object], act: Callable[[Sequence[Command], int], object],
                 failed: Optional[Callable[[SimulatorError], object]] = None) -> None:
        self.core = Dispatcher(starts_of(scenario), chargers_of(scenario), scenario.places or {}, settings, policy,
                               Distances(scenario, settings.distances == 'ways'), tell)
        self._queue = queue
        self._index = index
        self._act = act
        self._failed = failed
        self._looks = False
        #: whether a decision is due
        self.is_due = False

    def soon(self, now_ns: int) -> None:
        """Have the dispatcher decide at this instant [ns], when all its news have come in."""
        if not self.is_due:
            self.is_due = True
            self._queue.schedule(now_ns, self._index, self._decide)

    def _decide(self, _due_ns: int, now_ns: int) -> None:
        self.is_due = False
        try:
            commands = self.core.decide(now_ns)
        except SimulatorError as error:
            if self._failed is None:
                raise
            self._failed(error)
            return
        self._act(commands, now_ns)
        if self.core.waits_for_charge and not self._looks:
            self._looks = True
            self._queue.schedule(now_ns + CHARGE_LOOK_NS, self._index, self._look)

    def _look(self, _due_ns: int, now_ns: int) -> None:
        self._looks = False
        self.soon(now_ns)


def starts_of(scenario: Scenario) -> List[RobotStart]:
    """Return the robots of a scenario as they start, in the order of their names."""
    found = []
    for spec in sorted(scenario.robots, key=lambda spec: natural_order(spec.name)):
        battery = spec.settings.battery
        found.append(RobotStart(spec.name, spec.settings.start, None if battery is None else battery.start,
                                spec.settings.values['priority'],
                                None if battery is None else partial(_takes, battery, spec.settings)))
    return found


def _takes(battery: BatterySettings, settings: RobotSettings, way: int, seconds: float, joules: float) -> float:
    """Return the share of a full battery that a way [mm] and work [s, J] take; see LookAhead."""
    speed, _, driving = trip(way / _MM, settings.limits.max_speed, settings.limits.acceleration)
    lasts: float = driving * settings.values['duration_factor'] + settings.values['goal_overhead'] + seconds
    taken = energy_of_way(way / _MM, speed, battery.mechanics) + battery.ambient_power * lasts + joules
    return taken / battery.energy


def chargers_of(scenario: Scenario) -> List[Charger]:
    """Return the chargers of a scenario, each with the pose at which a robot stands to be charged.

    It is the first place in the charger's zone, or, if there is none, the first node of the lanes in it, or, if there
    is none either, a point inside the zone (:func:`inner_point`).
    """
    if not any(zone.charger is not None for zone in scenario.zones):
        return []
    points = [(place.pose.x, place.pose.y) for place in (scenario.places or {}).values()]
    nets = {id(spec.settings.network): spec.settings.network for spec in scenario.robots}
    points += [(pose.x, pose.y) for net in nets.values() if isinstance(net, LaneMap) for pose in net.nodes.values()]
    chargers = []
    for zone in scenario.zones:
        if zone.charger is not None:
            inside = next((point for point in points if zone.contains(*point)), None)
            chargers.append(Charger(zone.name, Pose2D(*(inside or inner_point(zone.outline))), zone.capacity))
    return chargers


def check_levels(scenario: Scenario, settings: DispatchSettings, where: str) -> None:
    """Check, if there are chargers, that each robot reports when its charge passes a level that the dispatcher uses.

    :raises ConfigurationError: if a robot does not.
    """
    if not any(zone.charger is not None for zone in scenario.zones):
        return
    for spec in scenario.robots:
        battery = spec.settings.battery
        missing = [level for level in settings.levels if battery is not None and level not in battery.levels]
        if missing:
            raise ConfigurationError(
                "{}: charge: robot '{}' does not report when its charge passes {}; allowed: with that among its "
                "battery_thresholds, to which the scenario's key dispatcher adds it".format(
                    where, spec.name, ', '.join('{:g}'.format(level) for level in missing[:_MOST_TOLD]) + (
                        ', ...' if len(missing) > _MOST_TOLD else '')))


def inner_point(outline: Outline) -> Point:
    """Return a point (x, y) [m] inside an Outline.

    It is the middle of the bounding box. If that lies outside, it is the middle of the first piece inside of the
    horizontal line through it.
    """
    left, low, right, high = outline.box
    x, y = (left + right) / 2.0, (low + high) / 2.0
    if outline.contains(x, y):
        return x, y
    pieces = outline.pieces_inside(((left - 1.0, y), (right + 1.0, y)))
    return ((left - 1.0 + sum(pieces[0]) / 2.0) if pieces else x), y


class Distances:
    """The distances from point to point for each robot, in whole millimetres: along its ways, or in a straight line.

    For a robot that finds its ways on a map it is the straight line, because a dispatcher has no map.
    """

    def __init__(self, scenario: Scenario, along_ways: bool) -> None:
        planners: Dict[Any, Callable[[Point, Point], Optional[int]]] = {}
        self._ways: Dict[str, Callable[[Point, Point], Optional[int]]] = {}
        for spec in scenario.robots if along_ways else ():
            settings = spec.settings
            if settings.values['routes'] not in ('lanes', 'matrix'):
                continue
            network: Any = settings.network
            key = settings.values['routes'], network.source, settings.limits.max_speed, settings.bounds
            if key not in planners:
                planners[key] = lru_cache(_KEPT_WAYS)(partial(
                    _length, make_planner(settings), settings.limits.max_speed))
            self._ways[spec.name] = planners[key]

    def __call__(self, robot: str, begin: Point, end: Point) -> Optional[int]:
        """Return the distance [mm] from ``begin`` to ``end`` (x, y) [m]; None if there is no way."""
        if robot not in self._ways:
            return round(_MM * math.dist(begin, end))
        return self._ways[robot](begin, end)


def _length(planner: Any, speed: float, begin: Point, end: Point) -> Optional[int]:
    way = planner.corners(Pose2D(*begin), Pose2D(*end))
    if way is None:
        return None
    seconds: Optional[float] = getattr(way, 'seconds', None)
    if seconds is not None:
        return round(_MM * seconds * speed)
    points = [begin, *way, end]
    return round(_MM * sum(math.dist(*pair) for pair in zip(points, points[1:])))
