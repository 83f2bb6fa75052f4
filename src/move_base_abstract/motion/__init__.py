"""How a robot moves: poses, legs and routes in closed form, laws of travel, and how long goals really take."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .calibration import (
        Calibration as Calibration,
        make_calibration as make_calibration,
        read_calibration as read_calibration,
    )
    from .durations import Durations as Durations, read_durations as read_durations
    from .frames import RobotFrames as RobotFrames
    from .geometry import Pose2D as Pose2D
    from .leg import Leg as Leg, MotionLimits as MotionLimits, Tolerances as Tolerances
    from .phased_route import PhasedRoute as PhasedRoute
    from .pieces import Piece as Piece
    from .planned_way import PlannedWay as PlannedWay
    from .robot import Robot as Robot
    from .route import Route as Route
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
