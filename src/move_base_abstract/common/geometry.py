"""Poses in the plane and the quaternions in which ROS wraps them (REP 103: x forward, angles counter-clockwise)."""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Iterable, Optional, Sequence, Tuple, Type

from .errors import ConfigurationError
from .units import FARTHEST_M

Quaternion = Tuple[float, float, float, float]  # x, y, z, w
_PI = math.pi
_FAR = FARTHEST_M
_TWO_PI = 2.0 * _PI
_MIN_SQUARED_NORM = 1e-6
_MAX_TILT = 1e-3
#: the quaternion of yaw 0, which most goals have
STRAIGHT_AHEAD = (0.0, 0.0, 0.0, 1.0)


def normalize_angle(angle: float) -> float:
    """Return ``angle`` [rad] as the equal angle in (-pi, pi]."""
    wrapped = math.fmod(angle, _TWO_PI)
    if -math.pi < wrapped <= math.pi:
        return wrapped
    return wrapped - math.copysign(_TWO_PI, wrapped)


def is_within(edges: Iterable[Tuple[Tuple[float, float], Tuple[float, float]]], x: float, y: float) -> bool:
    """Return whether a ray from (x, y) crosses the ``edges`` (begin, end), ... of a polygon an odd number of times."""
    found = False
    for (ax, ay), (bx, by) in edges:
        if (ay > y) != (by > y) and x < ax + (y - ay) / (by - ay) * (bx - ax):
            found = not found
    return found


def share_along(begin: Tuple[float, float], end: Tuple[float, float], x: float, y: float) -> float:
    """Return the share, 0..1, of the straight piece from ``begin`` to ``end`` at which it is nearest to (x, y).

    ``begin`` and ``end`` are (x, y); all coordinates are in m.
    """
    dx, dy = end[0] - begin[0], end[1] - begin[1]
    squared = dx * dx + dy * dy
    return min(1.0, max(0.0, ((x - begin[0]) * dx + (y - begin[1]) * dy) / squared)) if squared > 0.0 else 0.0


@dataclass(frozen=True, init=False)
class Pose2D:
    """A position [m] and a heading ``yaw`` [rad, (-pi, pi]] in a frame that the context names.

    :raises ValueError: if a value is NaN or infinite, or x or y is farther than 1e9 m.
    """

    __slots__ = ('x', 'y', 'yaw')

    x: float
    y: float
    yaw: float

    def __init__(self, x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> None:
        if not (-_FAR <= x <= _FAR and -_FAR <= y <= _FAR and math.isfinite(yaw)):
            for name, value in (('x', x), ('y', y), ('yaw', yaw)):
                if not math.isfinite(value):
                    raise ValueError('pose: {} must be finite, got {!r}'.format(name, value))
                if name != 'yaw' and abs(value) > _FAR:
                    raise ValueError('pose: {} must be within +-1e9 m, got {!r}'.format(name, value))
        _set_x(self, x)
        _set_y(self, y)
        _set_yaw(self, yaw if -_PI < yaw <= _PI and type(yaw) is float else normalize_angle(yaw))

    def __reduce__(self) -> Tuple[Any, ...]:
        """Return what a copy is made from; it must go through the constructor, since a pose cannot be changed."""
        return Pose2D, (self.x, self.y, self.yaw)

    def distance_to(self, other: Pose2D) -> float:
        """Return the straight distance to another pose of the same frame [m]."""
        return math.hypot(other.x - self.x, other.y - self.y)

    def bearing_to(self, other: Pose2D) -> float:
        """Return the direction from this pose to another pose of the same frame [rad]."""
        return math.atan2(other.y - self.y, other.x - self.x)

    def compose(self, local: Pose2D) -> Pose2D:
        """Return ``local``, a pose relative to this pose, in the frame in which this pose is given."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        return Pose2D(self.x + cos * local.x - sin * local.y,
                      self.y + sin * local.x + cos * local.y,
                      self.yaw + local.yaw)

    def inverse(self) -> Pose2D:
        """Return the inverse: the origin of the frame in which this pose is given, relative to this pose."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        return Pose2D(-cos * self.x - sin * self.y, sin * self.x - cos * self.y, -self.yaw)


#: They set fields of the frozen class, as object.__setattr__ would, but in a third of the time: each goal makes a pose.
_set_x, _set_y, _set_yaw = (vars(Pose2D)[name].__set__ for name in Pose2D.__slots__)


def pose_of(numbers: Iterable[float], where: str, error_type: Type[ConfigurationError] = ConfigurationError) -> Pose2D:
    """Return the Pose2D of the numbers x, y [m] and perhaps yaw [rad] of a file.

    :raises error_type: if they are none, as Pose2D says; the text begins with ``where``.
    """
    try:
        return Pose2D(*numbers)
    except ValueError as fault:
        raise error_type(f'{where}: {fault}') from None


def yaw_of_quaternion(quaternion: Sequence[float]) -> float:
    """Return the rotation about z [rad] of ``quaternion`` = (x, y, z, w), of any length but 0.

    Formula: the yaw of the z-y-x Euler angles of a rotation (REP 103).
    """
    x, y, z, w = quaternion
    return math.atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)


def quaternion_of_yaw(yaw: float) -> Quaternion:
    """Return the unit quaternion (x, y, z, w) of a rotation about z by ``yaw`` [rad]; with NaN if it is not finite."""
    half = yaw / 2.0 if math.isfinite(yaw) else math.nan
    return 0.0, 0.0, math.sin(half), math.cos(half)


def turned_about_z(quaternion: Quaternion, yaw: float) -> Quaternion:
    """Return ``quaternion`` = (x, y, z, w), turned about the fixed z axis by ``yaw`` [rad] (Hamilton's product)."""
    x, y, z, w = quaternion
    sin, cos = math.sin(yaw / 2.0), math.cos(yaw / 2.0)
    return cos * x - sin * y, cos * y + sin * x, cos * z + sin * w, cos * w - sin * z


def quaternion_fault(quaternion: Quaternion) -> Optional[str]:
    """Return the reason why ``quaternion`` = (x, y, z, w) cannot be the orientation of a goal, or None.

    The three tests, their limits and their texts are those of move_base: the quaternion must be finite, long enough to
    be normalised, and a rotation about z only. Otherwise any length is accepted.
    """
    if quaternion == STRAIGHT_AHEAD:
        return None
    x, y, z, w = quaternion
    squared = x * x + y * y + z * z + w * w
    if not math.isfinite(squared) and not all(map(math.isfinite, quaternion)):
        return 'Quaternion has nans or infs... discarding as a navigation goal'
    if squared < _MIN_SQUARED_NORM:
        return 'Quaternion has length close to zero... discarding as navigation goal'
    z_dot_rotated_z = 1.0 - 2.0 * (x * x + y * y) / squared
    if abs(z_dot_rotated_z - 1.0) > _MAX_TILT:
        return 'Quaternion is invalid... for navigation the z-axis of the quaternion must be close to vertical.'
    return None
