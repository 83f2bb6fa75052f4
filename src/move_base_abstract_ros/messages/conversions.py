"""Conversion between ROS messages and the core's values. The core's times are integer nanoseconds."""
from __future__ import annotations

from typing import Any, Tuple

import genpy
from geometry_msgs.msg import Point, Pose, PoseStamped, Quaternion
from std_msgs.msg import Header

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.goals.navigator import GoalPose
from move_base_abstract.motion.geometry import Pose2D, quaternion_fault, quaternion_of_yaw, yaw_of_quaternion


def to_time(time_ns: int) -> Any:
    """Return ``time_ns`` [ns] as a ROS time."""
    return genpy.Time(time_ns // NS_PER_S, time_ns % NS_PER_S)


def to_duration(duration_ns: int) -> Any:
    """Return ``duration_ns`` [ns] as a ROS duration."""
    return genpy.Duration(duration_ns // NS_PER_S, duration_ns % NS_PER_S)


def to_header(frame_id: str, stamp_ns: int) -> Any:
    """Return a std_msgs/Header with the frame ``frame_id`` and the stamp ``stamp_ns`` [ns]."""
    return Header(frame_id=frame_id, stamp=to_time(stamp_ns))


def to_pose(pose: Pose2D) -> Any:
    """Return a geometry_msgs/Pose of ``pose`` (Pose2D), z = 0."""
    return Pose(Point(pose.x, pose.y, 0.0), Quaternion(*quaternion_of_yaw(pose.yaw)))


def to_pose_stamped(pose: Pose2D, frame_id: str, stamp_ns: int) -> Any:
    """Return a geometry_msgs/PoseStamped of ``pose`` (Pose2D) in the frame ``frame_id`` at ``stamp_ns`` [ns]."""
    return PoseStamped(to_header(frame_id, stamp_ns), to_pose(pose))


def quaternion_tuple(orientation: Any) -> Tuple[float, float, float, float]:
    """Return a message's quaternion as (x, y, z, w)."""
    return orientation.x, orientation.y, orientation.z, orientation.w


def from_pose(message: Any) -> Pose2D:
    """Return the Pose2D of a geometry_msgs/Pose.

    :raises ValueError: if its quaternion is not a heading in the plane: NaN, inf, tilted, or empty.
    """
    quaternion = quaternion_tuple(message.orientation)
    fault = quaternion_fault(quaternion)
    if fault:
        raise ValueError(fault)
    return Pose2D(message.position.x, message.position.y, yaw_of_quaternion(quaternion))


def from_transform(transform: Any) -> Pose2D:
    """Return the Pose2D of a geometry_msgs/Transform, unchecked."""
    return Pose2D(transform.translation.x, transform.translation.y,
                  yaw_of_quaternion(quaternion_tuple(transform.rotation)))


def from_target(message: Any) -> GoalPose:
    """Return the core's GoalPose of a geometry_msgs/PoseStamped, unchecked, since the core checks it."""
    position = message.pose.position
    return GoalPose(message.header.frame_id, message.header.stamp.to_nsec(), (position.x, position.y),
                    quaternion_tuple(message.pose.orientation), position.z)
