"""The frames in which a goal may be given (REP 105: map -> odom -> base_link)."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Callable, Tuple

from ..common.errors import FrameError, TimeError
from .geometry import STRAIGHT_AHEAD, Pose2D, turned_about_z, yaw_of_quaternion

if TYPE_CHECKING:
    from ..goals.goal_pose import GoalPose
    from .robot import Robot


class RobotFrames:
    """Finds frames in the global frame: those of one ``robot`` in closed form, all others by ``lookup``.

    ``lookup(frame_id, stamp_ns)`` returns the :class:`Pose2D` of a foreign frame in the global frame at ``stamp_ns``
    [ns; 0 = latest] or raises :class:`FrameError`. ``patience_ns()`` returns for how long after an instant [ns] the
    pose of that instant is waited for.
    """

    __slots__ = ('global_frame', 'odom_frame', 'base_frame', '_fixed', '_robot', '_lookup', '_patience_ns')

    def __init__(self, robot: Robot, global_frame: str, odom_frame: str, base_frame: str,
                 lookup: Callable[[str, int], Pose2D], patience_ns: Callable[[], int] = lambda: 0) -> None:
        self.global_frame = global_frame
        self.odom_frame = odom_frame
        self.base_frame = base_frame
        self._fixed = global_frame, odom_frame
        self._robot = robot
        self._lookup = lookup
        self._patience_ns = patience_ns

    def is_foreign(self, frame_id: str) -> bool:
        """Return whether only the look-up can find ``frame_id``, since it is no frame of the robot."""
        return bool(frame_id) and frame_id not in (self.global_frame, self.odom_frame, self.base_frame)

    def is_fixed(self, frame_id: str) -> bool:
        """Return whether the frame never moves, so that a stamp does not matter."""
        return frame_id in self._fixed

    def locate(self, frame_id: str, stamp_ns: int, now_ns: int) -> Pose2D:
        """Return the pose of ``frame_id`` in the global frame at ``stamp_ns`` [ns; 0 = now].

        :raises FrameError: if the frame, or its pose at that time, is not known; the text names the frame.
        """
        if self.is_fixed(frame_id):
            return Pose2D()
        try:
            if frame_id == self.base_frame:
                return self._robot.pose_at(stamp_ns or now_ns)
            self._check_name(frame_id)
            return self._lookup(frame_id, stamp_ns)
        except (FrameError, TimeError) as error:
            raise FrameError("Failed to transform the goal pose from '{}' into the '{}' frame: {}".format(
                frame_id, self.global_frame, error)) from None

    def is_yet_to_come(self, frame_id: str, stamp_ns: int, now_ns: int) -> bool:
        """Return whether the frame is known, but its pose at ``stamp_ns`` [ns] is not, and is worth waiting for."""
        if self.is_fixed(frame_id):
            return False
        if frame_id == self.base_frame:
            return stamp_ns > now_ns
        if stamp_ns <= now_ns - self._patience_ns():
            return False
        return self._knows(frame_id, 0, now_ns) and not self._knows(frame_id, stamp_ns, now_ns)

    def _knows(self, frame_id: str, stamp_ns: int, now_ns: int) -> bool:
        try:
            self.locate(frame_id, stamp_ns, now_ns)
        except FrameError:
            return False
        return True

    def place(self, goal: GoalPose, now_ns: int) -> Pose2D:
        """Return the :class:`Pose2D` of the :class:`GoalPose` ``goal`` in the global frame, at its stamp or now.

        :raises FrameError: as :meth:`locate` does. :raises ValueError: if a number of the pose is not finite.
        """
        frame_id, stamp_ns, (x, y), quaternion, height = goal
        if not math.isfinite(height):
            raise ValueError('pose: z must be finite, got {!r}'.format(height))
        if frame_id in self._fixed:
            straight = quaternion is STRAIGHT_AHEAD or quaternion == STRAIGHT_AHEAD
            yaw = 0.0 if straight else 0.0 + yaw_of_quaternion(quaternion)
            return Pose2D(0.0 + x, 0.0 + y, yaw)  # as Pose2D.compose would: never -0.0
        place = self.locate(frame_id, stamp_ns, now_ns)
        return place.compose(Pose2D(x, y, yaw_of_quaternion(quaternion)))

    def orientation(self, goal: GoalPose, place: Pose2D) -> Tuple[float, float, float, float]:
        """Return the quaternion (x, y, z, w), in the global frame, of the :class:`GoalPose` ``goal`` at ``place``.

        ``place`` is its Pose2D in the global frame. The quaternion keeps small tilts and its length, as it was sent.
        """
        if goal.frame_id in self._fixed:
            return goal.quaternion
        return turned_about_z(goal.quaternion, place.yaw - yaw_of_quaternion(goal.quaternion))

    @staticmethod
    def _check_name(frame_id: str) -> None:
        if not frame_id:
            raise FrameError('the frame_id is empty; a goal must name the frame it is given in')
        if frame_id.startswith('/'):
            raise FrameError("a frame_id must not begin with a slash; did you mean '{}'?".format(frame_id.lstrip('/')))
