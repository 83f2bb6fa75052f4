"""A robot's odometry: where it takes itself to be in the odom frame, as a motion of its own."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Iterator, Optional, Tuple

from ..motion.geometry import Pose2D
from ..motion.pieces import Motion, Placed

if TYPE_CHECKING:
    from ..motion.robot import Robot


class Odometry:
    """The odometry of ``robot`` (Robot), seen from ``origin`` (Pose2D, global frame), where the odom frame lies."""

    def __init__(self, robot: Robot, origin: Pose2D) -> None:
        self._robot = robot
        #: where the odom frame lies in the global frame
        self.origin = origin
        self._into = origin.inverse()
        self._seen: Optional[_Seen] = None

    @property
    def drifts(self) -> bool:
        """Whether the odometry is wrong, so that the odom frame drifts away from its origin."""
        return False

    def origin_at(self, _true: Pose2D, _seen: Pose2D) -> Pose2D:
        """Return where the odom frame seems to lie in the global frame.

        ``_true``: the pose of the robot in the global frame; ``_seen``: its pose in the odom frame.
        """
        return self.origin

    @property
    def motion(self) -> Optional[Motion]:
        """The motion under way, in the odom frame; None while the robot stands."""
        leg = self._robot.leg
        if leg is None:
            return None
        if self._seen is None or self._seen.whole is not leg:
            self._seen = _Seen(leg, self._into)
        return self._seen

    def pose_at(self, now_ns: int) -> Pose2D:
        """Return the pose in the odom frame at ``now_ns`` [ns].

        :raises TimeError: as Robot.pose_at does.
        """
        motion = self.motion
        if motion is None or now_ns < motion.depart_ns:
            return self._into.compose(self._robot.pose_at(now_ns))
        return motion.pose_at(now_ns)

    def reset(self, now_ns: int) -> None:
        """Forget all errors at ``now_ns`` [ns]; here there are none."""

    def velocity_at(self, now_ns: int) -> Tuple[float, float, float]:
        """Return (forward [m/s], lateral [m/s], turning [rad/s]) in the base frame at ``now_ns`` [ns]."""
        return self._robot.velocity_at(now_ns)


class _Seen(Motion):
    """The motion ``whole`` in another frame; ``into`` (Pose2D): the frame in which it is given, in that frame."""

    __slots__ = ('whole', '_into')

    def __init__(self, whole: Motion, into: Pose2D) -> None:
        self.whole = whole
        self._into = into
        self.depart_ns, self.arrive_ns, self.distance = whole.depart_ns, whole.arrive_ns, whole.distance
        self.start, self.end = into.compose(whole.start), into.compose(whole.end)
        self._kept = None

    def _stretches(self) -> Iterator[Placed]:
        turned = Pose2D(0.0, 0.0, self._into.yaw)
        for piece in self.whole.pieces:
            place = self._into.compose(Pose2D(piece.x, piece.y, piece.yaw))
            along = turned.compose(Pose2D(piece.ux, piece.uy))
            ux, uy = along.x, along.y
            if (piece.ux, piece.uy) == (math.cos(piece.yaw), math.sin(piece.yaw)):  # so it stays straight ahead
                ux, uy = math.cos(place.yaw), math.sin(place.yaw)
            yield piece._replace(x=place.x, y=place.y, yaw=place.yaw, ux=ux, uy=uy), 0.0
