"""Read legs from a bag: goals and results of move_base actions, the robots' poses meanwhile, and their plans."""
from __future__ import annotations

import statistics
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Sequence, Set, Tuple

import rosbag

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.input_files import check_input
from move_base_abstract.common.shown import shown_text
from move_base_abstract.motion.geometry import quaternion_fault

from .bag_track import BROKEN, Track, pose_of, quaternion_of, stamp
from .checks import shown_twice, times_of_two_runs
from .legs import RecordedLeg

if TYPE_CHECKING:
    from move_base_abstract.common.geometry import Pose2D

_GOAL = 'move_base_msgs/MoveBaseActionGoal'
_SUCCEEDED, _ABORTED = 3, 4
_LEAP = (1.0, 0.1)  # s, plus this share of the duration: stamps and the recording's times may differ by this much


def read_legs(path: str, pose_topic: Optional[str] = None) -> Tuple[List[RecordedLeg], List[str]]:
    """Return (RecordedLegs, notes) of the bag ``path``.

    ``pose_topic``: the topic of poses in each robot's namespace; None: the best one that is there.

    :raises ConfigurationError: if the bag cannot be read, or has no goals, or no poses of a robot that has goals.
    """
    try:
        check_input(path, what='bag')
        with rosbag.Bag(path) as bag:
            for index in bag._get_indexes(None):
                index.sort(key=lambda entry: entry.time.to_nsec())  # rosbag takes the parts of a file to be in order
            return _read(bag, str(path), pose_topic)
    except ConfigurationError:
        raise
    except BROKEN as error:
        raise ConfigurationError('{}: cannot be read as a bag: {}'.format(
            shown_text(str(path)), getattr(error, 'strerror', None) or error)) from None


def _read(bag: Any, path: str, pose_topic: Optional[str]) -> Tuple[List[RecordedLeg], List[str]]:
    types = {topic: info.msg_type for topic, info in bag.get_type_and_topic_info().topics.items()}
    actions = sorted(topic[:-len('goal')] for topic, kind in types.items() if kind == _GOAL and topic.endswith('/goal'))
    if not actions:
        raise ConfigurationError('{}: no goals; allowed: a bag with topics of {}, called .../goal'.format(path, _GOAL))
    legs: List[RecordedLeg] = []
    notes: List[str] = []
    for action in actions:
        namespace = action.rstrip('/').rpartition('/')[0]
        track = Track(bag, types, namespace, pose_topic, path)
        found = _Action(bag, action, namespace, track, path)
        legs += _of_one_robot(found.legs, track, namespace, path, notes)
        notes += found.notes()
        strange = sorted(found.frames - {track.frame})
        if strange:
            notes.append('{}: goals of {} are in {}, its poses ({}) in {}: taken for the same frame'.format(
                path, namespace or '/', ', '.join(map(shown_text, strange)), track.topic, shown_text(track.frame)))
    return legs, notes


def _of_one_robot(legs: List[RecordedLeg], track: Track, namespace: str, path: str,
                  notes: List[str]) -> List[RecordedLeg]:
    """Return ``legs``; if several robots publish in one namespace, return none, and add a note."""
    returns = track.returns()
    if len(track.publishers) < 2 and returns is None:
        return legs
    by = 'nodes tell poses at once: {}'.format(', '.join(map(shown_text, track.publishers))) \
        if len(track.publishers) > 1 else 'the poses go elsewhere and back {} times'.format(returns)
    notes.append('{}: two robots in the namespace {} ({}): its {} legs are left out'.format(
        path, namespace or '/', by, len(legs)))
    return []


class _Action:
    """The goals and results of one action: ``legs``, the ``frames`` of goals, notes() about those that are no legs."""

    def __init__(self, bag: Any, action: str, namespace: str, track: Track, path: str) -> None:
        self._name = '{}: {{}} {{}} of {}'.format(path, namespace or '/')
        self.legs: List[RecordedLeg] = []
        self.frames: Set[str] = set()
        self._strange = self._without_goal = self._placeless = 0
        goals: Dict[str, Any] = {}  # by ID: when sent [s], Pose2D or None, when recorded [s]
        recorded: List[float] = []
        for topic, message, time in bag.read_messages(topics=[action + 'goal', action + 'result']):
            if topic.endswith('goal'):
                self._take_goal(goals, message, time)
                continue
            sent, goal, recorded_at = goals.pop(message.status.goal_id.id, (None, None, None))
            if sent is None:
                self._without_goal += 1
            elif goal is not None:
                leg = self._leg(sent, stamp(message.header, time), goal, message.status.status, track, path, namespace)
                if leg is not None:
                    self.legs.append(leg)
                    recorded.append(time.to_sec() - recorded_at)
        self._without_result = len([goal for _, goal, _ in goals.values() if goal is not None])
        self._doubt_clocks(recorded, _twice(bag, (action + 'goal', action + 'result')))

    def notes(self) -> List[str]:
        """Return notes about goals and results that are no legs."""
        return [self._name.format(count, what) + why for count, what, why in (
            (self._strange, 'goals', ' are not poses in the plane, and are left out'),
            (self._without_result, 'goals', ' have no result, and are left out: of a robot that hung there, success '
             'is said too high'),
            (self._without_goal, 'results', ' have no goal, and are left out'),
            (self._placeless, 'goals', ' were sent before the first pose, and are left out')) if count]

    def _take_goal(self, goals: Dict[str, Any], message: Any, time: Any) -> None:
        target = message.goal.target_pose
        self.frames.add(target.header.frame_id.lstrip('/'))
        goal = None if quaternion_fault(quaternion_of(target.pose)) else pose_of(target.pose)
        self._strange += goal is None  # move_base refuses it
        goals[message.goal_id.id] = stamp(message.header, time), goal, time.to_sec()

    def _leg(self, sent: float, ended: float, goal: Pose2D, state: int, track: Track, path: str,
             namespace: str) -> Optional[RecordedLeg]:
        start = track.at(sent)
        if start is None:
            self._placeless += 1
            return None
        doubt = track.doubt(sent, ended) if ended > sent else 'clock_back'
        way = track.way(sent, ended, start, goal) if ended > sent else None
        return RecordedLeg(path, namespace, len(self.legs) + 1, start, goal, ended - sent, state == _SUCCEEDED,
                           state == _ABORTED, way, track.at(ended), sent=sent, doubt=doubt)

    def _doubt_clocks(self, recorded: Sequence[float], twice: Sequence[Tuple[float, float]]) -> None:
        """Mark legs that the clocks put in doubt.

        They lie in times that a clock showed twice (``twice``), or their durations by stamps and by the recording's
        times (``recorded`` [s]) differ.
        """
        ratios = [leg.duration / seconds for leg, seconds in zip(self.legs, recorded) if seconds > 0.0]
        usual = statistics.median(ratios) if ratios else 1.0
        for number, (leg, seconds) in enumerate(zip(self.legs, recorded)):
            doubt = leg.doubt
            assert leg.sent is not None  # _leg() has set it
            if any(leg.sent < high and leg.sent + leg.duration > low for low, high in twice):
                doubt = 'clock_back'
            elif abs(leg.duration - usual * seconds) > _LEAP[0] + _LEAP[1] * abs(leg.duration):
                doubt = doubt or 'clock_leap'
            self.legs[number] = leg._replace(doubt=doubt)


def _twice(bag: Any, topics: Sequence[str]) -> List[Tuple[float, float]]:
    """Return [(low, high)]: the spans of time [s] that the clock has shown twice, by the messages of each topic.

    Such spans show in stamps that go back. If the recorder used the same clock, they show in the order of the file,
    where two runs of that clock have times in common.
    """
    found: List[Tuple[float, float]] = []
    for topic in topics:
        found += shown_twice(stamp(message.header, time) for _, message, time in bag.read_messages(topics=[topic]))
        # We have sorted the indexes, and rosbag has no public function for the order in the file.
        entries = [entry for index in bag._get_indexes(bag._get_connections([topic])) for entry in index]
        found += times_of_two_runs(entry.time.to_sec() for entry in sorted(entries, key=lambda entry: entry.position))
    return found
