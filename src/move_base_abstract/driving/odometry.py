"""A robot's odometry: where it takes itself to be in the odom frame, as a motion of its own.

It may be wrong by constant shares, as with Stage's ``localization "odom"``, so that localisation has work to do. Each
component of the velocity is then measured as its true value times a share near 1. An arc so is another arc, and the
pose in the odom frame stays a formula of the instant.
"""
from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Deque, Optional, Tuple

from ..engine.chance import Chance, Purpose
from ..motion.geometry import Pose2D
from ..motion.pieces import velocity_of
from .drive_motion import DriveMotion, Twist

if TYPE_CHECKING:
    from ..motion.robot import Robot

_REMEMBERED = 64  # the number of motions whose poses can be asked for, as of a Robot
_EXACT = Twist(1.0, 1.0, 1.0)


class Odometry:
    """The odometry of ``robot`` (Robot), from ``now_ns`` [ns] on, with each component of the velocity times ``shares``.

    ``origin`` (Pose2D, global frame) is where the odom frame lies. Without an error the odometry is the robot's pose
    seen from there, whatever happens. With one, a teleport does not change it.
    """

    def __init__(self, robot: Robot, origin: Pose2D, now_ns: int, shares: Twist = _EXACT) -> None:
        #: where the odom frame lies in the global frame, and what the velocities are multiplied by
        self.origin, self.shares = origin, shares
        #: whether the odometry is wrong, so that the odom frame drifts away from its origin
        self.drifts = shares != _EXACT
        self._robot = robot
        self._into = origin.inverse()
        # (since when [ns], the pose then, the motion in the odom frame from then on, or None at rest), ...
        self._past: Deque[Tuple[int, Pose2D, Optional[DriveMotion]]] = deque(maxlen=_REMEMBERED)
        self.reset(now_ns)
        robot.follow(self._moved)

    def origin_at(self, true: Pose2D, seen: Pose2D) -> Pose2D:
        """Return where the odom frame seems to lie in the global frame.

        ``true``: the pose of the robot in the global frame; ``seen``: its pose in the odom frame.
        """
        return true.compose(seen.inverse()) if self.drifts else self.origin

    @property
    def motion(self) -> Optional[DriveMotion]:
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
        return self._measured(*self._robot.velocity_at(now_ns))

    def reset(self, now_ns: int) -> None:
        """Begin anew at ``now_ns`` [ns]: at the true pose, from which it goes wrong by the same shares."""
        self.forget()
        self._moved(now_ns)

    def forget(self) -> None:
        """Begin anew when the robot is next put somewhere, as when its clock starts anew; ask nothing before."""
        self._past.clear()

    def _moved(self, now_ns: int) -> None:
        """Go on as the robot does from ``now_ns`` [ns] on."""
        goes_on = self.drifts and self._past
        pose = self.pose_at(now_ns) if goes_on else self._into.compose(self._robot.pose_at(now_ns))
        leg, motion = self._robot.leg, None
        if leg is not None:
            steps = [(max(piece.begin_ns, now_ns), self._measured(*velocity_of(piece, piece.begin_ns)))
                     for piece, end_ns in leg.spans() if end_ns > now_ns]
            motion = DriveMotion(pose, steps, leg.arrive_ns)
        self._past.append((now_ns, pose, motion))

    def _measured(self, *velocity: float) -> Twist:
        return Twist(*(share * one for share, one in zip(self.shares, velocity)))


def drawn_shares(error: Tuple[float, float, float], seed: int, name: str) -> Twist:
    """Return the shares for an Odometry of the robot ``name`` that is wrong by ``error``, ranges for each component.

    Each is drawn by the seed and the name, uniformly between 1 minus and 1 plus half of its range.
    """
    if not any(error):
        return _EXACT
    chance = Chance(seed, name)
    return Twist(*(1.0 + most * (chance.uniform(0, Purpose.ODOMETRY, place) - 0.5) for place, most in enumerate(error)))
