"""Poses in the plane and the quaternions in which ROS wraps them (REP 103: x forward, angles counter-clockwise)."""
import math
from dataclasses import dataclass

_PI = math.pi
_TWO_PI = 2.0 * _PI
_MIN_SQUARED_NORM = 1e-6
_MAX_TILT = 1e-3
#: the quaternion of yaw 0, as of most goals
STRAIGHT_AHEAD = (0.0, 0.0, 0.0, 1.0)


def normalize_angle(angle):
    """Return ``angle`` [rad] as the equal angle in (-pi, pi]."""
    wrapped = math.fmod(angle, _TWO_PI)
    if -math.pi < wrapped <= math.pi:
        return wrapped
    return wrapped - math.copysign(_TWO_PI, wrapped)


def share_along(begin, end, x, y):
    """Return how far from ``begin`` to ``end`` (x, y) [m] their straight piece is nearest to (x, y) [m], in 0..1."""
    dx, dy = end[0] - begin[0], end[1] - begin[1]
    squared = dx * dx + dy * dy
    return min(1.0, max(0.0, ((x - begin[0]) * dx + (y - begin[1]) * dy) / squared)) if squared > 0.0 else 0.0


@dataclass(frozen=True, init=False)
class Pose2D:
    """A position [m] and a heading ``yaw`` [rad, (-pi, pi]] in a frame that the context names.

    :raises ValueError: if a value is NaN or infinite.
    """

    __slots__ = ('x', 'y', 'yaw')

    x: float
    y: float
    yaw: float

    def __init__(self, x=0.0, y=0.0, yaw=0.0):
        if not math.isfinite(x + y + yaw):  # one of them is not finite, or finite ones are too large for their sum
            for name, value in (('x', x), ('y', y), ('yaw', yaw)):
                if not math.isfinite(value):
                    raise ValueError('pose: {} must be finite, got {!r}'.format(name, value))
        _set_x(self, x)
        _set_y(self, y)
        _set_yaw(self, yaw if -_PI < yaw <= _PI and type(yaw) is float else normalize_angle(yaw))

    def __reduce__(self):
        """Return what a copy is made of, since nothing can be put into one that is there."""
        return Pose2D, (self.x, self.y, self.yaw)

    def distance_to(self, other):
        """Return the straight distance to another pose of the same frame [m]."""
        return math.hypot(other.x - self.x, other.y - self.y)

    def bearing_to(self, other):
        """Return the direction in which another pose of the same frame lies [rad]."""
        return math.atan2(other.y - self.y, other.x - self.x)

    def compose(self, local):
        """Return ``local``, a pose given relative to this one, in this one's frame."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        return Pose2D(self.x + cos * local.x - sin * local.y,
                      self.y + sin * local.x + cos * local.y,
                      self.yaw + local.yaw)

    def inverse(self):
        """Return the pose of the frame in which this one is given, in the frame that stands at this one."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        return Pose2D(-cos * self.x - sin * self.y, sin * self.x - cos * self.y, -self.yaw)


#: As object.__setattr__ would, past the class being frozen, but in a third of the time: each goal makes a pose.
_set_x, _set_y, _set_yaw = Pose2D.x.__set__, Pose2D.y.__set__, Pose2D.yaw.__set__


def yaw_of_quaternion(quaternion):
    """Return the rotation about z [rad] of ``quaternion`` = (x, y, z, w), of any length but 0.

    Formula: the yaw of the z-y-x Euler angles of a rotation (REP 103).
    """
    x, y, z, w = quaternion
    return math.atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)


def quaternion_of_yaw(yaw):
    """Return the unit quaternion (x, y, z, w) of a rotation about z by ``yaw`` [rad]."""
    return 0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0)


def turned_about_z(quaternion, yaw):
    """Return ``quaternion`` = (x, y, z, w), turned about the fixed z axis by ``yaw`` [rad] (Hamilton's product)."""
    x, y, z, w = quaternion
    sin, cos = math.sin(yaw / 2.0), math.cos(yaw / 2.0)
    return cos * x - sin * y, cos * y + sin * x, cos * z + sin * w, cos * w - sin * z


def quaternion_fault(quaternion):
    """Return what keeps ``quaternion`` = (x, y, z, w) from being a goal's orientation, or None.

    The three tests, their limits and texts are those of move_base: finite, long enough to be normalised, and a
    rotation about z only. Any other length is accepted.
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
