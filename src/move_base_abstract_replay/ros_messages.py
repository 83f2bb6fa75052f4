"""A run as ROS messages: those that its robots would have published, computed from the log."""
from __future__ import annotations

import heapq
import io
import json
from typing import Any, Dict, Iterator, List, NamedTuple

from actionlib_msgs.msg import GoalStatus
from genpy import Time
from geometry_msgs.msg import PoseStamped, TransformStamped
from move_base_msgs.msg import MoveBaseActionGoal, MoveBaseActionResult
from nav_msgs.msg import Odometry
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from move_base_abstract.common.units import FARTHEST_M, NS_PER_S
from move_base_abstract.motion.geometry import Pose2D, quaternion_of_yaw

from .recording import is_number

EVENTS_TOPIC = '/event_log'  # has each event of the log as a line of JSON


class TopicMessage(NamedTuple):
    """A message on a topic at an instant [ns]."""

    time_ns: int
    topic: str
    message: Any

    @property
    def data(self) -> Any:
        """The message as bytes."""
        buffer = io.BytesIO()
        self.message.serialize(buffer)
        return buffer.getvalue()


def messages_of(recording: Any, motions: Any, rate: float, frame: str) -> Any:
    """Return the messages (TopicMessage) of a run, an iterator in the order of time; at one instant poses come first.

    ``rate`` [Hz, simulated]: that of the poses of moving robots, at multiples of its period; there is also a pose where
    a leg begins and ends. ``frame``: the frame of the poses.
    """
    poses = [_poses(track, rate, frame) for track in motions.tracks.values()]
    return heapq.merge(*poses, _events(recording, motions, frame), key=lambda one: one.time_ns)


def _instants(begin_ns: int, end_ns: int, period_ns: int) -> Iterator[int]:
    """Yield the instants [ns] of a motion at which there is a pose: its ends, and the grid between them."""
    yield begin_ns
    if end_ns > begin_ns:
        yield from range((begin_ns // period_ns + 1) * period_ns, end_ns, period_ns)
        yield end_ns


def _poses(track: Any, rate: float, frame: str) -> Iterator[Any]:
    period_ns = max(1, round(NS_PER_S / rate))
    for end_ns, motion in track.driven:
        for time_ns in _instants(motion.depart_ns, end_ns, period_ns):
            speeds = motion.velocity_at(time_ns) if time_ns < end_ns else (0.0, 0.0, 0.0)
            yield from _told_pose(track.name, time_ns, motion.pose_at(time_ns), speeds, frame)


def _told_pose(name: str, time_ns: int, pose: Any, speeds: Any, frame: str) -> Iterator[Any]:
    name = _plain(name.strip('/'))
    prefix, child = '/' + name, name + '/base_link'
    stamped = _stamped(PoseStamped(), time_ns, frame)
    _fill(stamped.pose, pose)
    odometry = _stamped(Odometry(child_frame_id=child), time_ns, frame)
    _fill(odometry.pose.pose, pose)
    twist = odometry.twist.twist
    twist.linear.x, twist.linear.y, twist.angular.z = speeds
    transform = _stamped(TransformStamped(child_frame_id=child), time_ns, frame)
    transform.transform.translation.x, transform.transform.translation.y = pose.x, pose.y
    _turn(transform.transform.rotation, pose.yaw)
    yield TopicMessage(time_ns, prefix + '/robot_pose', stamped)
    yield TopicMessage(time_ns, prefix + '/odom', odometry)
    yield TopicMessage(time_ns, '/tf', TFMessage([transform]))


def _events(recording: Any, motions: Any, frame: str) -> Iterator[Any]:
    """Yield the messages of all events, and of robots' goals and results."""
    goals = _goal_ids(recording, motions)
    for number, (time_ns, name, kind, values) in enumerate(recording):
        line = json.dumps({'time_ns': time_ns, 'robot': name, 'kind': kind, 'values': json.loads(values)})
        yield TopicMessage(time_ns, EVENTS_TOPIC, String(line))
        if name in motions.tracks and kind in ('departed', 'ended'):
            prefix = '/' + _plain(name.strip('/')) + '/move_base/'
            yield from (_goal if kind == 'departed' else _result)(
                prefix, time_ns, json.loads(values), goals.get(number, ''), frame)


def _goal_ids(recording: Any, motions: Any) -> Any:
    """Return {place of a departure among the events: ID of its goal}, the last one that the robot has taken in.

    A log without rows `goal` has the ID only when the goal ends.
    """
    found: Dict[Any, Any] = {}
    open_departures: Dict[Any, Any] = {}
    taken: Dict[Any, List[Any]] = {}
    for number, (_, name, kind, values) in enumerate(recording):
        if name not in motions.tracks or kind not in ('goal', 'departed', 'ended'):
            continue
        goal_id, own = (json.loads(values) or [''])[0], taken.setdefault(name, [])
        if kind == 'departed' and own:
            found[number] = own[-1]
        elif kind == 'departed':
            open_departures.setdefault(name, []).append(number)
        elif kind == 'goal' and type(goal_id) is str:
            own.append(goal_id)
        elif kind == 'ended':
            own[:] = [one for one in own if one != goal_id]
            found.update((departure, goal_id) for departure in open_departures.pop(name, ()) if type(goal_id) is str)
    return found


def _goal(prefix: str, time_ns: int, values: Any, goal_id: str, frame: str) -> Iterator[Any]:
    if len(values) != 3 or not all(map(is_number, values)) or max(map(abs, values[:2])) > FARTHEST_M:
        return
    message = _stamped(MoveBaseActionGoal(), time_ns, '')
    message.goal_id.id = _plain(goal_id)
    message.goal_id.stamp = message.header.stamp
    _stamped(message.goal.target_pose, time_ns, frame)
    _fill(message.goal.target_pose.pose, Pose2D(*values))
    yield TopicMessage(time_ns, prefix + 'goal', message)


def _result(prefix: str, time_ns: int, values: Any, _goal_id: str, _frame: Any) -> Iterator[Any]:
    state = getattr(GoalStatus, str(values[1]), None) if len(values) == 3 else None
    if type(state) is not int or not all(isinstance(value, str) for value in values):
        return
    message = _stamped(MoveBaseActionResult(), time_ns, '')
    message.status.goal_id.id, message.status.status, message.status.text = _plain(values[0]), state, _plain(values[2])
    yield TopicMessage(time_ns, prefix + 'result', message)


def _plain(text: str) -> Any:
    """Return a text that UTF-8 can hold. A log may contain bytes that are not valid text."""
    return text.encode('utf-8', 'replace').decode('utf-8')


def _stamped(message: Any, time_ns: int, frame: str) -> Any:
    message.header.stamp = Time(*divmod(time_ns, NS_PER_S))
    message.header.frame_id = frame
    return message


def _fill(message: Any, pose: Any) -> None:
    message.position.x, message.position.y = pose.x, pose.y
    _turn(message.orientation, pose.yaw)


def _turn(message: Any, yaw: float) -> None:
    message.x, message.y, message.z, message.w = quaternion_of_yaw(yaw)
