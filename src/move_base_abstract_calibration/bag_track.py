"""The track and the plans of one robot in a bag, and the legs in which its poses cannot be right."""
from __future__ import annotations

import bisect
import math
import struct
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

import genpy
import numpy as np
import rosbag

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.motion.geometry import Pose2D, normalize_angle, yaw_of_quaternion

from .legs import FAR_STEP, Way, way_along

#: the exceptions of rosbag if a bag cannot be read, or is damaged
BROKEN = (OSError, rosbag.ROSBagException, genpy.MessageException, struct.error, KeyError, ValueError)
_PATH = 'nav_msgs/Path'
_POSES = ('nav_msgs/Odometry', 'geometry_msgs/PoseWithCovarianceStamped')
#: the topics in a robot's namespace, the best one first
_POSE_TOPICS = ('base_pose_ground_truth', 'amcl_pose', 'odom')
_NEAR = 1.0  # m; the directions at the ends of a plan are measured over this distance
_LEAP = 2.0  # s; in a longer time without a pose, the clock may have leapt
_TOO_FAST = 3.0  # times the top speed of all steps: no robot drives so fast
_RETURNS = (5, 0.01)  # if poses return so often, and this often per pose, two robots publish in turns


class Track:
    """The poses and plans of one robot, by time [s].

    ``topic`` and ``frame``: of the poses; ``publishers``: the nodes that published them at the same time, if several.

    :raises ConfigurationError: if there are no poses of the robot.
    """

    def __init__(self, bag: Any, types: Mapping[str, str], namespace: str, pose_topic: Optional[str],
                 path: str) -> None:
        topics = ['{}/{}'.format(namespace, name) for name in ([pose_topic] if pose_topic else _POSE_TOPICS)]
        found = [topic for topic in topics if types.get(topic) in _POSES]
        if not found:
            raise ConfigurationError('{}: no poses of {}; allowed: one of {}, of {}'.format(
                path, namespace or '/', ', '.join(topics), ' or '.join(_POSES)))
        self.topic, self.frame = found[0], ''
        track: List[Tuple[float, Optional[Pose2D]]] = []
        told: Dict[Any, Tuple[float, float]] = {}  # by the name of a node, as rosbag has it
        for _, message, time, header in bag.read_messages(topics=[self.topic], return_connection_header=True):
            at = stamp(message.header, time)
            track.append((at, pose_of(message.pose.pose)))
            self.frame = message.header.frame_id.lstrip('/')
            who = header.get('callerid')
            told[who] = min(at, told.get(who, (at, at))[0]), max(at, told.get(who, (at, at))[1])
        self.publishers = _at_once(told)
        known = sorted(((time, pose) for time, pose in track if pose is not None), key=lambda one: one[0])
        self._times, self._poses = [time for time, _ in known], [pose for _, pose in known]
        self._top_speed = _top_speed(self._times, self._poses)
        plans = [topic for topic, kind in types.items()
                 if kind == _PATH and topic.startswith(namespace + '/') and topic.endswith('/plan')]
        self._plans = [(stamp(message.header, time), _path(message))
                       for _, message, time in bag.read_messages(topics=plans)] if plans else []

    def at(self, time: float) -> Optional[Pose2D]:
        """Return the latest pose up to ``time`` [s], or None if there is none."""
        index = bisect.bisect_right(self._times, time)
        return self._poses[index - 1] if index else None

    def way(self, begin: float, end: float, start: Pose2D, goal: Pose2D) -> Optional[Way]:
        """Return the Way of the first plan from ``begin`` to ``end`` [s]; without a plan, of the poses, or None."""
        for time, plan in self._plans:
            if begin <= time <= end and len(plan) > 1:
                return _way(start, plan, goal)
        driven = self._poses[bisect.bisect_left(self._times, begin):bisect.bisect_right(self._times, end)]
        return _way(start, [start, *driven], goal) if driven else None

    def doubt(self, begin: float, end: float) -> str:
        """Return the fault of the poses from ``begin`` to ``end`` [s]: a key of checks.DOUBTS, or ''."""
        first = max(0, bisect.bisect_right(self._times, begin) - 1)
        last = bisect.bisect_right(self._times, end)
        times, poses = self._times[first:last], self._poses[first:last]
        steps = [(later - sooner, one.distance_to(other))
                 for sooner, later, one, other in zip(times, times[1:], poses, poses[1:])]
        if any(length > FAR_STEP and length > _TOO_FAST * self._top_speed * seconds for seconds, length in steps):
            return 'teleport'
        for (before, way_before), (seconds, length), (after, way_after) in zip(steps, steps[1:], steps[2:]):
            speed = min(way_before / max(before, 1e-9), way_after / max(after, 1e-9))
            if seconds > _LEAP and speed > 0.5 * self._top_speed and length < speed * seconds / 3.0:
                return 'clock_leap'
        return 'rare' if any(length > FAR_STEP for _, length in steps) else ''

    def returns(self) -> Optional[int]:
        """Return how often the robot is elsewhere for one pose and then back, as if two robots published in turns.

        Return None if that may be chance.
        """
        poses = self._poses
        found = sum(one.distance_to(other) > FAR_STEP and one.distance_to(third) < 0.25 * one.distance_to(other)
                    for one, other, third in zip(poses, poses[1:], poses[2:]))
        return found if found >= max(_RETURNS[0], _RETURNS[1] * len(poses)) else None


def stamp(header: Any, time: Any) -> float:
    """Return when a message was made [s]; without a stamp in its header, when it was recorded."""
    return (header.stamp if header.stamp.to_nsec() else time).to_sec()


def pose_of(pose: Any) -> Optional[Pose2D]:
    """Return a geometry_msgs/Pose as a Pose2D, or None if its numbers are not valid."""
    try:
        return Pose2D(pose.position.x, pose.position.y, yaw_of_quaternion(quaternion_of(pose)))
    except ValueError:
        return None


def quaternion_of(pose: Any) -> Tuple[float, float, float, float]:
    """Return (x, y, z, w) of a geometry_msgs/Pose."""
    orientation = pose.orientation
    return orientation.x, orientation.y, orientation.z, orientation.w


def _at_once(told: Mapping[Any, Tuple[float, float]]) -> List[str]:
    """Return the names of nodes, sorted, whose spans overlap; ``told``: {name: (first, last) [s]}."""
    spans = sorted((span, name) for name, span in told.items() if name is not None)
    found = set()
    for (one, name), (other, other_name) in zip(spans, spans[1:]):
        if other[0] < one[1]:
            found |= {name, other_name}
    return sorted(name.decode() if isinstance(name, bytes) else str(name) for name in found)


def _top_speed(times: Sequence[float], poses: Sequence[Pose2D]) -> float:
    """Return the speed [m/s] of fast steps: the 95th percentile of all steps in which the robot moves."""
    speeds = [one.distance_to(other) / (later - sooner) for sooner, later, one, other in zip(
        times, times[1:], poses, poses[1:]) if later > sooner and one.distance_to(other) > 0.01]
    return float(np.quantile(speeds, 0.95)) if speeds else 0.0


def _way(start: Pose2D, poses: Sequence[Pose2D], goal: Pose2D) -> Way:
    """Return the Way along ``poses``; its directions are those of the first and the last metre."""
    points = [(pose.x, pose.y) for pose in poses]
    length = math.fsum(math.dist(one, other) for one, other in zip(points, points[1:]))
    straight = way_along(start, (), goal)
    if length < 2.0 * _NEAR or straight.length < _NEAR:
        return Way(max(length, straight.length), straight.start_turn, straight.end_turn)
    first = next((point for point in points if math.dist(point, points[0]) >= _NEAR), points[-1])
    last = next((point for point in reversed(points) if math.dist(point, points[-1]) >= _NEAR), points[0])
    return Way(length, normalize_angle(math.atan2(first[1] - points[0][1], first[0] - points[0][0]) - start.yaw),
               normalize_angle(goal.yaw - math.atan2(points[-1][1] - last[1], points[-1][0] - last[0])))


def _path(message: Any) -> List[Pose2D]:
    found = [pose_of(one.pose) for one in message.poses]
    return [pose for pose in found if pose is not None]
