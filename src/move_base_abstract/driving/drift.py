"""Odometry that is wrong by constant shares, as with Stage's ``localization "odom"``: so localisation has work to do.

Each component of the velocity is measured as its true value times 1 + a share. An arc then is another arc, so the pose
in the odom frame stays a formula of the instant.
"""
from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Deque, Optional, Tuple

from ..engine.chance import Chance, Purpose
from ..motion.geometry import Pose2D
from ..motion.pieces import velocity_of
from .drive_motion import DriveMotion, Twist
from .odometry import Odometry

if TYPE_CHECKING:
    from ..motion.pieces import Motion
    from ..motion.robot import Robot

_REMEMBERED = 64  # the number of motions whose poses can be asked for, as of a Robot


def make_odometry(robot: Robot, origin: Pose2D, error: Tuple[float, float, float], seed: int,
                  now_ns: int) -> Odometry:
    """Return the odometry of ``robot`` (Robot) from ``origin`` (Pose2D, global frame); it begins at ``now_ns`` [ns].

    ``error``: the ranges of the shares by which it is wrong ahead, sideways and in turning. Each share is drawn by
    ``seed`` and the robot's name, uniformly between minus and plus half of its range.
    """
    if not any(error):
        return Odometry(robot, origin)
    chance = Chance(seed, robot.name)
    shares = (1.0 + most * (chance.uniform(0, Purpose.ODOMETRY, place) - 0.5) for place, most in enumerate(error))
    return DriftingOdometry(robot, origin, Twist(*shares), now_ns)


class DriftingOdometry(Odometry):
    """Odometry that measures each component of the velocity times ``shares`` (Twist).

    A teleport does not change it. When a clock starts anew, and at a :meth:`reset`, it begins anew without an error.
    """

    def __init__(self, robot: Robot, origin: Pose2D, shares: Twist, now_ns: int) -> None:
        super().__init__(robot, origin)
        self.shares = shares
        # (since when [ns], the pose then, the motion in the odom frame from then on, or None at rest), ...
        self._past: Deque[Tuple[int, Pose2D, Optional[Motion]]] = deque(maxlen=_REMEMBERED)
        self.reset(now_ns)
        robot.follow(self._moved)

    @property
    def drifts(self) -> bool:
        """Whether the odometry is wrong, so that the odom frame drifts away from its origin."""
        return True

    def origin_at(self, true: Pose2D, seen: Pose2D) -> Pose2D:
        """Return where the odom frame seems to lie in the global frame, as Odometry.origin_at does."""
        return true.compose(seen.inverse())

    @property
    def motion(self) -> Optional[Motion]:
        """The motion under way, in the odom frame; None while the robot stands."""
        return self._past[-1][2]

    def pose_at(self, now_ns: int) -> Pose2D:
        """Return the pose in the odom frame at ``now_ns`` [ns], which is the present or not too long ago."""
        for since_ns, pose, motion in reversed(self._past):
            if now_ns >= since_ns:
                return pose if motion is None else motion.pose_at(now_ns)
        return self._past[0][1]

    def velocity_at(self, now_ns: int) -> Tuple[float, float, float]:
        """Return (forward [m/s], lateral [m/s], turning [rad/s]) as it is measured, at ``now_ns`` [ns]."""
        return self._measured(*super().velocity_at(now_ns))

    def reset(self, now_ns: int) -> None:
        """Begin anew at ``now_ns`` [ns]: where the robot is, without an error."""
        self._past.clear()
        self._begin(self._into.compose(self._robot.pose_at(now_ns)), now_ns)

    def _moved(self, now_ns: int) -> None:
        if now_ns < self._past[-1][0]:
            self.reset(now_ns)
        else:
            self._begin(self.pose_at(now_ns), now_ns)

    def _begin(self, pose: Pose2D, now_ns: int) -> None:
        """Go on from ``pose`` in the odom frame, as the robot does from ``now_ns`` [ns] on."""
        leg, motion = self._robot.leg, None
        if leg is not None:
            steps = [(max(piece.begin_ns, now_ns), self._measured(*velocity_of(piece, piece.begin_ns)))
                     for piece, end_ns in leg.spans() if end_ns > now_ns]
            motion = DriveMotion(pose, steps, leg.arrive_ns)
        self._past.append((now_ns, pose, motion))

    def _measured(self, *velocity: float) -> Twist:
        return Twist(*(share * one for share, one in zip(self.shares, velocity)))
