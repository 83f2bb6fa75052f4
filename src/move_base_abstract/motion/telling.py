"""The pose that a robot reports: the true pose, except during lapses. Lapses do not change the robot's motion."""
from __future__ import annotations

from typing import Any, Optional

from .geometry import Pose2D


class Telling:
    """The pose that ``robot`` (Robot) reports.

    ``shift``: the pose that the robot takes for the origin of its odometry, in the global frame, while the true one is
    the origin of the global frame; None: there is no error. ``is_mute``: whether the robot reports no pose.
    """

    __slots__ = ('is_mute', 'robot', 'shift')

    def __init__(self, robot: Any) -> None:
        self.robot = robot
        self.shift: Optional[Pose2D] = None
        self.is_mute = False

    def jump(self, now_ns: int, x: float, y: float, yaw: float) -> None:
        """Move the reported pose, at ``now_ns`` [ns], to ``x``, ``y`` [m] and ``yaw`` [rad] beside the true pose.

        As a jump of amcl does, this turns the odometry about the robot, so later motion is reported in a wrong
        direction.
        """
        pose: Pose2D = self.robot.pose_at(now_ns)
        self.shift = Pose2D(pose.x + x, pose.y + y, pose.yaw + yaw).compose(pose.inverse())

    def pose_at(self, now_ns: int) -> Pose2D:
        """Return the reported pose at ``now_ns`` [ns] in the global frame.

        :raises TimeError: as Robot.pose_at does.
        """
        pose: Pose2D = self.robot.pose_at(now_ns)
        return pose if self.shift is None else self.shift.compose(pose)
