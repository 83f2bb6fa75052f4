"""The settings of a robot: defaults, sources and their precedence, and the words for what cannot be used."""

import math

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.kinds import number
from move_base_abstract.common.parameter_table import unknown_names
from move_base_abstract.common.shown import shown
from move_base_abstract.config.robot_table import OWN_NAMES
from move_base_abstract.config.settings import read_settings
from move_base_abstract.goals.navigator import BadFramePolicy
from move_base_abstract.goals.recovery import DEFAULT_BEHAVIORS, ROTATION_SECONDS, RecoveryBehavior
from move_base_abstract.maps.planning import WorldBounds
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.leg import MotionLimits, Tolerances

WHERE = '/robot_0/move_base'
POSITIVE = 'a finite number > 0'
NOT_NEGATIVE = 'a finite number >= 0'
DWA, TRAJECTORY = 'DWAPlannerROS', 'TrajectoryPlannerROS'


def settings_of(**raw):
    return read_settings(raw, WHERE)


def refusal_of(raw, where=WHERE):
    with pytest.raises(ConfigurationError) as error:
        read_settings(raw, where)
    return str(error.value)


# ---- defaults and own values

def test_without_any_parameter_everything_has_its_documented_default():
    settings = settings_of()
    assert settings.limits == MotionLimits(0.5, math.inf, math.inf)
    assert settings.tolerances == Tolerances(0.0, 0.0)
    assert (settings.speed_source, settings.acceleration_source) == ('default', 'default')
    assert (settings.start, settings.bounds, settings.tf_prefix) == (Pose2D(), WorldBounds(), None)
    assert settings.bad_frame_policy is BadFramePolicy.ABORT
    assert (settings.recovery.fast, settings.recovery.patience) == (True, 5.0)
    assert settings.recovery.behaviors == DEFAULT_BEHAVIORS
    assert (settings.ignored, settings.warnings) == ([], [])
    expected = {
        'global_frame': 'map', 'odom_frame': 'odom', 'robot_base_frame': 'base_link', 'feedback_freq': 20.0,
        'max_feedback_rate': 50.0, 'pose_update_freq': 10.0, 'max_pose_rate': 50.0, 'tf_heartbeat_freq': 10.0,
        'backend': 'builtin', 'min_answer_delay': 0.02, 'controller_frequency': 20.0,
        'base_local_planner': 'base_local_planner/TrajectoryPlannerROS', 'base_global_planner': 'navfn/NavfnROS'}
    assert {key: settings.values[key] for key in expected} == expected


def test_all_of_a_robots_own_parameters_are_used():
    settings = settings_of(
        max_speed=2, acceleration=0.5, turn_rate=1.5, start_x=1, start_y=-2.5, start_yaw=0.25, xy_goal_tolerance=0.1,
        yaw_goal_tolerance=0.2, tf_prefix='/robot_0/', bad_frame_policy='wait', abort_policy='upstream',
        world_bounds=[-1, -2, 30, 40.5], planner_patience=3.0)
    assert settings.limits == MotionLimits(2.0, 0.5, 1.5)
    assert settings.tolerances == Tolerances(0.1, 0.2)
    assert (settings.speed_source, settings.acceleration_source) == ('~max_speed', '~acceleration')
    assert (settings.start, settings.bounds) == (Pose2D(1.0, -2.5, 0.25), WorldBounds(-1.0, -2.0, 30.0, 40.5))
    assert (settings.tf_prefix, settings.bad_frame_policy) == ('robot_0', BadFramePolicy.WAIT)
    assert (settings.recovery.fast, settings.recovery.patience) == (False, 3.0)
    assert (settings.ignored, settings.warnings) == ([], [])


# ---- where the speed comes from

@pytest.mark.parametrize('raw, speed, source', [
    ({}, 0.5, 'default'),
    ({'max_speed': 3.0}, 3.0, '~max_speed'),
    ({DWA: {'max_vel_x': 0.7}}, 0.7, '~DWAPlannerROS/max_vel_x'),
    ({DWA: {'max_vel_trans': 0.8}}, 0.8, '~DWAPlannerROS/max_vel_trans'),
    ({DWA: {'max_vel_x': 0.7, 'max_vel_trans': 0.8}}, 0.7, '~DWAPlannerROS/max_vel_x'),
    ({TRAJECTORY: {'max_vel_x': 0.6}}, 0.6, '~TrajectoryPlannerROS/max_vel_x'),
    ({DWA: {'max_vel_x': 0.7}, TRAJECTORY: {'max_vel_x': 0.6}}, 0.6, '~TrajectoryPlannerROS/max_vel_x'),
    ({DWA: {'max_vel_x': 0.7}, TRAJECTORY: {'max_vel_x': 0.6}, 'base_local_planner': 'dwa_local_planner/DWAPlannerROS'},
     0.7, '~DWAPlannerROS/max_vel_x'),
    ({DWA: {'max_vel_y': 0.1}, TRAJECTORY: {'max_vel_x': 0.6}, 'base_local_planner': 'dwa_local_planner/DWAPlannerROS'},
     0.55, 'default of DWAPlannerROS'),
    ({'TebLocalPlannerROS': {'max_vel_x': 0.4}, DWA: {'max_vel_x': 0.7},
      'base_local_planner': 'teb_local_planner/TebLocalPlannerROS'}, 0.4, '~TebLocalPlannerROS/max_vel_x'),
    ({'TebLocalPlannerROS': {'max_vel_x': 0.4}}, 0.5, 'default'),
    ({'max_speed': 3.0, DWA: {'max_vel_x': 0.7}, TRAJECTORY: {'max_vel_x': 0.6}}, 3.0, '~max_speed'),
    ({DWA: 'not a group'}, 0.5, 'default')])
def test_the_speed_is_the_robots_own_else_the_local_planners_else_the_default(raw, speed, source):
    settings = read_settings(raw, WHERE)
    assert (settings.limits.max_speed, settings.speed_source) == (speed, source)


@pytest.mark.parametrize('raw, acceleration, source', [
    ({}, math.inf, 'default'),
    ({'acceleration': 0}, math.inf, '~acceleration'),
    ({'acceleration': 2.0, DWA: {'acc_lim_x': 1.0}}, 2.0, '~acceleration'),
    ({'acceleration': 0.0, DWA: {'acc_lim_x': 1.0}}, math.inf, '~acceleration'),
    ({DWA: {'acc_lim_x': 1.0}}, 1.0, '~DWAPlannerROS/acc_lim_x'),
    ({TRAJECTORY: {'acc_lim_x': 2.5}}, 2.5, '~TrajectoryPlannerROS/acc_lim_x'),
    ({DWA: {'acc_lim_x': 1.0}, TRAJECTORY: {'acc_lim_x': 2.5}}, 2.5, '~TrajectoryPlannerROS/acc_lim_x')])
def test_the_acceleration_is_the_robots_own_else_the_local_planners_else_unlimited(raw, acceleration, source):
    settings = read_settings(raw, WHERE)
    assert (settings.limits.acceleration, settings.acceleration_source) == (acceleration, source)


@pytest.mark.parametrize('raw, tolerances', [
    ({DWA: {'xy_goal_tolerance': 0.2, 'yaw_goal_tolerance': 0.1}}, Tolerances(0.2, 0.1)),
    ({'xy_goal_tolerance': 0.0, DWA: {'xy_goal_tolerance': 0.2, 'yaw_goal_tolerance': 0.1}}, Tolerances(0.0, 0.1))])
def test_tolerances_are_the_robots_own_else_the_local_planners(raw, tolerances):
    assert read_settings(raw, WHERE).tolerances == tolerances


def test_speed_and_acceleration_may_come_from_different_places():
    settings = settings_of(max_speed=2.0, DWAPlannerROS={'acc_lim_x': 1.0, 'max_vel_x': 0.5})
    assert (settings.speed_source, settings.acceleration_source) == ('~max_speed', '~DWAPlannerROS/acc_lim_x')
    assert settings.limits == MotionLimits(2.0, 1.0)


# ---- frames, feedback, recovery

def test_frames_are_the_robots_own_else_the_costmaps_without_a_leading_slash():
    costmap = {'global_frame': '/world', 'robot_base_frame': 'base_footprint'}
    values = settings_of(global_costmap=costmap).values
    assert (values['global_frame'], values['robot_base_frame']) == ('world', 'base_footprint')
    values = settings_of(global_costmap=costmap, global_frame='/field', robot_base_frame='chassis').values
    assert (values['global_frame'], values['robot_base_frame']) == ('field', 'chassis')


ODOM, MAP = {'global_frame': 'odom'}, {'global_frame': 'map'}


@pytest.mark.parametrize('raw, global_frame, odom_frame', [
    ({}, 'map', 'odom'), ({'global_costmap': ODOM}, 'odom', 'odom'),
    ({'global_costmap': ODOM, 'local_costmap': ODOM}, 'odom', 'odom'), ({'global_frame': '/odom'}, 'odom', 'odom'),
    ({'global_costmap': MAP, 'local_costmap': MAP}, 'map', 'odom'),
    ({'global_costmap': MAP, 'local_costmap': {'global_frame': 'odom_wheels'}}, 'map', 'odom_wheels'),
    ({'global_costmap': {'global_frame': 'odom_combined'}}, 'odom_combined', 'odom_combined'),
    ({'global_costmap': {'global_frame': 'r/odom'}, 'local_costmap': {'global_frame': 'r/odom'}}, 'r/odom', 'r/odom'),
    ({'global_costmap': {'global_frame': 'r/odom'}, 'tf_prefix': 'r'}, 'r/odom', 'r/odom'),
    ({'global_costmap': ODOM, 'tf_prefix': 'r'}, 'odom', 'r/odom'),
    ({'global_costmap': ODOM, 'odom_frame': 'wheels'}, 'odom', 'wheels')])
def test_without_a_map_the_odometrys_frame_is_the_global_one(raw, global_frame, odom_frame):
    settings = read_settings(raw, WHERE)
    assert (settings.values['global_frame'], settings.odom_frame) == (global_frame, odom_frame)


@pytest.mark.parametrize('raw', [{'robot_base_frame': 'odom'}, {'robot_base_frame': 'map'},
                                 {'global_costmap': {'global_frame': 'base_link'}}])
def test_a_robot_has_a_frame_of_its_own(raw):
    assert refusal_of(raw).startswith('parameter /robot_0/move_base/robot_base_frame: got ')


@pytest.mark.parametrize('prefix, frame_id, prefixed', [
    (None, 'odom', 'odom'), ('', 'odom', 'odom'), ('robot_0', 'odom', 'robot_0/odom'),
    ('/robot_0/', 'odom', 'robot_0/odom'), ('robot_0', 'robot_0/odom', 'robot_0/odom'),
    ('robot_0', 'robot_01', 'robot_0/robot_01')])
def test_a_tf_prefix_is_put_once(prefix, frame_id, prefixed):
    settings = settings_of() if prefix is None else settings_of(tf_prefix=prefix)
    assert settings.frame(frame_id) == prefixed


@pytest.mark.parametrize('raw, frequency', [
    ({'controller_frequency': 5.0}, 5.0), ({'controller_frequency': 5.0, 'feedback_freq': 0}, 0.0),
    ({'feedback_freq': 100}, 100.0)])
def test_feedback_comes_at_its_own_frequency_else_at_the_controllers(raw, frequency):
    assert read_settings(raw, WHERE).values['feedback_freq'] == frequency


@pytest.mark.parametrize('raw, patience, behaviors', [
    ({'recovery_behavior_enabled': False}, 5.0, ()),
    ({'max_planning_retries': 0}, 0.0, DEFAULT_BEHAVIORS),
    ({'max_planning_retries': -1, 'planner_patience': 2}, 2.0, DEFAULT_BEHAVIORS),
    ({'recovery_behaviors': []}, 5.0, ()),
    ({'recovery_behaviors': [{'name': 'spin', 'type': 'rotate_recovery/RotateRecovery'},
                             {'name': 'clear', 'type': 'clear_costmap_recovery/ClearCostmapRecovery'}]},
     5.0, (RecoveryBehavior('spin', ROTATION_SECONDS), RecoveryBehavior('clear'))),
    ({'max_planning_retries': -1.0}, 5.0, DEFAULT_BEHAVIORS), ({'max_planning_retries': 2.0}, 0.0, DEFAULT_BEHAVIORS),
    ({'clearing_rotation_allowed': False}, 5.0,
     (RecoveryBehavior('conservative_reset'), RecoveryBehavior('aggressive_reset'))),
    ({'clearing_rotation_allowed': False, 'recovery_behaviors': [{'name': 'spin', 'type': 'x/RotateRecovery'}]},
     5.0, (RecoveryBehavior('spin', ROTATION_SECONDS),))])
def test_recovery_follows_move_bases_own_parameters(raw, patience, behaviors):
    recovery = read_settings(raw, WHERE).recovery
    assert (recovery.patience, recovery.behaviors) == (patience, behaviors)


# ---- what cannot be used

FIELDS = [
    ('max_speed', 0.0, POSITIVE + ' [m/s]'), ('max_speed', -1, POSITIVE + ' [m/s]'),
    ('acceleration', -0.1, NOT_NEGATIVE + ' [m/s^2], 0 = unlimited'),
    ('turn_rate', -0.1, NOT_NEGATIVE + ' [rad/s], 0 = turning takes no time'),
    ('xy_goal_tolerance', -0.1, NOT_NEGATIVE + ' [m]'), ('yaw_goal_tolerance', -0.1, NOT_NEGATIVE + ' [rad]'),
    ('start_x', None, 'a number in -1e9..1e9 [m, global frame]'),
    ('start_y', 1e308, 'a number in -1e9..1e9 [m, global frame]'),
    ('start_yaw', {'a': 1}, 'a finite number [rad, global frame]'),
    ('global_frame', '', 'a frame name'), ('odom_frame', '/', 'a frame name'), ('robot_base_frame', 7, 'a frame name'),
    ('tf_prefix', 3, 'a string'), ('backend', 3, 'the name of a backend'),
    ('feedback_freq', -1.0, 'a number in 0..1000 [Hz, simulated], 0 = none'),
    ('feedback_freq', 1001, 'a number in 0..1000 [Hz, simulated], 0 = none'),
    ('max_feedback_rate', 0.0, 'a number in 0.1..1000 [Hz, wall]'),
    ('pose_update_freq', -1, 'a number in 0..1000 [Hz, simulated], 0 = at departure and arrival only'),
    ('max_pose_rate', 0, 'a number in 0.1..1000 [Hz, wall]'),
    ('tf_heartbeat_freq', -5, 'a number in 0..1000 [Hz, simulated], 0 = none'),
    ('bad_frame_policy', 'ignore', "'abort' or 'wait'"), ('bad_frame_policy', ['abort'], "'abort' or 'wait'"),
    ('abort_policy', 'slow', "'fast' or 'upstream'"), ('abort_policy', True, "'fast' or 'upstream'"),
    ('frame_timeout', -1.0, 'a number in 0..60 [s, wall]'), ('min_answer_delay', 1.1, 'a number in 0..1 [s, wall]'),
    ('world_bounds', [0, 0, 1], 'a list [x_min, y_min, x_max, y_max] [m, global frame]'),
    ('world_bounds', [0, 0, 1, '1'], 'a list [x_min, y_min, x_max, y_max] [m, global frame]'),
    ('world_bounds', [0, 0, 1, math.inf], 'a list [x_min, y_min, x_max, y_max] [m, global frame]'),
    ('world_bounds', '0 0 1 1', 'a list [x_min, y_min, x_max, y_max] [m, global frame]'),
    ('controller_frequency', 0.0, POSITIVE + ' [Hz, simulated]'),
    ('planner_patience', -1.0, NOT_NEGATIVE + ' [s, simulated]'),
    ('max_planning_retries', -2, 'a whole number >= -1'), ('max_planning_retries', 1.5, 'a whole number >= -1'),
    ('max_planning_retries', True, 'a whole number >= -1'),
    ('recovery_behavior_enabled', 1, 'true or false'), ('make_plan_add_unreachable_goal', 'yes', 'true or false'),
    ('base_local_planner', 1, 'the name of a plugin'), ('base_global_planner', None, 'the name of a plugin'),
    ('status_list_timeout', -1.0, NOT_NEGATIVE + ' [s, simulated]'), ('marker_topic', '', 'a topic name'),
    ('marker_size', 0, POSITIVE + " [m], the length of a robot's arrow"),
    ('gazebo_model', 3, "the name of one of Gazebo's models"),
    ('recovery_behaviors', 'none', 'a list of {name, type}'), ('recovery_behaviors', 3, 'a list of {name, type}'),
    ('recovery_behaviors', [{'name': 'spin'}], 'a list of {name, type}')]


@pytest.mark.parametrize('key, value, allowed', FIELDS)
def test_an_impossible_value_is_refused_with_key_namespace_value_and_what_is_allowed(key, value, allowed):
    assert refusal_of({key: value}) == 'parameter /robot_0/move_base/{}: got {!r}; allowed: {}'.format(
        key, value, allowed)


NUMBERS = ('max_speed', 'acceleration', 'xy_goal_tolerance', 'yaw_goal_tolerance', 'turn_rate', 'start_x', 'start_y',
           'start_yaw', 'feedback_freq', 'max_feedback_rate', 'pose_update_freq', 'max_pose_rate', 'tf_heartbeat_freq',
           'frame_timeout', 'min_answer_delay', 'controller_frequency', 'planner_patience')


@pytest.mark.parametrize('key', NUMBERS)
@pytest.mark.parametrize('value', [math.nan, math.inf, -math.inf, True, False, '1.0',
                                   pytest.param(10 ** 400, id='huge')])
def test_no_number_may_be_nan_infinite_a_bool_a_text_or_beyond_all_floats(key, value):
    assert refusal_of({key: value}).startswith('parameter {}/{}: got {}; allowed: a '.format(WHERE, key, shown(value)))


@pytest.mark.parametrize('key', ['max_planning_retries', 'recovery_behavior_enabled'])
@pytest.mark.parametrize('value', [math.nan, '1', None])
def test_neither_whole_numbers_nor_booleans_are_guessed(key, value):
    assert refusal_of({key: value}).startswith('parameter {}/{}: got {!r}; allowed: '.format(WHERE, key, value))


@pytest.mark.parametrize('raw, key', [
    ({DWA: {'max_vel_x': -0.5}}, 'DWAPlannerROS/max_vel_x'),
    ({DWA: {'max_vel_trans': '1'}}, 'DWAPlannerROS/max_vel_trans'),
    ({TRAJECTORY: {'max_vel_x': 0.0}}, 'TrajectoryPlannerROS/max_vel_x'),
    ({TRAJECTORY: {'acc_lim_x': -1.0}}, 'TrajectoryPlannerROS/acc_lim_x'),
    ({DWA: {'xy_goal_tolerance': math.nan}}, 'DWAPlannerROS/xy_goal_tolerance'),
    ({'global_costmap': {'global_frame': 5}}, 'global_costmap/global_frame')])
def test_a_bad_value_that_was_taken_from_a_planner_or_costmap_is_named_with_its_whole_path(raw, key):
    assert refusal_of(raw).startswith('parameter {}/{}: got '.format(WHERE, key))


def test_a_planners_bad_value_does_not_matter_where_the_robot_has_its_own():
    assert settings_of(max_speed=1.0, DWAPlannerROS={'max_vel_x': 'fast'}).limits.max_speed == 1.0


def test_bounds_without_an_inside_are_refused_with_their_key():
    assert refusal_of({'world_bounds': [5, 0, 1, 1]}) == (
        'parameter /robot_0/move_base/world_bounds: bounds must be [x_min, y_min, x_max, y_max] with x_min < x_max '
        'and y_min < y_max, got [5.0, 0.0, 1.0, 1.0]')


def test_a_namespace_that_is_a_value_is_refused():
    assert refusal_of(3.5) == '/robot_0/move_base: got 3.5; allowed: a namespace of parameters'


def test_a_slash_at_the_namespaces_end_is_not_doubled():
    assert refusal_of({'start_x': None}, '/a/').startswith('parameter /a/start_x: ')


# ---- names that are not ours

@pytest.mark.parametrize('key, hint', [
    ('max_sped', "; did you mean 'max_speed'?"), ('Acceleration', "; did you mean 'acceleration'?"),
    ('controler_patience', "; did you mean 'controller_patience'?"),
    ('dwa_planner_ros', ''), ('zzz', '')])
def test_an_unknown_name_gets_a_warning_with_the_name_it_is_most_like(key, hint):
    settings = read_settings({key: 1.0}, WHERE)
    assert settings.warnings == ['parameter /robot_0/move_base/{}: unknown, not used{}'.format(key, hint)]
    assert settings.ignored == []


def test_unknown_names_come_in_alphabetical_order():
    warnings = unknown_names({'b': 1, 'a': 2, 'known': 3}, ('known',), '/n')
    assert warnings == ['parameter /n/a: unknown, not used', 'parameter /n/b: unknown, not used']


def test_upstreams_parameters_are_ignored_one_by_one_and_those_in_use_are_not_counted():
    settings = settings_of(
        planner_frequency=1.0, oscillation_timeout=10.0, footprint=[[0, 0], [1, 0], [1, 1]],
        base_local_planner='dwa_local_planner/DWAPlannerROS',
        DWAPlannerROS={'max_vel_x': 0.7, 'acc_lim_x': 1.0, 'acc_lim_y': 0.0, 'xy_goal_tolerance': 0.1,
                       'yaw_goal_tolerance': 0.2, 'sim_time': 1.7},
        global_costmap={'global_frame': 'map', 'robot_base_frame': 'base_link', 'inflation': {'radius': 0.5}})
    assert settings.ignored == ['DWAPlannerROS/acc_lim_y', 'DWAPlannerROS/sim_time',
                                'global_costmap/inflation/radius', 'oscillation_timeout', 'planner_frequency']
    assert settings.warnings == []


def test_a_planners_value_that_is_overruled_counts_as_ignored():
    settings = settings_of(max_speed=2.0, xy_goal_tolerance=0.1, global_frame='world',
                           DWAPlannerROS={'max_vel_x': 0.7, 'xy_goal_tolerance': 0.2},
                           global_costmap={'global_frame': 'map'})
    assert settings.ignored == ['DWAPlannerROS/max_vel_x', 'DWAPlannerROS/xy_goal_tolerance',
                                'global_costmap/global_frame']


def test_every_parameter_of_move_bases_own_is_known():
    upstreams = {'planner_frequency': 0.0, 'controller_frequency': 20.0, 'planner_patience': 5.0,
                 'controller_patience': 15.0, 'max_planning_retries': -1, 'oscillation_timeout': 0.0,
                 'oscillation_distance': 0.5, 'make_plan_clear_costmap': True, 'make_plan_add_unreachable_goal': True,
                 'shutdown_costmaps': False, 'clearing_rotation_allowed': True, 'recovery_behavior_enabled': True,
                 'conservative_reset_dist': 3.0, 'restore_defaults': False, 'base_global_planner': 'navfn/NavfnROS',
                 'base_local_planner': 'dwa_local_planner/DWAPlannerROS', 'NavfnROS': {}, 'GlobalPlanner': {},
                 'conservative_reset': {}, 'aggressive_reset': {}, 'rotate_recovery': {}, 'local_costmap': {}}
    assert settings_of(**upstreams).warnings == []


def test_the_groups_of_other_plugins_and_recovery_behaviours_are_known_by_their_names():
    settings = settings_of(base_local_planner='my_planners::Careful', base_global_planner='my_planners/Wide',
                           recovery_behaviors=[{'name': 'back_up', 'type': 'x/BackUp'}],
                           Careful={'gain': 1}, Wide={'cost': 2}, back_up={'distance': 3}, Other={'gain': 1})
    assert (settings.local_planner, settings.global_planner) == ('Careful', 'Wide')
    assert settings.ignored == ['Careful/gain', 'Wide/cost', 'back_up/distance', 'recovery_behaviors']
    assert (settings.needs, settings.unknown) == ({'recovery_behaviors': 'abort_policy: upstream'}, ['Other/gain'])
    assert settings.warnings == ['parameter /robot_0/move_base/Other: unknown, not used']


@pytest.mark.parametrize(('planner', 'costmap', 'own', 'expected'), [
    ({'allow_unknown': False}, {'track_unknown_space': True}, {}, False), ({}, {'track_unknown_space': True}, {}, True),
    ({'allow_unknown': False}, {}, {}, True), ({}, {}, {'allow_unknown': False}, False),
    ({'allow_unknown': False}, {'track_unknown_space': True}, {'allow_unknown': True}, True)])
def test_unknown_cells_are_free_as_the_global_planner_and_its_costmap_say(planner, costmap, own, expected):
    for name, plugin in (('NavfnROS', {}), ('GlobalPlanner', {'base_global_planner': 'global_planner/GlobalPlanner'})):
        settings = settings_of(use_map=True, global_costmap=costmap, **{name: planner}, **plugin, **own)
        assert settings.values['allow_unknown'] is expected
        assert settings_of(global_costmap=costmap, **{name: planner}, **plugin).ignored == [
            *(f'{name}/{key}' for key in planner), *(f'global_costmap/{key}' for key in costmap)]  # there is no map


def test_only_navfn_has_a_tolerance_for_goals_and_only_ways_on_a_map_need_it():
    on_map, group = {'use_map': True, 'routes': 'grid'}, {'default_tolerance': 0.5}
    assert settings_of(NavfnROS=group, **on_map).plan_tolerance == 0.5
    other = settings_of(GlobalPlanner=group, base_global_planner='global_planner/GlobalPlanner', **on_map)
    assert (other.plan_tolerance, other.ignored) == (0.0, ['GlobalPlanner/default_tolerance'])
    straight = settings_of(NavfnROS=group)
    assert (straight.plan_tolerance, straight.ignored) == (0.0, ['NavfnROS/default_tolerance'])


# ---- the table itself

def test_each_of_our_names_stands_for_one_parameter():
    assert len(set(OWN_NAMES)) == len(OWN_NAMES)


def test_numbers_become_floats_and_their_limits_belong_to_them():
    values = [number(0.0, 2.0)(value) for value in (0, 1, 2.0)]
    assert (values, [type(value) for value in values]) == ([0.0, 1.0, 2.0], [float] * 3)
    for bad in (-0.1, 2.1):
        with pytest.raises(ValueError):
            number(0.0, 2.0)(bad)
    with pytest.raises(ValueError):
        number(above=1.0)(1.0)
    assert number(above=1.0)(1.5) == 1.5
