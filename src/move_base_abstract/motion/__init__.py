"""How a robot moves: poses, legs and routes in closed form, laws of travel, and how long goals really take."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'calibration': 'Calibration make_calibration read_calibration', 'durations': 'Durations read_durations',
    'frames': 'RobotFrames', 'geometry': 'Pose2D', 'leg': 'Leg MotionLimits Tolerances',
    'phased_route': 'PhasedRoute', 'planned_way': 'PlannedWay', 'robot': 'Robot', 'route': 'Route'})
