"""The settings of one robot, read from the parameters of a new or of an existing move_base set-up."""
from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from typing import Any, Callable, Dict, List, Mapping, Optional, Tuple, Union

from ..common.errors import ConfigurationError
from ..common.kinds import FLAG, FRAME, error, number
from ..common.parameter_table import Parameter, checked, place_of, read_table, unknown_names
from ..driving.settings import DriveSettings, read_drive
from ..energy.battery import BatterySettings, read_battery
from ..faults.buggify import Buggify, read_buggify
from ..faults.failures import CALIBRATED, Failures, read_failures
from ..goals.navigator import BadFramePolicy
from ..goals.recovery import (
    BEHAVIORS_WITHOUT_ROTATION,
    DEFAULT_BEHAVIORS,
    ROTATION_SECONDS,
    RecoveryBehavior,
    RecoveryPolicy,
)
from ..maps.costmaps import GLOBAL, Costmaps, read_costmaps
from ..maps.lane_map import LaneMap, read_lane_map
from ..maps.planning import WorldBounds
from ..maps.travel_matrix import TravelMatrix, read_travel_matrix
from ..motion.approach import MotionPhases
from ..motion.attempts import Attempts
from ..motion.calibration import CalibratedDurations, read_calibration
from ..motion.durations import TABLE as DURATIONS, Durations, read_durations
from ..motion.encounter_law import EncounterLaw
from ..motion.geometry import Pose2D
from ..motion.leg import MotionLimits, Tolerances
from ..motion.original import POSE_RATES, RASBERRY, OriginalLaw
from ..motion.stuck_law import StuckLaw
from ..sensing.laser import LaserSettings, read_laser
from . import upstream
from .local_planner import (
    ACCELERATION as ACCELERATION_LIMIT,
    XY_TOLERANCE as XY_LIMIT,
    YAW_TOLERANCE as YAW_LIMIT,
    Found,
    PlannerGroup,
    leaves,
)
from .robot_table import ACCELERATION, DRIVEN, LIMITS, NEEDS, OWN_NAMES, SPEED, TABLE, XY_TOLERANCE, YAW_TOLERANCE

_ODOM, _LINK, _FOOTPRINT = 'odom', 'base_link', 'base_footprint'
_SCANS_OF_STAGE = 'base_scan'
#: the second names of parameters of a robot under velocities, as other packages have them, and the first ones
_NAMED_TWICE = (('base_frame_id', 'robot_base_frame'), ('odom_frame_id', 'odom_frame'),
                ('base_watchdog_timeout', 'cmd_vel_timeout'))
#: (our parameter, the costmap that has it in an existing set-up, its key there, the default)
_COSTMAP_FRAMES = (('global_frame', 'global_costmap', 'global_frame', 'map'),
                   ('robot_base_frame', 'global_costmap', 'robot_base_frame', 'base_link'),
                   ('odom_frame', 'local_costmap', 'global_frame', None))
#: equal ones, which cannot be changed, are one object for all robots of a process
_limits, _tolerances = lru_cache(64, typed=True)(MotionLimits), lru_cache(64, typed=True)(Tolerances)
#: the parameters that a calibration replaces
_CALIBRATED = tuple(parameter.name for parameter in LIMITS + DURATIONS) + ('turn_rate',)
#: the defaults with ``events_only``, where time leaps from event to event: each of these rates would add events for
#: which time has to stop
EVENTS_ONLY = {'feedback_freq': 0.0, 'pose_update_freq': 0.0, 'tf_heartbeat_freq': 0.0}


@dataclass
class RobotSettings:
    """All settings of one robot; the units are those in the docs of the ``move_base`` node."""

    limits: MotionLimits
    tolerances: Tolerances
    speed_source: str
    acceleration_source: str
    start: Pose2D
    bounds: WorldBounds
    recovery: RecoveryPolicy
    bad_frame_policy: BadFramePolicy
    costmaps: Costmaps
    values: Dict[str, Any]
    tf_prefix: Optional[str] = None
    #: all recovery behaviours, whether they are enabled or not
    behaviors: Tuple[RecoveryBehavior, ...] = DEFAULT_BEHAVIORS
    #: how the durations of goals differ from the law of motion; None: they do not
    durations: Union[Durations, CalibratedDurations, None] = None
    #: the failures of the robot, and its deliberate faults; None: there are none
    failures: Optional[Failures] = None
    buggify: Optional[Buggify] = None
    #: the robot's battery; None: it has none, and needs no energy
    battery: Optional[BatterySettings] = None
    #: how it is driven by velocities; None: it travels to goals
    drive: Optional[DriveSettings] = None
    #: the robot's laser scanner
    laser: LaserSettings = LaserSettings()
    #: how legs begin and end; None: as in Leg
    phases: Optional[MotionPhases] = None
    #: the law of motion of the original package, and the attempts of its branch for failures; None: our law
    original: Optional[OriginalLaw] = None
    attempts: Optional[Attempts] = None
    #: the LaneMap or TravelMatrix by which the robot finds its way; None: neither
    network: Union[LaneMap, TravelMatrix, None] = None
    #: the calibration's law of meeting other robots; None: it has none
    encounters: Optional[EncounterLaw] = None
    #: {name: m/s} of the planner's parameters from which the speed comes
    speeds: Dict[str, float] = field(default_factory=dict)
    #: the distance [m] from a goal that cannot be reached within which the robot goes instead, to the nearest place
    plan_tolerance: float = 0.0
    #: parameters of upstream that have no effect, and those that neither upstream nor this node knows
    ignored: List[str] = field(default_factory=list)
    #: {parameter that has no effect: what it needs to have one, 'NAME: VALUE'}
    needs: Dict[str, str] = field(default_factory=dict)
    unknown: List[str] = field(default_factory=list)
    warnings: List[str] = field(default_factory=list)

    @property
    def local_planner(self) -> str:
        """The namespace of the local planner, below the node's own."""
        return upstream.plugin_namespace(self.values['base_local_planner'])

    @property
    def global_planner(self) -> str:
        """The namespace of the global planner, below the node's own."""
        return upstream.plugin_namespace(self.values['base_global_planner'])

    @property
    def odom_frame(self) -> str:
        """The full name of the odometry's frame; without a map it may be the global frame itself."""
        return self.frame(self.values['odom_frame'])

    @property
    def footprint_frame(self) -> str:
        """The frame between the odom and the base frame of a robot under velocities, without prefix; '': none."""
        given = self.values['footprint_frame']
        if given is None:
            return _FOOTPRINT if self.values['robot_base_frame'] == _LINK else ''
        return str(given)

    @property
    def odom_origin(self) -> Pose2D:
        """Where the odom frame of a robot under velocities lies in the global frame."""
        origin = self.values['odom_origin']
        return self.start if origin is None else Pose2D(*origin)

    def frame(self, frame_id: str) -> str:
        """Return the robot's own frame ``frame_id`` with its tf prefix, unless it has the prefix already."""
        if not self.tf_prefix or frame_id.startswith(self.tf_prefix + '/'):
            return frame_id
        return '{}/{}'.format(self.tf_prefix, frame_id)


def read_settings(raw: Mapping[str, Any], where: str) -> Optional[RobotSettings]:
    """Return the :class:`RobotSettings` in ``raw``, the dictionary of all parameters in the namespace ``where``.

    :raises ConfigurationError: if a parameter that is used has a wrong type or a value that is not allowed.
    """
    if not isinstance(raw, dict):
        raise error(where, raw, 'a namespace of parameters')
    if 'encounters' in raw:
        raise error(place_of(where, 'encounters'), raw['encounters'],
                    "at the top of a fleet's scenario, or as a parameter of the node fleet: robots of different "
                    'processes, such as this node, cannot meet')
    values = _values(raw, where)
    network = _check_routes(values, where)
    planner = PlannerGroup(raw, where)
    speed = _limit(raw, SPEED, where, planner.speed)
    acceleration = _limit(raw, ACCELERATION, where, partial(planner.limit, ACCELERATION_LIMIT))
    xy_tolerance = _limit(raw, XY_TOLERANCE, where, partial(planner.limit, XY_LIMIT))
    yaw_tolerance = _limit(raw, YAW_TOLERANCE, where, partial(planner.limit, YAW_LIMIT))
    costmaps, plan_tolerance, of_ground = _read_ground(raw, values, where)
    used = [path for found in (speed, acceleration, xy_tolerance, yaw_tolerance) for path in found.paths]
    used += of_ground + _read_frames(raw, values, where)
    if values['feedback_freq'] is None:
        values['feedback_freq'] = values['controller_frequency']
    behaviors = _behaviors(raw, values, where)
    settings = RobotSettings(
        limits=_limits(speed.value, acceleration.value or math.inf, values['turn_rate'] or math.inf),
        tolerances=_tolerances(xy_tolerance.value, yaw_tolerance.value),
        speed_source=speed.source, acceleration_source=acceleration.source, speeds=planner.speeds,
        start=Pose2D(values['start_x'], values['start_y'], values['start_yaw']),
        bounds=_bounds(values['world_bounds'], where),
        recovery=_recovery(values, behaviors), behaviors=behaviors,
        bad_frame_policy=BadFramePolicy(values['bad_frame_policy']),
        costmaps=costmaps, plan_tolerance=plan_tolerance, network=network, durations=read_durations(values, where),
        failures=read_failures(values, where, _stuck_law(values, where)), buggify=read_buggify(values),
        battery=read_battery(values), laser=read_laser(values, where), drive=read_drive(values, where),
        values=values, tf_prefix=None if values['tf_prefix'] is None else values['tf_prefix'].strip('/'),
        **_other_names(raw, values, used, where, planner.warnings))
    if values['compatible_with'] is not None:
        return _as_original(settings, raw, where)
    return settings if values['calibration'] is None else _calibrated(settings, raw, where)


def _values(raw: Mapping[str, Any], where: str) -> Dict[str, Any]:
    """Return the values of TABLE; those that a robot under velocities names, or leaves out, as other simulators do."""
    values = read_table(raw, TABLE, where)
    if values[DRIVEN[0]] != DRIVEN[1]:
        return values
    for theirs, own in _NAMED_TWICE:
        if values[theirs] is not None:
            if values[own] is not None:
                raise error(place_of(where, theirs), values[theirs], 'one of the two',
                            f' with {own}: {values[own]}, which is the same')
            values[own] = values[theirs]
    if values['publish_rate'] is not None:
        values['pose_update_freq'] = values['publish_rate']
    if 'scan_topic' not in raw:
        values['scan_topic'] = _SCANS_OF_STAGE
    return values


def _as_original(settings: RobotSettings, raw: Mapping[str, Any], where: str) -> RobotSettings:
    """Return ``settings`` with the law of motion of the original package, which has no parameters to change it."""
    profile = settings.values['compatible_with']
    for key in ('calibration', 'turn_rate', 'xy_goal_tolerance', 'yaw_goal_tolerance', 'routes',
                *(parameter.name for parameter in DURATIONS)):
        if key in raw and (key, raw[key]) != ('routes', 'none'):
            raise error(place_of(where, key), raw[key], 'one of the two',
                        f' with compatible_with: {profile}, which has no such parameter')
    if 'pose_update_freq' not in raw:
        settings.values['pose_update_freq'] = POSE_RATES[profile]
    return replace(settings, tolerances=Tolerances(),
                   limits=MotionLimits(settings.limits.max_speed, settings.limits.acceleration),
                   original=OriginalLaw(profile, settings.values['pose_update_freq']),
                   attempts=Attempts() if profile == RASBERRY else None)


def _stuck_law(values: Mapping[str, Any], where: str) -> Optional[StuckLaw]:
    """Return the law of the calibration by which a robot gets stuck; None if it does not get stuck by one."""
    name = values['calibration']
    return read_calibration(name, where).stuck if name is not None and values['failure_kind'] == CALIBRATED else None


def _calibrated(settings: RobotSettings, raw: Mapping[str, Any], where: str) -> RobotSettings:
    """Return ``settings`` with the values of their calibration."""
    own = [name for name in _CALIBRATED if name in raw]
    if own:
        raise error(place_of(where, own[0]), raw[own[0]], 'one of the two', ' with a calibration, which sets it, too')
    calibration = read_calibration(settings.values['calibration'], where)
    if settings.values['routes'] == 'matrix' or isinstance(settings.network, LaneMap) and settings.network.has_speeds:
        raise error(place_of(where, 'calibration'), settings.values['calibration'],
                    "with 'none', 'grid', or 'lanes' whose edges have neither speed nor length",
                    f' with routes: {settings.values["routes"]}')
    source = 'calibration {}'.format(settings.values['calibration'])
    return replace(settings, limits=calibration.limits, tolerances=calibration.tolerances, phases=calibration.phases,
                   durations=calibration.durations, encounters=calibration.encounters, speed_source=source,
                   acceleration_source=source)


def _limit(raw: Mapping[str, Any], parameter: Parameter, where: str,
           of_planner: Callable[[Parameter], Found]) -> Found:
    """Return the :class:`Found` limit: the robot's own if it is set, otherwise that of ``of_planner(parameter)``."""
    if parameter.name in raw:
        return Found(checked(raw[parameter.name], parameter.name, parameter, where), '~' + parameter.name)
    return of_planner(parameter)


def _read_frames(raw: Mapping[str, Any], values: Dict[str, Any], where: str) -> List[str]:
    """Add the frames that are not set to ``values``; return the costmaps' parameters that were used."""
    used = []
    is_own = values['odom_frame'] is not None
    for own, costmap, key, default in _COSTMAP_FRAMES:
        group = raw.get(costmap)
        if values[own] is None and isinstance(group, dict) and key in group:
            path = '{}/{}'.format(costmap, key)
            values[own] = checked(group[key], path, Parameter(key, None, FRAME), where)
            used.append(path)
        elif values[own] is None:
            values[own] = default
    if not is_own and values['odom_frame'] in (None, values['global_frame']):
        # A local costmap in the map's frame says nothing of odometry. Without a map, odometry is in the global frame.
        is_mapless = _ODOM in values['global_frame'].rsplit('/', 1)[-1]
        values['odom_frame'] = values['global_frame'] if is_mapless else _ODOM
    if values['robot_base_frame'] in (values['global_frame'], values['odom_frame']):
        raise error(place_of(where, 'robot_base_frame'), values['robot_base_frame'], 'a name of its own',
                    ', which is the global or the odom frame too')
    return used


def _read_ground(raw: Mapping[str, Any], values: Dict[str, Any], where: str) -> Tuple[Costmaps, float, List[str]]:
    """Return the costmaps, the global planner's tolerance for goals [m], and the parameters used.

    Set what they say in ``values``: ``allow_unknown`` and ``map_topic``.
    """
    costmaps, sources = read_costmaps(raw, where, values['use_map'])
    used = [source[1:] for source in sources]
    if values['use_map'] and values['map_topic'] is None and costmaps.map_topic != 'map':
        values['map_topic'] = costmaps.map_topic

    def of_group(name: str, key: Optional[str], default: Any, kind: Any) -> Any:
        group = raw.get(name)
        if key is None or not isinstance(group, dict) or key not in group:
            return default
        used.append(f'{name}/{key}')
        return checked(group[key], used[-1], Parameter(key, default, kind), where)
    name = upstream.plugin_namespace(values['base_global_planner'])
    unknown, tolerance = upstream.GLOBAL_PLANNERS.get(name, (None, None))
    if values['allow_unknown'] is None:
        values['allow_unknown'] = not values['use_map'] or of_group(name, unknown, True, FLAG) or not of_group(
            GLOBAL, 'track_unknown_space', False, FLAG)  # a costmap that does not track unknown cells has none
    is_planned = values['routes'] == 'grid'
    return costmaps, of_group(name, tolerance, 0.0, number(low=0.0, unit='m')) if is_planned else 0.0, used


def _bounds(values: Optional[Tuple[float, float, float, float]], where: str) -> WorldBounds:
    if values is None:
        return WorldBounds()
    try:
        return WorldBounds(*values)
    except ValueError as fault:
        raise ConfigurationError('{}: {}'.format(place_of(where, 'world_bounds'), fault)) from None


def _check_routes(values: Dict[str, Any], where: str) -> Optional[Union[LaneMap, TravelMatrix]]:
    """Check that the parameters fit ``routes``; return the LaneMap or the TravelMatrix that it needs, or None."""
    routes = values['routes']
    if routes == 'grid':
        for key, allowed in (('use_map', True), ('allow_occupied_goals', False)):
            if values[key] is not allowed:
                raise error(place_of(where, 'routes'), routes, f'with {key}: {str(allowed).lower()} only',
                            f' with {key}: {str(not allowed).lower()}')
    for key, kind, read in (('lanes', 'lanes', read_lane_map), ('travel_matrix', 'matrix', read_travel_matrix)):
        if routes == kind:
            if values[key] is None:
                raise error(place_of(where, 'routes'), kind, 'with the path of a file there', f' without {key}')
            return read(values[key], where)
    return None


def _recovery(values: Dict[str, Any], behaviors: Tuple[RecoveryBehavior, ...]) -> RecoveryPolicy:
    patience = 0.0 if values['max_planning_retries'] >= 0 else values['planner_patience']
    return RecoveryPolicy(fast=values['abort_policy'] == 'fast', patience=patience,
                          behaviors=behaviors if values['recovery_behavior_enabled'] else ())


def _behaviors(raw: Mapping[str, Any], values: Dict[str, Any], where: str) -> Tuple[RecoveryBehavior, ...]:
    """Return the behaviours in move_base's list of {name, type}; a rotation takes the time of one turn, others none."""
    if 'recovery_behaviors' not in raw:
        return DEFAULT_BEHAVIORS if values['clearing_rotation_allowed'] else BEHAVIORS_WITHOUT_ROTATION
    try:
        return tuple(RecoveryBehavior(str(entry['name']),
                                      ROTATION_SECONDS if 'rotate' in str(entry['type']).lower() else 0.0)
                     for entry in raw['recovery_behaviors'])
    except (TypeError, KeyError):
        raise error(place_of(where, 'recovery_behaviors'), raw['recovery_behaviors'],
                    'a list of {name, type}') from None


def _other_names(raw: Mapping[str, Any], values: Dict[str, Any], used: List[str], where: str,
                 warnings: List[str]) -> Dict[str, Any]:
    """Return the parameters of others as ``ignored`` (move_base would use them) and ``warnings`` (unknown names)."""
    plugins = {upstream.plugin_namespace(values[key]) for key in ('base_local_planner', 'base_global_planner')}
    behaviors = raw.get('recovery_behaviors', [])
    groups = sorted(plugins) + [str(entry['name']) for entry in behaviors]
    upstream_names = tuple(upstream.IGNORED_NAMES) + tuple(groups)
    known = OWN_NAMES + upstream_names
    needs = {name: f'{other}: {value}' for name, (other, value) in NEEDS.items()
             if name in raw and values[other] != value}
    ignored = [path for path in leaves({key: raw[key] for key in raw if key in upstream_names}) if path not in used]
    return {'ignored': sorted({*ignored, *needs}), 'needs': needs,
            'unknown': leaves({key: raw[key] for key in raw if key not in known}),
            'warnings': warnings + unknown_names(raw, known, where)}
