"""The parameter names that existing move_base set-ups carry. Known here so that they can be told from mistakes."""

#: parameters of move_base itself that have no meaning without costmaps and controllers
IGNORED_NAMES = (
    'NavfnROS', 'GlobalPlanner', 'CarrotPlanner', 'DWAPlannerROS', 'TrajectoryPlannerROS', 'TebLocalPlannerROS',
    'EBandPlannerROS', 'global_costmap', 'local_costmap', 'conservative_reset', 'aggressive_reset',
    'rotate_recovery', 'clearing_rotation_allowed', 'conservative_reset_dist', 'controller_patience',
    'planner_frequency', 'shutdown_costmaps', 'oscillation_timeout', 'oscillation_distance',
    'make_plan_clear_costmap', 'restore_defaults', 'use_grid_path', 'footprint', 'robot_radius', 'footprint_padding',
    'transform_tolerance', 'latch_xy_goal_tolerance')

#: local planners whose limits are taken over when the robot has none of its own, in this order
LOCAL_PLANNERS = ('DWAPlannerROS', 'TrajectoryPlannerROS')

DEFAULT_LOCAL_PLANNER = 'base_local_planner/TrajectoryPlannerROS'
DEFAULT_GLOBAL_PLANNER = 'navfn/NavfnROS'


def plugin_namespace(plugin):
    """Return the namespace in which move_base keeps a plugin's parameters: 'pkg/Class' and 'pkg::Class' -> 'Class'."""
    return plugin.replace('::', '/').rsplit('/', 1)[-1]
