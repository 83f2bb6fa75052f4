"""Fast reading of the most frequent received messages, without the objects that genpy makes for their parts.

Each class can be given to a subscription as its message class, since it inherits type and md5sum of the message. If
the bytes are not as expected (not UTF-8, or too short), genpy reads them, and its result or error counts.
"""
from __future__ import annotations

import struct
from typing import Any, Tuple

from move_base_msgs.msg import MoveBaseActionGoal, MoveBaseActionResult

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.goals.navigator import GoalPose

from . import conversions

_LENGTH = struct.Struct('<I')
_THREE = struct.Struct('<III')
_FOUR = struct.Struct('<IIII')
_POSE = struct.Struct('<7d')


class _Cut(Exception):
    """The bytes end within a text."""


def _text(data: bytes, begin: int, length: int) -> Tuple[str, int]:
    end = begin + length
    if end > len(data):
        raise _Cut
    return data[begin:end].decode('utf-8'), end


class GoalIn(MoveBaseActionGoal):
    """A move_base_msgs/MoveBaseActionGoal: ``name`` and ``stamp_ns`` [ns] of its id, ``target`` (GoalPose)."""

    def __init__(self) -> None:
        """Make an empty message, which :meth:`deserialize` fills."""

    def deserialize(self, data: bytes) -> GoalIn:
        """Read the bytes."""
        try:
            self._read(data)
        except (struct.error, UnicodeDecodeError, _Cut):
            whole = MoveBaseActionGoal().deserialize(data)
            self.name = whole.goal_id.id
            self.stamp_ns = whole.goal_id.stamp.to_nsec()
            self.target = conversions.from_target(whole.goal.target_pose)
        return self

    def _read(self, data: bytes) -> None:
        at = 16 + _LENGTH.unpack_from(data, 12)[0]
        seconds, rest, length = _THREE.unpack_from(data, at)
        self.stamp_ns = seconds * NS_PER_S + rest
        self.name, at = _text(data, at + 12, length)
        _, seconds, rest, length = _FOUR.unpack_from(data, at)
        frame_id, at = _text(data, at + 16, length)
        x, y, z, *quaternion = _POSE.unpack_from(data, at)
        self.target = GoalPose(frame_id, seconds * NS_PER_S + rest, (x, y), tuple(quaternion), z)


class ResultIn(MoveBaseActionResult):
    """A move_base_msgs/MoveBaseActionResult: ``name`` of its goal, ``state`` (number) and ``said`` (text)."""

    def __init__(self) -> None:
        """Make an empty message, which :meth:`deserialize` fills."""

    def deserialize(self, data: bytes) -> Any:
        """Read the bytes."""
        try:
            at = 16 + _LENGTH.unpack_from(data, 12)[0] + 8
            self.name, at = _text(data, at + 4, _LENGTH.unpack_from(data, at)[0])
            self.state = data[at]
            self.said, _ = _text(data, at + 5, _LENGTH.unpack_from(data, at + 1)[0])
        except (struct.error, UnicodeDecodeError, IndexError, _Cut):
            whole = MoveBaseActionResult().deserialize(data)
            self.name, self.state, self.said = whole.status.goal_id.id, whole.status.status, whole.status.text
        return self
