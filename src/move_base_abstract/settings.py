"""The settings of one robot, read from the parameters of a new or of an existing move_base set-up."""
import math
from dataclasses import dataclass, field
from typing import List, Optional

from . import upstream
from .costmaps import Costmaps, read_costmaps
from .errors import ConfigurationError
from .geometry import Pose2D
from .motion import MotionLimits, Tolerances
from .navigator import BadFramePolicy
from .parameter_table import (
    Parameter,
    boolean,
    checked,
    integer,
    name,
    number,
    numbers,
    one_of,
    read_table,
    text,
    topic,
    unknown_names,
)
from .planning import WorldBounds
from .recovery import DEFAULT_BEHAVIORS, ROTATION_SECONDS, RecoveryBehavior, RecoveryPolicy
from .shown import shown

DEFAULT_SPEED = 0.5

_POSITIVE = 'a finite number > 0'
_NOT_NEGATIVE = 'a finite number >= 0'
_FINITE = 'a finite number'

SPEED = Parameter('max_speed', DEFAULT_SPEED, number(above=0.0), _POSITIVE + ' [m/s]')
ACCELERATION = Parameter('acceleration', 0.0, number(low=0.0), _NOT_NEGATIVE + ' [m/s^2], 0 = unlimited')
XY_TOLERANCE = Parameter('xy_goal_tolerance', 0.0, number(low=0.0), _NOT_NEGATIVE + ' [m]')
YAW_TOLERANCE = Parameter('yaw_goal_tolerance', 0.0, number(low=0.0), _NOT_NEGATIVE + ' [rad]')

TABLE = (
    Parameter('turn_rate', 0.0, number(low=0.0), _NOT_NEGATIVE + ' [rad/s], 0 = turning takes no time'),
    Parameter('start_x', 0.0, number(), _FINITE + ' [m, global frame]'),
    Parameter('start_y', 0.0, number(), _FINITE + ' [m, global frame]'),
    Parameter('start_yaw', 0.0, number(), _FINITE + ' [rad, global frame]'),
    Parameter('global_frame', None, name, 'a frame name'),
    Parameter('odom_frame', None, name, 'a frame name'),
    Parameter('robot_base_frame', None, name, 'a frame name'),
    Parameter('tf_prefix', None, text, 'a string'),
    Parameter('feedback_freq', None, number(0.0, 1000.0), 'a number in 0..1000 [Hz, simulated], 0 = none'),
    Parameter('max_feedback_rate', 50.0, number(0.1, 1000.0), 'a number in 0.1..1000 [Hz, wall]'),
    Parameter('pose_update_freq', 10.0, number(0.0, 1000.0),
              'a number in 0..1000 [Hz, simulated], 0 = at departure and arrival only'),
    Parameter('max_pose_rate', 50.0, number(0.1, 1000.0), 'a number in 0.1..1000 [Hz, wall]'),
    Parameter('tf_heartbeat_freq', 10.0, number(0.0, 1000.0), 'a number in 0..1000 [Hz, simulated], 0 = none'),
    Parameter('backend', 'builtin', text, 'the name of a backend'),
    Parameter('marker_topic', 'robot_markers', name, 'a topic name'),
    Parameter('marker_size', 1.0, number(above=0.0), _POSITIVE + " [m], the length of a robot's arrow"),
    Parameter('stage_offset_x', 0.0, number(), _FINITE + " [m], the global frame's origin in Stage's world"),
    Parameter('stage_offset_y', 0.0, number(), _FINITE + " [m], the global frame's origin in Stage's world"),
    Parameter('stage_offset_yaw', 0.0, number(), _FINITE + " [rad], the global frame's x axis in Stage's world"),
    Parameter('stage_world_frame', None, name, 'a frame name'),
    Parameter('gazebo_model', None, name, "the name of one of Gazebo's models"),
    Parameter('gazebo_reference_frame', 'world', name, "the name of a frame of Gazebo's"),
    Parameter('gazebo_z', 0.0, number(), _FINITE + " [m], height of the model's origin"),
    Parameter('bad_frame_policy', 'abort', one_of('abort', 'wait'), "'abort' or 'wait'"),
    Parameter('frame_timeout', 1.0, number(0.0, 60.0), 'a number in 0..60 [s, wall]'),
    Parameter('abort_policy', 'fast', one_of('fast', 'upstream'), "'fast' or 'upstream'"),
    Parameter('status_list_timeout', 5.0, number(low=0.0), _NOT_NEGATIVE + ' [s, simulated]'),
    Parameter('min_answer_delay', 0.02, number(0.0, 1.0), 'a number in 0..1 [s, wall]'),
    Parameter('world_bounds', None, numbers(4), 'a list [x_min, y_min, x_max, y_max] [m, global frame]'),
    Parameter('use_map', False, boolean, 'true or false'),
    Parameter('map_topic', '/map', topic, 'a topic name'),
    Parameter('allow_unknown', True, boolean, 'true or false'),
    Parameter('allow_occupied_goals', False, boolean, 'true or false'),
    Parameter('controller_frequency', 20.0, number(above=0.0), _POSITIVE + ' [Hz, simulated]'),
    Parameter('planner_patience', 5.0, number(low=0.0), _NOT_NEGATIVE + ' [s, simulated]'),
    Parameter('max_planning_retries', -1, integer(-1), 'a whole number >= -1'),
    Parameter('recovery_behavior_enabled', True, boolean, 'true or false'),
    Parameter('make_plan_add_unreachable_goal', True, boolean, 'true or false'),
    Parameter('base_local_planner', upstream.DEFAULT_LOCAL_PLANNER, text, 'the name of a plugin'),
    Parameter('base_global_planner', upstream.DEFAULT_GLOBAL_PLANNER, text, 'the name of a plugin'),
)
#: (our parameter, the costmap that tells it in an existing set-up, its key there, the default)
_COSTMAP_FRAMES = (('global_frame', 'global_costmap', 'global_frame', 'map'),
                   ('robot_base_frame', 'global_costmap', 'robot_base_frame', 'base_link'),
                   ('odom_frame', 'local_costmap', 'global_frame', 'odom'))
_LIMITS = (SPEED, ACCELERATION, XY_TOLERANCE, YAW_TOLERANCE)
OWN_NAMES = tuple(parameter.name for parameter in TABLE + _LIMITS) + ('recovery_behaviors',)
#: what a robot's settings are made of, before all that is given, where time leaps from event to event: each of these
#: would be an event more that time has to stop for
EVENTS_ONLY = {'feedback_freq': 0.0, 'pose_update_freq': 0.0, 'tf_heartbeat_freq': 0.0}


@dataclass
class RobotSettings:
    """All settings of one robot; units as in the docs of the ``move_base`` node."""

    limits: MotionLimits
    tolerances: Tolerances
    speed_source: str
    acceleration_source: str
    start: Pose2D
    bounds: WorldBounds
    recovery: RecoveryPolicy
    bad_frame_policy: BadFramePolicy
    costmaps: Costmaps
    values: dict
    tf_prefix: Optional[str] = None
    ignored: List[str] = field(default_factory=list)
    warnings: List[str] = field(default_factory=list)

    @property
    def local_planner(self):
        """The namespace of the local planner, below the node's own."""
        return upstream.plugin_namespace(self.values['base_local_planner'])

    @property
    def global_planner(self):
        """The namespace of the global planner, below the node's own."""
        return upstream.plugin_namespace(self.values['base_global_planner'])

    def frame(self, frame_id):
        """Return the robot's own frame ``frame_id`` with its tf prefix, which is not put twice."""
        if not self.tf_prefix or frame_id.startswith(self.tf_prefix + '/'):
            return frame_id
        return '{}/{}'.format(self.tf_prefix, frame_id)


def read_settings(raw, where):
    """Return the :class:`RobotSettings` in ``raw``, the dictionary of all parameters in the namespace ``where``.

    :raises ConfigurationError: for a wrong type or an impossible value of a parameter that is used.
    """
    if not isinstance(raw, dict):
        raise ConfigurationError('{}: got {}; allowed: a namespace of parameters'.format(where, shown(raw)))
    values = read_table(raw, TABLE, where)
    planners = _planner_order(values)
    speed, speed_source = _limit(raw, SPEED, ('max_vel_x', 'max_vel_trans'), planners, where)
    acceleration, acceleration_source = _limit(raw, ACCELERATION, ('acc_lim_x',), planners, where)
    xy_tolerance, xy_source = _limit(raw, XY_TOLERANCE, ('xy_goal_tolerance',), planners, where)
    yaw_tolerance, yaw_source = _limit(raw, YAW_TOLERANCE, ('yaw_goal_tolerance',), planners, where)
    costmaps, costmap_sources = read_costmaps(raw, where)
    used = [speed_source, acceleration_source, xy_source, yaw_source, *costmap_sources]
    for own, costmap, key, default in _COSTMAP_FRAMES:
        if values[own] is None:
            values[own], source = _costmap_frame(raw, costmap, key, default, where)
            used.append(source)
    if values['odom_frame'] == values['global_frame']:  # a local costmap in the map frame says nothing of odometry
        values['odom_frame'] = 'odom'
    if values['feedback_freq'] is None:
        values['feedback_freq'] = values['controller_frequency']
    return RobotSettings(
        limits=MotionLimits(speed, acceleration or math.inf, values['turn_rate'] or math.inf),
        tolerances=Tolerances(xy_tolerance, yaw_tolerance),
        speed_source=speed_source, acceleration_source=acceleration_source,
        start=Pose2D(values['start_x'], values['start_y'], values['start_yaw']),
        bounds=_bounds(values['world_bounds'], where),
        recovery=_recovery(raw, values, where),
        bad_frame_policy=BadFramePolicy(values['bad_frame_policy']),
        costmaps=costmaps,
        values=values, tf_prefix=None if values['tf_prefix'] is None else values['tf_prefix'].strip('/'),
        **_other_names(raw, values, used, where))


def _planner_order(values):
    named = upstream.plugin_namespace(values['base_local_planner'])
    return (named,) + tuple(planner for planner in upstream.LOCAL_PLANNERS if planner != named)


def _limit(raw, parameter, upstream_keys, planners, where):
    """Return (value, where it came from): the robot's own, else the local planner's, else the default."""
    if parameter.name in raw:
        return checked(raw[parameter.name], parameter.name, parameter, where), '~' + parameter.name
    for planner in planners:
        group = raw.get(planner)
        for key in upstream_keys if isinstance(group, dict) else ():
            if key in group:
                path = '{}/{}'.format(planner, key)
                return checked(group[key], path, parameter, where), '~' + path
    return parameter.default, 'default'


def _costmap_frame(raw, costmap, key, default, where):
    """Return (frame name, where it came from): the costmap's, else the default."""
    group = raw.get(costmap)
    if not isinstance(group, dict) or key not in group:
        return default, 'default'
    path = '{}/{}'.format(costmap, key)
    return checked(group[key], path, Parameter(key, None, name, 'a frame name'), where), '~' + path


def _bounds(values, where):
    if values is None:
        return WorldBounds()
    try:
        return WorldBounds(*values)
    except ValueError as error:
        raise ConfigurationError('parameter {}/world_bounds: {}'.format(where.rstrip('/'), error)) from None


def _recovery(raw, values, where):
    patience = 0.0 if values['max_planning_retries'] >= 0 else values['planner_patience']
    behaviors = _behaviors(raw['recovery_behaviors'], where) if 'recovery_behaviors' in raw else DEFAULT_BEHAVIORS
    return RecoveryPolicy(fast=values['abort_policy'] == 'fast', patience=patience,
                          behaviors=behaviors if values['recovery_behavior_enabled'] else ())


def _behaviors(raw, where):
    """Read move_base's list of {name, type}; a type that rotates takes one turn's time, others none."""
    try:
        return tuple(RecoveryBehavior(str(entry['name']),
                                      ROTATION_SECONDS if 'rotate' in str(entry['type']).lower() else 0.0)
                     for entry in raw)
    except (TypeError, KeyError):
        raise ConfigurationError('parameter {}/recovery_behaviors: got {}; allowed: a list of {{name, type}}'.format(
            where.rstrip('/'), shown(raw))) from None


def _other_names(raw, values, used, where):
    """Sort what is not ours into what upstream would use and what nobody knows."""
    plugins = {upstream.plugin_namespace(values[key]) for key in ('base_local_planner', 'base_global_planner')}
    behaviors = raw.get('recovery_behaviors', [])
    groups = sorted(plugins) + [str(entry['name']) for entry in behaviors]
    upstream_names = tuple(upstream.IGNORED_NAMES) + tuple(groups)
    ignored = [path for key in sorted(raw) if key in upstream_names for path in _leaves(key, raw[key])
               if '~' + path not in used]
    return {'ignored': ignored, 'warnings': unknown_names(raw, OWN_NAMES + upstream_names, where)}


def _leaves(key, value):
    """Return the paths of the parameters below ``key``."""
    if not isinstance(value, dict):
        return [key]
    return [leaf for child in sorted(value) for leaf in _leaves('{}/{}'.format(key, child), value[child])]
