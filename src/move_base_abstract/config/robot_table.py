"""The parameters of one robot. Reading, checks, pages and schemas all use this table."""
from __future__ import annotations

from ..common.kinds import (
    BELOW_ROOT,
    COORDINATE,
    FLAG,
    FRAME,
    INT32,
    PATH,
    TOPIC,
    bare_name,
    integer,
    number,
    numbers,
    one_of,
    position,
    string,
)
from ..common.parameter_table import Parameter
from ..driving.settings import TABLE as DRIVING
from ..energy.battery import TABLE as BATTERY
from ..faults.buggify import TABLE as BUGGIFY
from ..faults.failures import TABLE as FAILURES
from ..motion.durations import TABLE as DURATIONS
from ..motion.original import PROFILES
from ..sensing.laser import TABLE as LASER
from . import upstream

DEFAULT_SPEED = 0.5
_PATIENT = ('abort_policy', 'upstream')
#: what is set for a robot that is driven by velocities
DRIVEN = ('driven_by', 'velocities')

#: the ways in which a robot finds its way
ROUTES = ('none', 'grid', 'lanes', 'matrix')

SPEED = Parameter('max_speed', DEFAULT_SPEED, number(above=0.0, unit='m/s'),
                  "Top speed; a planner's group in an existing set-up is asked before the default.")
ACCELERATION = Parameter('acceleration', 0.0, number(low=0.0, unit='m/s^2', note='0 = unlimited'),
                         "Acceleration and deceleration; a planner's group in an existing set-up is asked before "
                         'the default.')
XY_TOLERANCE = Parameter('xy_goal_tolerance', 0.0, number(low=0.0, unit='m'),
                         "The robot stops this far short of the goal; a planner's group is asked before the default.")
YAW_TOLERANCE = Parameter('yaw_goal_tolerance', 0.0, number(low=0.0, unit='rad'),
                          "The robot stops turning this far short of the heading; a planner's group is asked before "
                          'the default.')

#: of a robot that is driven by velocities: what it publishes and hears
SHOWN = (
    Parameter('publish_rate', None, number(0.0, 1000.0, unit='Hz, simulated', note='0 = when it begins to stand only'),
              'Rate of odometry, ground truth and tf; the name of diff_drive_controller. If it is not set, '
              '`pose_update_freq` counts.', needs=DRIVEN),
    Parameter('base_frame_id', None, FRAME,
              'The same as `robot_base_frame`, under the name of diff_drive_controller; both set is an error.',
              needs=DRIVEN),
    Parameter('odom_frame_id', None, FRAME,
              'The same as `odom_frame`, under the name of diff_drive_controller; both set is an error.', needs=DRIVEN),
    Parameter('footprint_frame', None, string('the name of a frame, or an empty text for none'),
              'Frame between the odom and the base frame, at the same place as the base frame. If it is not set, it is '
              '`base_footprint`, as with stage_ros, if the base frame is `base_link`; otherwise there is none.',
              needs=DRIVEN),
    Parameter('enable_odom_tf', True, FLAG,
              'Whether the pose in the odom frame is on tf; the name of diff_drive_controller.', needs=DRIVEN),
    Parameter('publish_map_frame', False, FLAG,
              'Whether `global_frame -> odom` is on tf, too, as from a perfect localizer.', needs=DRIVEN),
    Parameter('odom_origin', None, numbers(
        3, 'a list [x, y, yaw] [m, m, rad, global frame], each in -1e9..1e9', COORDINATE),
              'Where the odom frame lies. If it is not set, it lies where the robot starts, as with stage_ros.',
              needs=DRIVEN),
    Parameter('slash_in_headers', False, FLAG,
              'Whether frames in headers of odometry begin with a slash, as those of stage_ros with several robots.',
              needs=DRIVEN),
    Parameter('use_stamped_vel', False, FLAG, 'Whether `cmd_vel` has TwistStamped instead of Twist.', needs=DRIVEN),
    Parameter('initialpose_moves', True, FLAG,
              'Whether a pose on `initialpose` moves the robot there. With a localizer it must not: it is a guess.'),
)

TABLE = (
    Parameter('turn_rate', 0.0, number(low=0.0, unit='rad/s', note='0 = turning takes no time'),
              'Speed of turning in place.'),
    Parameter('start_x', 0.0, COORDINATE, 'Position at the start.'),
    Parameter('start_y', 0.0, COORDINATE, 'Position at the start.'),
    Parameter('start_yaw', 0.0, number(unit='rad, global frame'), 'Heading at the start.'),
    Parameter('global_frame', None, FRAME,
              'Frame of poses, plans and feedback. If it is not set, `global_costmap/global_frame` counts, '
              'then `map`.'),
    Parameter('odom_frame', None, FRAME,
              'Frame of odometry. If it is not set, the first of these counts: `local_costmap/global_frame` if it is '
              'not the global frame, the global frame if its name contains `odom`, `odom`.'),
    Parameter('robot_base_frame', None, FRAME,
              'Frame of the robot, unlike the other two. If it is not set, `global_costmap/robot_base_frame` counts, '
              'then `base_link`.'),
    Parameter('tf_prefix', None, string('a string'),
              'Stands before the odom and the base frame as `PREFIX/`. If it is not set, the `tf_prefix` of a '
              'namespace above counts, then none.'),
    Parameter('feedback_freq', None, number(0.0, 1000.0, unit='Hz, simulated', note='0 = none'),
              'Rate of the feedback. If it is not set, `controller_frequency` counts; with `events_only` it is 0.'),
    Parameter('max_feedback_rate', 50.0, number(0.1, 1000.0, unit='Hz, wall'),
              'Upper limit of the rate of the feedback.'),
    Parameter('pose_update_freq', 10.0,
              number(0.0, 1000.0, unit='Hz, simulated', note='0 = at departure and arrival only'),
              'Rate of the poses on the way; with `events_only` it is 0.'),
    Parameter('odom_rate_at_rest', None, number(0.0, 1000.0, unit='Hz, simulated', note='0 = none'),
              'Rate of odometry and ground truth while the robot stands. If it is not set, `pose_update_freq` counts; '
              'in lockstep it is 0.'),
    Parameter('max_pose_rate', 50.0, number(0.1, 1000.0, unit='Hz, wall'),
              'Upper limit of the rate of poses and of the heartbeat of tf.'),
    Parameter('tf_heartbeat_freq', 10.0, number(0.0, 1000.0, unit='Hz, simulated', note='0 = none'),
              'Rate of the transforms while the robot stands; with `events_only` it is 0.'),
    Parameter('backend', 'builtin', string('the name of a backend'),
              'Where the robot is shown: `builtin`, `stage_ros` or `gazebo`.'),
    Parameter('marker_topic', 'move_base_abstract/markers', BELOW_ROOT,
              'Topic of the markers for RViz, below `/`; robots of one process with the same topic share a message.'),
    Parameter('marker_size', 1.0, number(above=0.0, unit='m', note="the length of a robot's arrow"),
              'Size of the robot in RViz.'),
    Parameter('stage_offset_x', 0.0, position('m', note="the global frame's origin in Stage's world"),
              'With `stage_ros`: where the global frame lies.'),
    Parameter('stage_offset_y', 0.0, position('m', note="the global frame's origin in Stage's world"),
              'With `stage_ros`: where the global frame lies.'),
    Parameter('stage_offset_yaw', 0.0, number(unit='rad', note="the global frame's x axis in Stage's world"),
              'With `stage_ros`: how the global frame is turned.'),
    Parameter('stage_world_frame', None, FRAME, "Frame of Stage's world in tf, instead of the three offsets."),
    Parameter('gazebo_model', None, bare_name("the name of one of Gazebo's models"),
              "The robot's model in Gazebo. If it is not set, the model has the robot's name."),
    Parameter('gazebo_reference_frame', 'world', bare_name("the name of a frame of Gazebo's"),
              'The frame or model in which poses are given to Gazebo.'),
    Parameter('gazebo_z', 0.0, position('m', note="height of the model's origin"),
              'Height at which Gazebo places the robot.'),
    Parameter('log_motion', False, FLAG,
              'In lockstep, the event log has exactly how the robot drives; a namespace above counts, too.'),
    Parameter('bad_frame_policy', 'abort', one_of('abort', 'wait'),
              'A goal whose frame is not known is aborted, or waits for the frame.'),
    Parameter('frame_timeout', 1.0, number(0.0, 60.0, unit='s, wall'),
              'Longest wait for a foreign frame; in lockstep this is simulated time.'),
    Parameter('longest_wait', 86400.0, number(high=2147483647.0, above=0.0, unit='s, simulated'),
              'A goal whose stamp or arrival lies further ahead cannot be reached, and a warning says why.'),
    Parameter('abort_policy', 'fast', one_of('fast', 'upstream'),
              'When a goal that cannot be reached ends: at once, or after the time that upstream takes.'),
    Parameter('status_list_timeout', 5.0, number(low=0.0, unit='s, simulated'),
              'Time for which goals that have ended stay on the status list.'),
    Parameter('min_answer_delay', 0.02, number(0.0, 1.0, unit='s, wall'),
              'The end of a goal is published no sooner than this after the goal came; not used in lockstep.'),
    Parameter('world_bounds', None, numbers(4, 'a list [x_min, y_min, x_max, y_max] [m, global frame]'),
              'Goals outside of this rectangle cannot be reached. If it is not set, there is no limit.'),
    Parameter('use_map', False, FLAG,
              'Whether goals are judged by the map; a map in another frame than `global_frame` is not used.'),
    Parameter('map_topic', None, TOPIC,
              'Topic of the map. If it is not set, that of the global costmap counts, then the name to which `map` is '
              'remapped, then `/map`.'),
    Parameter('allow_unknown', None, FLAG,
              'Whether goals and ways in unknown cells of the map are accepted. If it is not set, they are, unless the '
              "global planner's group has `allow_unknown: false` and the global costmap `track_unknown_space: true`."),
    Parameter('allow_occupied_goals', False, FLAG, 'Whether any goal is accepted, whatever the map says.'),
    Parameter('routes', 'none', one_of(*ROUTES),
              'The way of the robot: straight, around obstacles of the map, along lanes, or as long as a table says.'),
    Parameter('leave_obstacles', False, FLAG,
              'With `routes: grid`: a robot that stands where its centre must not be, or off the map, first goes '
              'straight to the nearest free cell, however far. If false, only within its radius and one cell.'),
    Parameter('lanes', None, PATH, 'The net of lanes for `routes: lanes`.'),
    Parameter('travel_matrix', None, PATH, 'The table of times for `routes: matrix`.'),
    Parameter('priority', 0, INT32,
              'Of robots that wait for a zone or a lane the one with the higher priority comes first.',
              'a whole number of 32 bits'),
    Parameter('corners', 'keep', one_of('keep', 'stop'),
              'Whether the robot keeps its speed at corners of its way, or stops and turns.'),
    Parameter('controller_frequency', 20.0, number(above=0.0, unit='Hz, simulated'),
              'Rate of the feedback, unless `feedback_freq` is set.'),
    Parameter('planner_patience', 5.0, number(low=0.0, unit='s, simulated'),
              'Time for which planning is tried again; only with `abort_policy: upstream`.', needs=_PATIENT),
    Parameter('max_planning_retries', -1, integer(-1),
              'With 0 or more, `planner_patience` does not count; only with `abort_policy: upstream`.', needs=_PATIENT),
    Parameter('recovery_behavior_enabled', True, FLAG,
              'Whether recovery behaviours take their time; only with `abort_policy: upstream`.', needs=_PATIENT),
    Parameter('clearing_rotation_allowed', True, FLAG,
              "Whether the two rotations are among upstream's four recovery behaviours.", needs=_PATIENT),
    Parameter('make_plan_add_unreachable_goal', True, FLAG,
              'Whether a plan to the nearest reachable place ends with the goal itself.'),
    Parameter('base_local_planner', upstream.DEFAULT_LOCAL_PLANNER, string('the name of a plugin'),
              'The last part of this name is used for topics, and for the group that has the speed.'),
    Parameter('base_global_planner', upstream.DEFAULT_GLOBAL_PLANNER, string('the name of a plugin'),
              'The last part of this name is used for topics and a service.'),
    Parameter('seed', 0, integer(0), 'Seed of all draws for the robot.'),
    *DRIVING,
    *SHOWN,
    *DURATIONS,
    *FAILURES,
    *BUGGIFY,
    *BATTERY,
    *LASER,
    Parameter('calibration', None, string('the path of a calibration, or the name of one that ships'),
              'The robot moves like a recorded robot.'),
    Parameter('compatible_with', None, one_of(*PROFILES),
              'Times of legs, and more, are those of the original package; a namespace above counts too.'),
)

LIMITS = (SPEED, ACCELERATION, XY_TOLERANCE, YAW_TOLERANCE)
#: {parameter: (name, value) of another one without which it has no effect}
NEEDS = {**{parameter.name: parameter.needs for parameter in TABLE if parameter.needs}, 'recovery_behaviors': _PATIENT}
OWN_NAMES = tuple(parameter.name for parameter in TABLE + LIMITS) + ('recovery_behaviors', 'footprint', 'robot_radius')
