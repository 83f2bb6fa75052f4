"""The limits in the groups of local planners: those of many planners, old names, and what is not understood."""
import pytest

from move_base_abstract.config.local_planner import SpeedNames
from move_base_abstract.config.settings import read_settings
from move_base_abstract.motion.leg import Tolerances

WHERE = '/robot_0/move_base'
DWA, TEB, EBAND, MPC, FTC = 'DWAPlannerROS', 'TebLocalPlannerROS', 'EBandPlannerROS', 'MpcLocalPlannerROS', 'FTCPlanner'


def settings_with(planner, group, **others):
    """Return the settings of a set-up whose base_local_planner is ``planner``."""
    return read_settings({'base_local_planner': 'some_package/' + planner, planner: group, **others}, WHERE)


def speed_of(planner, group, **others):
    settings = settings_with(planner, group, **others)
    return settings.limits.max_speed, settings.speed_source


# ---- which speed counts

@pytest.mark.parametrize('group, speed, name', [
    ({'max_vel_x': 1.0, 'max_vel_trans': 0.5}, 0.5, 'max_vel_trans'),
    ({'max_vel_x': 0.5, 'max_vel_trans': 1.0}, 0.5, 'max_vel_x'),
    ({'max_vel_x': 1.0}, 1.0, 'max_vel_x'), ({'max_vel_trans': 0.8}, 0.8, 'max_vel_trans')])
def test_the_smaller_of_dwas_two_speeds_counts(group, speed, name):
    assert speed_of(DWA, group) == (speed, '~DWAPlannerROS/' + name)


@pytest.mark.parametrize('planner, default', [
    (DWA, 0.55), ('TrajectoryPlannerROS', 0.55), (TEB, 0.4), (EBAND, 0.75), ('PoseFollower', 0.9), (MPC, 0.4)])
def test_a_named_planner_without_a_speed_has_its_own_default_whatever_other_groups_say(planner, default):
    left_over = {name: {'max_vel_x': 7.0} for name in (DWA, 'TrajectoryPlannerROS') if name != planner}
    for group in ({}, {'max_vel_theta': 0.3}):
        settings = settings_with(planner, group, **left_over)
        assert (settings.limits.max_speed, settings.speed_source) == (default, 'default of ' + planner)
        assert settings.warnings == []
    settings = read_settings({'base_local_planner': 'some_package/' + planner, **left_over}, WHERE)
    assert settings.limits.max_speed == default


def test_left_over_groups_give_no_other_limit_either():
    left_over = {'max_vel_x': 7.0, 'acc_lim_x': 9.0, 'xy_goal_tolerance': 3.0, 'yaw_goal_tolerance': 2.0}
    settings = settings_with(TEB, {'max_vel_x': 0.3}, DWAPlannerROS=left_over)
    assert (settings.acceleration_source, settings.tolerances) == ('default', Tolerances(0.0, 0.0))
    assert settings.ignored == ['DWAPlannerROS/' + name for name in sorted(left_over)]


@pytest.mark.parametrize('group, speed', [
    ({'max_vel_x': 0.6, 'max_vel_trans': 0.0}, 0.6), ({'max_vel_x': 0.6, 'max_vel_trans': 0.3}, 0.3),
    ({'max_vel_trans': 0.6}, 0.4), ({'max_vel_trans': 0.2}, 0.2)])
def test_tebs_max_vel_trans_limits_its_max_vel_x_unless_it_is_0(group, speed):
    assert speed_of(TEB, group)[0] == speed


# ---- other planners' names

@pytest.mark.parametrize('planner, group, speed, acceleration, tolerances', [
    (TEB, {'max_vel_x': 0.3, 'acc_lim_x': 0.6, 'xy_goal_tolerance': 0.2, 'yaw_goal_tolerance': 0.1}, 0.3, 0.6,
     Tolerances(0.2, 0.1)),
    (EBAND, {'max_vel_lin': 0.3, 'max_translational_acceleration': 0.6, 'xy_goal_tolerance': 0.2,
             'yaw_goal_tolerance': 0.1, 'max_acceleration': 5.0, 'max_vel_th': 1.0}, 0.3, 0.6, Tolerances(0.2, 0.1)),
    ('PoseFollower', {'max_vel_lin': 0.3, 'tolerance_trans': 0.2, 'tolerance_rot': 0.1}, 0.3, float('inf'),
     Tolerances(0.2, 0.1)),
    (MPC, {'robot': {'type': 'simple_car', 'simple_car': {'max_vel_x': 0.3, 'acc_lim_x': 0.6},
                     'unicycle': {'max_vel_x': 4.0}},
           'controller': {'xy_goal_tolerance': 0.2, 'yaw_goal_tolerance': 0.1}}, 0.3, 0.6, Tolerances(0.2, 0.1)),
    (FTC, {'max_x_vel': 0.3, 'acceleration_x': 0.6, 'position_accuracy': 0.2, 'rotation_accuracy': 0.1,
           'max_rotation_vel': 0.8}, 0.3, 0.6, Tolerances(0.2, 0.1)),
    (FTC, {'speed_fast': 0.4, 'speed_slow': 0.1, 'max_cmd_vel_speed': 0.3, 'acceleration': 0.6,
           'max_goal_distance_error': 0.2}, 0.3, 0.6, Tolerances(0.2, 0.0)),
    ('MyPlanner', {'max_vel_x': 0.3, 'acc_lim_x': 0.6, 'xy_goal_tolerance': 0.2, 'yaw_goal_tolerance': 0.1}, 0.3, 0.6,
     Tolerances(0.2, 0.1))])
def test_limits_are_found_under_the_names_of_each_planner(planner, group, speed, acceleration, tolerances):
    settings = settings_with(planner, group)
    assert (settings.limits.max_speed, settings.limits.acceleration) == (speed, acceleration)
    assert settings.tolerances == tolerances
    assert settings.warnings == []


def test_mpcs_robot_is_a_unicycle_where_it_does_not_say():
    assert speed_of(MPC, {'robot': {'unicycle': {'max_vel_x': 0.3}}}) == (
        0.3, '~MpcLocalPlannerROS/robot/unicycle/max_vel_x')


# ---- what is not understood is named

def test_what_looks_like_a_limit_and_is_not_understood_is_named():
    settings = settings_with('Careful', {
        'gain': 1.0, 'cruise_speed': 0.3, 'limits': {'forward_vel': 2.0}, 'top_acceleration': 1.0,
        'goal_tolerance': 0.3, 'yaw_accuracy': 0.2, 'max_rot_vel': 1.0, 'min_speed': 0.1})
    assert (settings.limits.max_speed, settings.speed_source) == (0.5, 'default')
    found = [('speed', '0.5', 'cruise_speed, limits/forward_vel'), ('acceleration', '0', 'top_acceleration'),
             ('xy tolerance', '0', 'goal_tolerance'), ('yaw tolerance', '0', 'yaw_accuracy')]
    assert len(settings.warnings) == len(found)
    for warning, (kind, value, names) in zip(settings.warnings, found):
        assert warning.startswith('parameter /robot_0/move_base/Careful: no {} is found'.format(kind))
        assert warning.endswith('the default is used: {}; found and not understood: {}'.format(value, names))


def test_a_known_planners_mistyped_speed_is_named_beside_its_default():
    settings = settings_with(TEB, {'max_vel': 1.0})
    assert settings.warnings == [
        'parameter /robot_0/move_base/TebLocalPlannerROS: no speed is found (known here: max_vel_x, max_vel_trans), '
        'the default of TebLocalPlannerROS is used: 0.4; found and not understood: max_vel']


def test_nothing_is_said_of_a_planners_names_where_the_robot_has_its_own_limits():
    own = {'max_speed': 1.0, 'acceleration': 1.0, 'xy_goal_tolerance': 0.1, 'yaw_goal_tolerance': 0.1}
    group = {'cruise_speed': 0.3, 'top_acceleration': 1.0, 'goal_tolerance': 0.3, 'yaw_accuracy': 0.2}
    assert settings_with('Careful', group, **own).warnings == []


# ---- names of earlier releases

def test_dwas_old_names_are_noticed_and_its_old_speed_counts():
    settings = settings_with(DWA, {'max_vel_x': 0.9, 'max_trans_vel': 0.5, 'max_rot_vel': 1.0})
    assert (settings.limits.max_speed, settings.speed_source) == (0.5, '~DWAPlannerROS/max_trans_vel')
    assert settings.speeds == {'max_vel_x': 0.9, 'max_vel_trans': 0.5}
    [warning] = settings.warnings
    assert warning.endswith('does not read: max_trans_vel (now max_vel_trans), max_rot_vel (now max_vel_theta, not '
                            'used here)')


def test_an_old_name_gives_way_to_the_present_one():
    assert speed_of(DWA, {'max_vel_trans': 0.8, 'max_trans_vel': 0.5}) == (0.8, '~DWAPlannerROS/max_vel_trans')


# ---- the two names of the speed in dynamic_reconfigure

def test_of_two_speeds_that_were_set_the_smaller_one_counts():
    names = SpeedNames.of(0.5, {'max_vel_x': 1.0, 'max_vel_trans': 0.5})
    assert names.shown() == {'max_vel_x': 1.0, 'max_vel_trans': 0.5}
    assert names.changed({'max_vel_x': 2.0, 'max_vel_trans': 0.5}).speed == 0.5
    assert names.changed({'max_vel_x': 1.0, 'max_vel_trans': 3.0}).speed == 1.0
    assert names.changed(names.shown()) is names


def test_a_speed_that_nobody_set_shows_the_other_one_and_limits_nothing():
    names = SpeedNames.of(0.7, {'max_vel_x': 0.7}).changed({'max_vel_x': 2.0, 'max_vel_trans': 0.7})
    assert (names.speed, names.shown()) == (2.0, {'max_vel_x': 2.0, 'max_vel_trans': 2.0})
    names = names.changed({'max_vel_x': 2.0, 'max_vel_trans': 1.5})
    assert (names.speed, names.shown()) == (1.5, {'max_vel_x': 2.0, 'max_vel_trans': 1.5})
