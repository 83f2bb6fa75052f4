"""Legs from a bag: goals and results of move_base actions, where the robots were meanwhile, and their plans."""
import bisect
import math
import struct

import genpy
import rosbag

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.input_files import check_input
from move_base_abstract.common.shown import shown_text
from move_base_abstract.motion.geometry import Pose2D, normalize_angle, quaternion_fault, yaw_of_quaternion

from .legs import RecordedLeg, Way, way_along

_GOAL, _RESULT, _PATH = 'move_base_msgs/MoveBaseActionGoal', 'move_base_msgs/MoveBaseActionResult', 'nav_msgs/Path'
_POSES = ('nav_msgs/Odometry', 'geometry_msgs/PoseWithCovarianceStamped')
#: below a robot's namespace, the best one first
_POSE_TOPICS = ('base_pose_ground_truth', 'amcl_pose', 'odom')
_SUCCEEDED, _ABORTED = 3, 4
#: what rosbag lets out where a bag cannot be read, or is damaged
_BROKEN = (OSError, rosbag.ROSBagException, genpy.MessageException, struct.error, KeyError, ValueError)
_NEAR = 1.0  # m: how far along a plan its first and last directions are measured


def read_legs(path, pose_topic=None):
    """Return (RecordedLegs, notes) of the bag ``path``; ``pose_topic``: below each robot's namespace, None: the best.

    :raises ConfigurationError: if it cannot be read, or holds no goals, or no poses of a robot that has some.
    """
    try:
        check_input(path, what='bag')
        with rosbag.Bag(path) as bag:
            return _read(bag, str(path), pose_topic)
    except ConfigurationError:
        raise
    except _BROKEN as error:
        raise ConfigurationError('{}: cannot be read as a bag: {}'.format(
            shown_text(str(path)), getattr(error, 'strerror', None) or error)) from None


def _read(bag, path, pose_topic):
    types = {topic: info.msg_type for topic, info in bag.get_type_and_topic_info().topics.items()}
    actions = sorted(topic[:-len('goal')] for topic, kind in types.items() if kind == _GOAL and topic.endswith('/goal'))
    if not actions:
        raise ConfigurationError('{}: no goals; allowed: a bag with topics of {}, called .../goal'.format(path, _GOAL))
    legs, notes = [], []
    for action in actions:
        namespace = action.rstrip('/').rpartition('/')[0]
        tracks = _Track(bag, types, namespace, pose_topic, path)
        found, frames, strange_goals = _legs_of(bag, action, namespace, tracks, path)
        legs += found
        if strange_goals:
            notes.append('{}: {} goals of {} are no poses in the plane, and are left out'.format(
                path, strange_goals, namespace or '/'))
        strange = sorted(frames - {tracks.frame})
        if strange:
            notes.append('{}: goals of {} are in {}, its poses ({}) in {}: taken for the same frame'.format(
                path, namespace or '/', ', '.join(map(shown_text, strange)), tracks.topic, shown_text(tracks.frame)))
    return legs, notes


class _Track:
    """Where one robot was, and what it planned, by time [s]."""

    def __init__(self, bag, types, namespace, pose_topic, path):
        topics = ['{}/{}'.format(namespace, name) for name in ([pose_topic] if pose_topic else _POSE_TOPICS)]
        found = [topic for topic in topics if types.get(topic) in _POSES]
        if not found:
            raise ConfigurationError('{}: no poses of {}; allowed: one of {}, of {}'.format(
                path, namespace or '/', ', '.join(topics), ' or '.join(_POSES)))
        self.topic, self.frame = found[0], ''
        track = []
        for _, message, time in bag.read_messages(topics=[self.topic]):
            track.append((_stamp(message.header, time), _pose(message.pose.pose)))
            self.frame = message.header.frame_id.lstrip('/')
        track = sorted((one for one in track if one[1] is not None), key=lambda one: one[0])
        self._times, self._poses = [time for time, _ in track], [pose for _, pose in track]
        plans = [topic for topic, kind in types.items()
                 if kind == _PATH and topic.startswith(namespace + '/') and topic.endswith('/plan')]
        self._plans = [(_stamp(message.header, time), _path(message))
                       for _, message, time in bag.read_messages(topics=plans)] if plans else []

    def at(self, time):
        """Return the latest pose up to ``time`` [s], or None."""
        index = bisect.bisect_right(self._times, time)
        return self._poses[index - 1] if index else None

    def way(self, begin, end, start, goal):
        """Return the Way of the first plan from ``begin`` to ``end`` [s], else of what was driven."""
        for time, plan in self._plans:
            if begin <= time <= end and len(plan) > 1:
                return _way(start, plan, goal)
        driven = self._poses[bisect.bisect_left(self._times, begin):bisect.bisect_right(self._times, end)]
        return _way(start, [start, *driven], goal) if driven else None


def _way(start, poses, goal):
    """Return the Way along ``poses``, its directions those of the first and the last metre."""
    points = [(pose.x, pose.y) for pose in poses]
    length = math.fsum(math.dist(one, other) for one, other in zip(points, points[1:]))
    straight = way_along(start, (), goal)
    if length < 2.0 * _NEAR or straight.length < _NEAR:
        return Way(max(length, straight.length), straight.start_turn, straight.end_turn)
    first = next((point for point in points if math.dist(point, points[0]) >= _NEAR), points[-1])
    last = next((point for point in reversed(points) if math.dist(point, points[-1]) >= _NEAR), points[0])
    return Way(length, normalize_angle(math.atan2(first[1] - points[0][1], first[0] - points[0][0]) - start.yaw),
               normalize_angle(goal.yaw - math.atan2(points[-1][1] - last[1], points[-1][0] - last[0])))


def _legs_of(bag, action, namespace, track, path):
    """Return the legs of one action, the frames of its goals, and how many of these are no poses in the plane."""
    goals, legs, frames, strange = {}, [], set(), 0
    for topic, message, time in bag.read_messages(topics=[action + 'goal', action + 'result']):
        if topic.endswith('goal'):
            target = message.goal.target_pose
            frames.add(target.header.frame_id.lstrip('/'))
            goal = None if quaternion_fault(_quaternion(target.pose)) else _pose(target.pose)
            if goal is None:  # move_base refuses it
                strange += 1
            else:
                goals[message.goal_id.id] = (_stamp(message.header, time), goal)
            continue
        sent, goal = goals.pop(message.status.goal_id.id, (None, None))
        ended = _stamp(message.header, time)
        start = None if sent is None else track.at(sent)
        if start is None or not ended > sent:
            continue
        state = message.status.status
        legs.append(RecordedLeg(path, namespace, len(legs) + 1, start, goal, ended - sent, state == _SUCCEEDED,
                                state == _ABORTED, track.way(sent, ended, start, goal), track.at(ended)))
    return legs, frames, strange


def _stamp(header, time):
    return (header.stamp if header.stamp.to_nsec() else time).to_sec()


def _pose(pose):
    """Return a geometry_msgs/Pose as a Pose2D, None where its numbers are none."""
    try:
        return Pose2D(pose.position.x, pose.position.y, yaw_of_quaternion(_quaternion(pose)))
    except ValueError:
        return None


def _path(message):
    found = [_pose(one.pose) for one in message.poses]
    return [pose for pose in found if pose is not None]


def _quaternion(pose):
    orientation = pose.orientation
    return orientation.x, orientation.y, orientation.z, orientation.w
