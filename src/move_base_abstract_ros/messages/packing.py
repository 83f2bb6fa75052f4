"""Fast functions that make the bytes of the most frequent messages, equal to those that genpy makes.

A *packer* is a function ``pack(seq)`` that returns a message's bytes. ``seq`` is the number that rospy gives to the
message; it is part of the header, if the message has one. The format is that of ROS 1: little endian, and the length
before each text and list. A test compares the bytes of all these functions with those of genpy.
"""
from __future__ import annotations

import struct
from io import BytesIO
from math import cos, sin
from typing import TYPE_CHECKING, Any, Callable, List, Optional, Sequence, Tuple

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.lockstep import wire
from move_base_abstract.motion.geometry import quaternion_of_yaw

if TYPE_CHECKING:
    from move_base_abstract.common.geometry import Pose2D
    from move_base_abstract.sensing.laser import Scan

#: a packer
Pack = Callable[[int], bytes]
#: what differs from one message of a series to the next, each with its place in the bytes; None: that is not known
Slots = Optional[Sequence[Tuple[Optional[wire.Slot], int]]]
#: besides the other slots of a message: the pose is not the robot's own, but its error comes on top
SHIFTED: Any = (None, 0)
#: of a message that begins with a header, and of a geometry_msgs/Pose
HEADER_SLOTS: Any = ((wire.Slot.NUMBER, 0), (wire.Slot.STAMP, 4))
PLAIN_POSE_SLOTS: Any = ((wire.Slot.POSE, 0),)
#: the bytes of a geometry_msgs/Twist of zeros, of a robot at rest
ZERO_TWIST = bytes(48)
_OF_ODOMETRY = {wire.Slot.POSE: wire.Slot.ODOM_POSE, wire.Slot.TWIST: wire.Slot.ODOM_TWIST}
_COVARIANCE = bytes(288)
_STAMP = struct.Struct('<II')
_LENGTH = struct.Struct('<I')
_HEAD_WITHOUT_FRAME = struct.Struct('<IIII')
_TWIST = struct.Struct('<6d')
_SCAN = struct.Struct('<7fI')


class Template:
    """A packer that says how its bytes follow from the message's number, its stamp, and its robot's motion.

    ``slots``: where these stand. ``is_once``: the message is sent once at an instant at most, for one robot.
    """

    __slots__ = ('_pack', 'is_once', 'slots')

    def __init__(self, pack: Pack, slots: Slots, is_once: bool = False) -> None:
        self._pack = pack
        self.slots = slots
        self.is_once = is_once

    def __call__(self, seq: int) -> bytes:
        """Return the message's bytes."""
        return self._pack(seq)


def of_message(message: Any) -> Pack:
    """Return the packer of a message of any type; genpy makes the bytes."""
    def pack(seq: int) -> bytes:
        if message._has_header:
            message.header.seq = seq
        buffer = BytesIO()
        message.serialize(buffer)
        return buffer.getvalue()
    return pack


def text(value: str) -> bytes:
    """Return the bytes of a text: its length, then UTF-8."""
    data = value.encode('utf-8')
    return _LENGTH.pack(len(data)) + data


def header(seq: int, stamp_ns: int) -> bytes:
    """Return the bytes of a std_msgs/Header without a frame; ``stamp_ns`` in [ns]."""
    return _HEAD_WITHOUT_FRAME.pack(seq, stamp_ns // NS_PER_S, stamp_ns % NS_PER_S, 0)


class InFrame:
    """Messages in the frame ``frame_id``. ``child_id`` is the child frame of transforms and odometry.

    The methods return bytes. ``seq`` is the number of the message, ``stamp_ns`` its stamp [ns].
    """

    def __init__(self, frame_id: Any, child_id: str = '') -> None:
        frame, child = frame_id.encode('utf-8'), child_id.encode('utf-8')
        self._frame = len(frame), frame
        self._frames = len(frame), frame, len(child), child
        self._head = struct.Struct('<IIII{}s'.format(len(frame)))
        self._pose = struct.Struct('<IIII{}s7d'.format(len(frame)))
        self._pose_of_child = struct.Struct('<IIII{}sI{}s7d'.format(len(frame), len(child)))
        pose, child_pose = self._pose.size - 56, self._pose_of_child.size - 56
        #: the slots of :meth:`pose_stamped` and :meth:`pose_with_covariance`, and of :meth:`odometry`
        self.pose_slots: Any = (*HEADER_SLOTS, (wire.Slot.POSE, pose))
        self.odometry_slots: Any = (*HEADER_SLOTS, (wire.Slot.POSE, child_pose),
                                    (wire.Slot.TWIST, self._pose_of_child.size + len(_COVARIANCE)))
        self.transform_size = self._pose_of_child.size

    def head(self, seq: int, stamp_ns: int) -> bytes:
        """Return the bytes of the header."""
        return self._head.pack(seq, stamp_ns // NS_PER_S, stamp_ns % NS_PER_S, *self._frame)

    def pose_stamped(self, seq: int, pose: Pose2D, stamp_ns: int) -> bytes:
        """Return a geometry_msgs/PoseStamped of ``pose`` (Pose2D)."""
        half = pose.yaw / 2.0
        return self._pose.pack(seq, stamp_ns // NS_PER_S, stamp_ns % NS_PER_S, *self._frame,
                               pose.x, pose.y, 0.0, 0.0, 0.0, sin(half), cos(half))

    def goal(self, seq: int, place: Pose2D, height: float, quaternion: Tuple[float, float, float, float],
             stamp_ns: int) -> bytes:
        """Return a geometry_msgs/PoseStamped at ``place`` (Pose2D) and ``height`` [m], with the ``quaternion``."""
        return self._pose.pack(seq, stamp_ns // NS_PER_S, stamp_ns % NS_PER_S, *self._frame,
                               place.x, place.y, height, *quaternion)

    def pose_with_covariance(self, seq: int, pose: Pose2D, stamp_ns: int) -> bytes:
        """Return a geometry_msgs/PoseWithCovarianceStamped, all variances 0."""
        return self.pose_stamped(seq, pose, stamp_ns) + _COVARIANCE

    def target(self, x: float, y: float, yaw: float) -> bytes:
        """Return a geometry_msgs/PoseStamped with stamp 0, position ``x``, ``y`` [m] and heading ``yaw`` [rad]."""
        return self._pose.pack(0, 0, 0, *self._frame, x, y, 0.0, *quaternion_of_yaw(yaw))

    def transform(self, pose: Any, stamp_ns: int, height: float = 0.0) -> bytes:
        """Return the geometry_msgs/TransformStamped that puts the child frame at ``pose`` (Pose2D), ``height`` [m]."""
        half = pose.yaw / 2.0
        return self._pose_of_child.pack(0, stamp_ns // NS_PER_S, stamp_ns % NS_PER_S, *self._frames,
                                        pose.x, pose.y, height, 0.0, 0.0, sin(half), cos(half))

    def odometry(self, seq: int, pose: Pose2D, velocity: Tuple[float, float, float], stamp_ns: int) -> bytes:
        """Return a nav_msgs/Odometry, all variances 0; ``velocity`` is (forward, lateral [m/s], turning [rad/s])."""
        half = pose.yaw / 2.0
        forward, lateral, turning = velocity
        return b''.join((
            self._pose_of_child.pack(seq, stamp_ns // NS_PER_S, stamp_ns % NS_PER_S, *self._frames,
                                     pose.x, pose.y, 0.0, 0.0, 0.0, sin(half), cos(half)),
            _COVARIANCE, _TWIST.pack(forward, lateral, 0.0, 0.0, 0.0, turning), _COVARIANCE))

    def laser_scan(self, seq: int, scan: Scan, period: float) -> bytes:
        """Return a sensor_msgs/LaserScan of ``scan`` (Scan); ``period`` [s] is the time between two scans."""
        settings = scan.settings
        return b''.join((
            self.head(seq, scan.stamp_ns), _SCAN.pack(
                settings.angle_min, settings.angle_max, settings.angle_increment, 0.0, period, settings.range_min,
                settings.range_max, len(scan.ranges)),
            scan.ranges.astype('<f4').tobytes(), _LENGTH.pack(0)))

    def polygon(self, seq: int, points: Sequence[Tuple[float, float]], stamp_ns: int) -> bytes:
        """Return a geometry_msgs/PolygonStamped of ``points`` [(x, y)], each a number [m] that a float32 can hold."""
        data = [self.head(seq, stamp_ns), _LENGTH.pack(len(points))]
        data += [struct.pack('<3f', x, y, 0.0) for x, y in points]
        return b''.join(data)


def transforms(packed: Sequence[bytes]) -> bytes:
    """Return a tf2_msgs/TFMessage; ``packed`` is a list of TransformStamped as bytes."""
    return _LENGTH.pack(len(packed)) + b''.join(packed)


def behind_header(size: int, slots: Slots) -> Slots:
    """Return the slots of a message with a header without a frame, ``size`` more bytes, and what has ``slots``."""
    begin = _HEAD_WITHOUT_FRAME.size + size
    return None if slots is None else (*HEADER_SLOTS, *((kind, begin + place) for kind, place in slots))


def slots_of_transforms(frames: Sequence[InFrame], moving: int = -1, is_odometry: bool = False) -> Slots:
    """Return the slots of :func:`transforms` with one of each of ``frames``.

    The robot's pose, or with ``is_odometry`` that of its odometry, is in the one at the place ``moving``.
    """
    slots: List[Any] = []
    ends = [_LENGTH.size]
    for frame in frames:
        slots.append((wire.Slot.STAMP, ends[-1] + 4))
        ends.append(ends[-1] + frame.transform_size)
    found = (*slots, (wire.Slot.POSE, ends[1:][moving] - 56))
    return of_odometry(found) if is_odometry else found


def of_odometry(slots: Any) -> Slots:
    """Return ``slots`` for poses and velocities of the robot's odometry instead of its own."""
    return [(_OF_ODOMETRY.get(kind, kind), place) for kind, place in slots]


def status(goal_id: str, stamp_ns: int, state: int, said: str) -> bytes:
    """Return an actionlib_msgs/GoalStatus of a goal: its id, the id's stamp [ns], its ``state`` (number), its text."""
    name, words = goal_id.encode('utf-8'), said.encode('utf-8')
    return struct.pack('<III{}sBI{}s'.format(len(name), len(words)), stamp_ns // NS_PER_S, stamp_ns % NS_PER_S,
                       len(name), name, state, len(words), words)


def statuses(seq: int, packed: Sequence[bytes], stamp_ns: int) -> bytes:
    """Return an actionlib_msgs/GoalStatusArray; ``packed`` is a list of GoalStatus as bytes."""
    return b''.join((header(seq, stamp_ns), _LENGTH.pack(len(packed)), *packed))


def action_goal(seq: int, goal_id: str, stamp_ns: int, target: bytes) -> bytes:
    """Return the action message of a goal; ``target`` is the action's own part as bytes."""
    return b''.join((header(seq, stamp_ns), _STAMP.pack(stamp_ns // NS_PER_S, stamp_ns % NS_PER_S), text(goal_id),
                     target))
