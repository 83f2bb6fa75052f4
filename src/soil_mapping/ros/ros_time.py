"""Conversions between ROS's times and the mission's times in whole nanoseconds."""
from __future__ import annotations

from typing import Any

import rospy

NS_PER_S = 1_000_000_000


def now_ns() -> Any:
    """Return the present ROS time [simulated ns]."""
    return rospy.Time.now().to_nsec()


def to_ros_duration(duration_ns: int) -> Any:
    """Return nanoseconds as a rospy.Duration."""
    return rospy.Duration(duration_ns // NS_PER_S, duration_ns % NS_PER_S)
