"""Between ROS's times and the whole nanoseconds in which the mission counts."""

import rospy

NS_PER_S = 1_000_000_000


def now_ns():
    """Return ROS's present [simulated ns]."""
    return rospy.Time.now().to_nsec()


def to_ros_duration(duration_ns):
    """Return nanoseconds as a rospy.Duration."""
    return rospy.Duration(duration_ns // NS_PER_S, duration_ns % NS_PER_S)
