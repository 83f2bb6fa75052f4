"""What simulators of robots under velocities publish: odometry, tf from the odom frame on, and the true pose."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, Optional, Tuple

from nav_msgs.msg import Odometry as OdometryMessage

from move_base_abstract.motion.geometry import Pose2D

from ..messages import packing
from ..messages.outlets import LatchedOutlets
from ..messages.packing import InFrame, Template
from .builtin import BuiltinBackend

if TYPE_CHECKING:
    from move_base_abstract.config.settings import RobotSettings
    from move_base_abstract.driving.odometry import Odometry
    from move_base_abstract.motion.robot import Robot

    from ..messages.packing import Pack
    from ..robot.names import RobotNames

    Velocity = Tuple[float, float, float]
    #: the true one, and that of the odometry
    Poses = Tuple[Pose2D, Pose2D]
    Velocities = Tuple[Velocity, Velocity]

_ORIGIN = Pose2D()


class DrivenBackend(BuiltinBackend):
    """Publishes tf ``odom -> base_footprint -> base_link``, ``odom`` and ``base_pose_ground_truth``, as stage_ros does.

    ``map -> odom`` is there only if it is asked for: it belongs to a localizer. Poses and velocities are pairs here.
    """

    def __init__(self, names: RobotNames, settings: RobotSettings, robot: Robot, odometry: Odometry) -> None:
        values, odom_frame = settings.values, settings.odom_frame
        self._robot, self._track = robot, odometry
        self._base_frame = settings.frame(values['robot_base_frame'])
        lower, global_frame = self._base_frame, values['global_frame']
        self._below: Optional[InFrame] = None
        footprint = settings.footprint_frame
        if footprint:
            lower = settings.frame(footprint)
            self._below = InFrame(lower, self._base_frame)
        self._lower_in_odom = InFrame(odom_frame, lower)
        self._odom_in_map = InFrame(global_frame, odom_frame) if (
            values['publish_map_frame'] and odom_frame != global_frame) else None
        self.frames = [odom_frame] * (self._odom_in_map is not None)
        self.has_tf = values['enable_odom_tf']
        if self.has_tf:
            self.frames += [lower] + [self._base_frame] * (self._below is not None)
        shown = [self._odom_in_map, self._lower_in_odom, self._below]
        self._tf_slots = packing.slots_of_transforms([frame for frame in shown if frame is not None],
                                                     int(self._odom_in_map is not None), is_odometry=True)
        self._tf_told = -1, None
        self.shift = None
        self._poses, self._odometry = LatchedOutlets(), LatchedOutlets()
        slash = '/' if values['slash_in_headers'] else ''
        self._in_odom = InFrame(slash + odom_frame, slash + self._base_frame)
        self._in_map = InFrame(slash + global_frame, slash + self._base_frame)
        self._odometry.add(names.topic('odom'), OdometryMessage, self._pack_odom)
        self._odometry.add(names.topic('base_pose_ground_truth'), OdometryMessage, self._pack_ground_truth)

    def poses_at(self, now_ns: int) -> Tuple[Poses, Velocities]:
        """Return the pairs of poses and of velocities at ``now_ns`` [ns]."""
        return ((self._robot.pose_at(now_ns), self._track.pose_at(now_ns)),
                (self._robot.velocity_at(now_ns), self._track.velocity_at(now_ns)))

    def looks(self, _pose: Pose2D, stamp_ns: int) -> None:
        """Publish tf at the instant of a scan, unless a later one was published."""
        poses: Any = self.poses_at(stamp_ns)[0]
        super().looks(poses, stamp_ns)

    def _transforms(self, poses: Any, _shift: Any, stamp_ns: int) -> List[bytes]:
        true, seen = poses
        found = []
        if self._odom_in_map is not None:
            found.append(self._odom_in_map.transform(self._track.origin_at(true, seen), stamp_ns))
        found.append(self._lower_in_odom.transform(seen, stamp_ns))
        if self._below is not None:
            found.append(self._below.transform(_ORIGIN, stamp_ns))
        return found

    def _slots(self, slots: Any, odometry_frame: Optional[InFrame] = None) -> Any:
        return slots if odometry_frame is None or not self._track.drifts else (*slots, packing.SHIFTED)

    def _pack_odom(self, poses: Any, velocities: Any, stamp_ns: int) -> Pack:
        return Template(lambda seq: self._in_odom.odometry(seq, poses[1], velocities[1], stamp_ns),
                        packing.of_odometry(self._in_odom.odometry_slots))

    def _pack_ground_truth(self, poses: Any, velocities: Any, stamp_ns: int) -> Pack:
        return Template(lambda seq: self._in_map.odometry(seq, poses[0], velocities[0], stamp_ns),
                        self._in_map.odometry_slots)
