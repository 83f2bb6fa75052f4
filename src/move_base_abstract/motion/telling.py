"""The pose that a robot reports: the true pose, except during lapses. Its motion knows nothing of lapses."""
from __future__ import annotations

from typing import Any, Optional

from .geometry import Pose2D


class Telling:
    """Of ``robot`` (Robot).

    ``shift``: where the robot takes the origin of its odometry to be, in the global frame, though it is at that
    frame's own; None: it is right. ``is_mute``: it says nothing of where it is.
    """

    __slots__ = ('is_mute', 'robot', 'shift')

    def __init__(self, robot: Any) -> None:
        self.robot = robot
        self.shift: Optional[Pose2D] = None
        self.is_mute = False

    def jump(self, now_ns: int, x: float, y: float, yaw: float) -> None:
        """Say from ``now_ns`` [ns] on that it is ``x``, ``y`` [m] and ``yaw`` [rad] beside where it is then.

        As amcl's do, the step turns the odometry about the robot; what is driven from then on goes the wrong way.
        """
        pose: Pose2D = self.robot.pose_at(now_ns)
        self.shift = Pose2D(pose.x + x, pose.y + y, pose.yaw + yaw).compose(pose.inverse())

    def pose_at(self, now_ns: int) -> Pose2D:
        """Return where it says that it is at ``now_ns`` [ns]: as of Robot.pose_at, in the global frame."""
        pose: Pose2D = self.robot.pose_at(now_ns)
        return pose if self.shift is None else self.shift.compose(pose)
