"""Poses and quaternions, by the name that users know: the code is in ``common.geometry``, which all packages use."""
from ..common.geometry import (
    STRAIGHT_AHEAD,
    Pose2D,
    normalize_angle,
    quaternion_fault,
    quaternion_of_yaw,
    share_along,
    turned_about_z,
    yaw_of_quaternion,
)

__all__ = ['STRAIGHT_AHEAD', 'Pose2D', 'normalize_angle', 'quaternion_fault', 'quaternion_of_yaw', 'share_along',
           'turned_about_z', 'yaw_of_quaternion']
