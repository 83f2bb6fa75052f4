"""The parameter names of existing move_base set-ups, so that they are not taken for mistakes."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Dict, Optional, Tuple

#: parameters of move_base itself that have no meaning without costmaps and controllers
IGNORED_NAMES = (
    'NavfnROS', 'GlobalPlanner', 'CarrotPlanner', 'DWAPlannerROS', 'TrajectoryPlannerROS', 'TebLocalPlannerROS',
    'EBandPlannerROS', 'global_costmap', 'local_costmap', 'conservative_reset', 'aggressive_reset',
    'PoseFollower', 'MpcLocalPlannerROS', 'FTCPlanner',
    'rotate_recovery', 'conservative_reset_dist', 'controller_patience',
    'planner_frequency', 'shutdown_costmaps', 'oscillation_timeout', 'oscillation_distance',
    'make_plan_clear_costmap', 'restore_defaults', 'use_grid_path', 'footprint', 'robot_radius', 'footprint_padding',
    'transform_tolerance', 'latch_xy_goal_tolerance')


@dataclass(frozen=True)
class LocalPlanner:
    """The names of a local planner's limits, below its own namespace.

    ``speed`` [m/s]: of all that are set, the smallest counts. ``acceleration`` [m/s^2], ``xy_tolerance`` [m],
    ``yaw_tolerance`` [rad]: the first that is set counts. ``default_speed`` [m/s]: the planner's own default, if it is
    known; if the ``leading`` speed is not set, it counts beside the others. ``zero_is_unset``: speeds for which 0 means
    not set. ``renamed``: {old name: present name}. ``{robot}`` stands for the group's kind of robot.
    """

    speed: Tuple[str, ...] = ('max_vel_x',)
    acceleration: Tuple[str, ...] = ('acc_lim_x',)
    xy_tolerance: Tuple[str, ...] = ('xy_goal_tolerance',)
    yaw_tolerance: Tuple[str, ...] = ('yaw_goal_tolerance',)
    default_speed: Optional[float] = None
    leading: Optional[str] = None
    zero_is_unset: Tuple[str, ...] = ()
    renamed: Dict[str, str] = field(default_factory=dict)

    def names(self) -> Tuple[Tuple[str, ...], ...]:
        """Return all tuples of names."""
        return self.speed, self.acceleration, self.xy_tolerance, self.yaw_tolerance


#: names and defaults as in navigation 1.17, teb_local_planner 0.9, eband_local_planner 0.4, pose_follower 0.4,
#: mpc_local_planner 0.0; FTCPlanner is the name of two planners (asr_ftc_local_planner, ftc_local_planner)
LOCAL_PLANNERS = {
    'DWAPlannerROS': LocalPlanner(
        speed=('max_vel_x', 'max_vel_trans', 'max_trans_vel'), default_speed=0.55, renamed={
            'max_trans_vel': 'max_vel_trans', 'min_trans_vel': 'min_vel_trans', 'max_rot_vel': 'max_vel_theta',
            'min_rot_vel': 'min_vel_theta', 'acc_limit_trans': 'acc_lim_trans',
            'rot_stopped_vel': 'theta_stopped_vel'}),
    'TrajectoryPlannerROS': LocalPlanner(default_speed=0.55),
    'TebLocalPlannerROS': LocalPlanner(speed=('max_vel_x', 'max_vel_trans'), default_speed=0.4, leading='max_vel_x',
                                       zero_is_unset=('max_vel_trans',)),
    'EBandPlannerROS': LocalPlanner(speed=('max_vel_lin',), acceleration=('max_translational_acceleration',),
                                    default_speed=0.75),
    'PoseFollower': LocalPlanner(speed=('max_vel_lin',), acceleration=(), xy_tolerance=('tolerance_trans',),
                                 yaw_tolerance=('tolerance_rot',), default_speed=0.9),
    'MpcLocalPlannerROS': LocalPlanner(
        speed=('{robot}/max_vel_x',), acceleration=('{robot}/acc_lim_x',),
        xy_tolerance=('controller/xy_goal_tolerance',),
        yaw_tolerance=('controller/yaw_goal_tolerance',), default_speed=0.4),
    'FTCPlanner': LocalPlanner(
        speed=('max_x_vel', 'speed_fast', 'max_cmd_vel_speed'), acceleration=('acceleration_x', 'acceleration'),
        xy_tolerance=('position_accuracy', 'max_goal_distance_error'), yaw_tolerance=('rotation_accuracy',)),
}
OTHER_PLANNER = LocalPlanner(speed=('max_vel_x', 'max_vel_trans', 'max_vel_lin'))
MPC_DEFAULT_ROBOT = 'unicycle'

#: {global planner: (its parameter for unknown cells, that for places near a goal or None)}; GlobalPlanner reads
#: default_tolerance, too, but does not use it
GLOBAL_PLANNERS = {'NavfnROS': ('allow_unknown', 'default_tolerance'), 'GlobalPlanner': ('allow_unknown', None)}

#: the planners if base_local_planner is not set: move_base's own default, then another one that may have a group
UNNAMED_PLANNERS = ('TrajectoryPlannerROS', 'DWAPlannerROS')

#: words in the names of parameters that limit something other than forward motion, or limit nothing
NOT_FORWARD = ('theta', 'th', r'rot\w*', r'ang\w*', 'y', 'z', 'yaw', r'backwards?', 'in_place', r'steer\w*')
NOT_LIMITS = ('min', 'weight', 'stopped', 'latch', 'transform', 'sim', 'ratio', 'samples', 'topic', 'threshold',
              'timeout', 'penalty', 'multiplier', 'scale', 'scaling', 'scoring', 'eps', 'epsilon', 'escape', 'backup')

DEFAULT_LOCAL_PLANNER = 'base_local_planner/TrajectoryPlannerROS'
DEFAULT_GLOBAL_PLANNER = 'navfn/NavfnROS'


def plugin_namespace(plugin: str) -> str:
    """Return the namespace of a plugin's parameters in move_base: 'pkg/Class' and 'pkg::Class' give 'Class'."""
    return plugin.replace('::', '/').rsplit('/', 1)[-1]
