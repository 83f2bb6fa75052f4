"""The built-in simulator: it publishes the robot's pose, as the core computes it, in tf and on a few topics."""
from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, Callable, List, Optional, Tuple

from geometry_msgs.msg import Pose, PoseStamped, PoseWithCovarianceStamped
from nav_msgs.msg import Odometry

from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.original import is_rasberry

from ..lockstep.exchange import playing
from ..messages import conversions, packing
from ..messages.outlets import LatchedOutlets
from ..messages.packing import InFrame, Template, of_message
from ..transforms import tf_hub

if TYPE_CHECKING:
    from move_base_abstract.config.settings import RobotSettings

    from ..messages.packing import Pack
    from ..robot.names import RobotNames

_ORIGIN = Pose2D()


class BuiltinBackend:
    """Publishes tf ``map -> odom -> base_link``, ``amcl_pose``, ``odom``, ``base_pose_ground_truth``, ``robot_pose``.

    Odometry is perfect and starts at the map's origin: ``odom`` coincides with ``map``, or is the global frame itself.
    With a ``shift`` the robot believes that ``odom`` is there; only the ground truth does not follow.
    The topics are latched, so that nodes that start later get the robot's pose.
    """

    has_tf = True

    def __init__(self, names: RobotNames, settings: RobotSettings) -> None:
        global_frame, odom_frame = settings.values['global_frame'], settings.odom_frame
        self._base_frame = settings.frame(settings.values['robot_base_frame'])
        self.frames = [frame for frame in (odom_frame, self._base_frame) if frame != global_frame]
        self._base_in_odom, self._base_in_map = InFrame(odom_frame, self._base_frame), InFrame(global_frame,
                                                                                              self._base_frame)
        # Without a map odom is the global frame; tf allows no frame to be its own parent.
        self._odom_in_map = InFrame(global_frame, odom_frame) if odom_frame != global_frame else None
        self._tf_slots = packing.slots_of_transforms([self._base_in_odom] if self._odom_in_map is None else
                                                     [self._odom_in_map, self._base_in_odom])
        self._tf_told: Any = -1, None  # the last one sent to tf: stamp [ns], (pose, shift)
        self.shift = None
        self._poses, self._odometry = LatchedOutlets(), LatchedOutlets()
        self._poses.add(names.topic('robot_pose'), *(
            (Pose, self._pack_plain_pose) if is_rasberry(settings.original) else (PoseStamped, self._pack_robot_pose)))
        self._poses.add(names.topic('amcl_pose'), PoseWithCovarianceStamped, self._pack_amcl_pose)
        self._odometry.add(names.topic('odom'), Odometry, self._pack_odom)
        self._odometry.add(names.topic('base_pose_ground_truth'), Odometry, self._pack_ground_truth)

    def place(self, pose: Pose2D, velocity: Tuple[float, float, float], stamp_ns: int) -> None:
        """Publish that the robot is at ``pose`` and drives with ``velocity``."""
        self.heartbeat(pose, stamp_ns)
        self._poses.show(pose, velocity, stamp_ns)
        self._odometry.show(pose, velocity, stamp_ns)

    def rests(self, pose: Pose2D, stamp_ns: int) -> None:
        """Publish odometry and ground truth of a robot that stands at ``pose``. ``amcl_pose`` is not published then."""
        self._odometry.show(pose, (0.0, 0.0, 0.0), stamp_ns)

    def heartbeat(self, pose: Pose2D, stamp_ns: int) -> None:
        """Publish tf only. tf allows one pose for an instant, so a jump gets a stamp 1 ns after the last one."""
        if not self.has_tf:
            return
        told_ns, told = self._tf_told
        if stamp_ns <= told_ns:
            playing.refuse()
            if (pose, self.shift) == told:
                return
            stamp_ns = told_ns + 1
        if not playing.is_recording():
            self._tf_told = stamp_ns, (pose, self.shift)
        tf_hub.send(self._base_frame, stamp_ns, partial(self._transforms, pose, self.shift),
                    self._slots(self._tf_slots, self._odom_in_map))

    def looks(self, pose: Pose2D, stamp_ns: int) -> None:
        """Publish tf at the instant of a scan, unless a later one was published."""
        if stamp_ns > self._tf_told[0]:
            self.heartbeat(pose, stamp_ns)

    def follow(self, present: Callable[[], Optional[Tuple[Pose2D, Tuple[float, float, float], int]]]) -> None:
        """Tell new listeners ``present()``: the pose, the velocity and the stamp [ns] of now, as for :meth:`place`.

        None: they are told what was published last.
        """
        def transforms() -> Any:
            found = present()
            return None if found is None else (found[2], partial(self._transforms, found[0], self.shift))
        self._poses.present = self._odometry.present = present
        if self.has_tf:
            tf_hub.follow(self._base_frame, transforms)

    def is_heard(self) -> int:
        """Return which nodes listen to the robot's pose, other than by tf: NOBODY (0), ONLOOKERS or PARTICIPANTS."""
        return max(self._poses.is_heard(), self._odometry.is_heard())

    def is_odometry_heard(self) -> int:
        """Return which nodes listen to odometry or ground truth: NOBODY (0), ONLOOKERS or PARTICIPANTS."""
        return self._odometry.is_heard()

    def hearers(self) -> List[Tuple[str, str]]:
        """Return (topic, name) of each node that listens to the robot's pose, other than by tf."""
        return self._poses.hearers() + self._odometry.hearers()

    def odometry_hearers(self) -> List[Tuple[str, str]]:
        """Return (topic, name) of each node that listens to odometry or ground truth."""
        return self._odometry.hearers()

    def restart(self) -> None:
        """Allow earlier stamps, because time has started anew."""
        self._tf_told = -1, None

    def close(self) -> None:
        """Unregister the topics, and take the robot's frame out of tf."""
        tf_hub.forget(self._base_frame)
        self._poses.unregister()
        self._odometry.unregister()

    def _transforms(self, pose: Pose2D, shift: Optional[Pose2D], stamp_ns: int) -> List[bytes]:
        if self._odom_in_map is None:
            return [self._base_in_odom.transform(_shifted(pose, shift), stamp_ns)]
        return [self._odom_in_map.transform(shift or _ORIGIN, stamp_ns), self._base_in_odom.transform(pose, stamp_ns)]

    def _pack_amcl_pose(self, pose: Pose2D, _velocity: Tuple[float, float, float], stamp_ns: int) -> Pack:
        told = _shifted(pose, self.shift)
        return Template(lambda seq: self._base_in_map.pose_with_covariance(seq, told, stamp_ns),
                        self._slots(self._base_in_map.pose_slots))

    def _pack_odom(self, pose: Pose2D, velocity: Tuple[float, float, float], stamp_ns: int) -> Pack:
        told = pose if self._odom_in_map is not None else _shifted(pose, self.shift)
        return Template(lambda seq: self._base_in_odom.odometry(seq, told, velocity, stamp_ns),
                        self._slots(self._base_in_odom.odometry_slots, self._odom_in_map))

    def _pack_ground_truth(self, pose: Pose2D, velocity: Tuple[float, float, float], stamp_ns: int) -> Pack:
        return Template(lambda seq: self._base_in_map.odometry(seq, pose, velocity, stamp_ns),
                        self._base_in_map.odometry_slots)

    @staticmethod
    def _pack_plain_pose(pose: Pose2D, _velocity: Tuple[float, float, float], _stamp_ns: int) -> Pack:
        return Template(of_message(conversions.to_pose(pose)), packing.PLAIN_POSE_SLOTS)

    def _pack_robot_pose(self, pose: Pose2D, _velocity: Tuple[float, float, float], stamp_ns: int) -> Pack:
        told = _shifted(pose, self.shift)
        return Template(lambda seq: self._base_in_map.pose_stamped(seq, told, stamp_ns),
                        self._slots(self._base_in_map.pose_slots))

    def _slots(self, slots: Any, odometry_frame: Optional[InFrame] = None) -> Any:
        """Return ``slots`` of a pose, which is not shifted if it is relative to a frame of odometry."""
        return slots if self.shift is None or odometry_frame is not None else (*slots, packing.SHIFTED)


def _shifted(pose: Pose2D, shift: Optional[Pose2D]) -> Pose2D:
    return pose if shift is None else shift.compose(pose)
