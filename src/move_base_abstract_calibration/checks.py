"""Check recordings: legs that would spoil the fit are left out and counted, or the whole recording is refused."""
from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING, AbstractSet, Any, Dict, Iterable, Iterator, List, Mapping, Sequence, Set, Tuple

import numpy as np

from move_base_abstract.common.errors import ConfigurationError

from .legs import FAR_STEP

if TYPE_CHECKING:
    from .legs import RecordedLeg

#: why legs are left out, in the words that follow their number; docs/calibrate.md has the rules and their reasons
DOUBTS = {
    'clock_back': 'lie in times that the clock showed twice',
    'clock_leap': 'took another time by their stamps than by the recording: the clock leapt',
    'overlap': 'began before the previous one had ended: two robots under one name',
    'twice': 'are there twice',
    'teleport': 'have poses that jump: somebody moved the robot, or the poses are those of another robot',
    'rare': 'have poses further than {:g} m apart: too rare'.format(FAR_STEP),
    'elsewhere': 'ended far from their goal although they succeeded: poses from elsewhere',
    'short_way': 'have a way that is shorter than the straight line: poses of another frame than the plan',
}
_BACK = 1.0  # s; a later message may have a stamp that is earlier by this much
_STAMPS = 0.25  # s; a duration may differ this much from that by stamps, which is more than two steps of a simulator
_OVERLAP = 1.0  # s; a leg may end this much after the next goal was sent, because a new goal ends the one before
_TOO_FAST = 2.0  # times the mean speed of fast legs
_FAR_END = (0.5, 4.0)  # m, times the median of all legs: the larger one is the farthest end from a goal
_SHORTER = (0.5, 0.05)  # m, share of the straight line: a way may be shorter than the line by the larger one
_MOST_DOUBTS = 0.5  # the share of all legs that may have one kind of doubt
_FAR_ENDS = (1.0, 0.1)  # m, share of the straight lines: the larger one bounds the median distance of ends from goals
_OFFSET = (10, 0.25, 0.8)  # legs, m, share: so many ends, this far from their goals, and this much to one side


def examine(legs: Sequence[RecordedLeg]) -> Tuple[List[RecordedLeg], List[str]]:
    """Return (the legs that may be fitted, notes about those that are left out).

    :raises ConfigurationError: if the fault is not in single legs but in the recording.
    """
    _check_frame(legs)
    doubts = list(_doubts(legs))
    counts = Counter(filter(None, doubts))
    for doubt, count in counts.items():
        if count > _MOST_DOUBTS * len(legs):
            raise ConfigurationError('{} of {} legs {}, more than half of them: so many are not left out'.format(
                count, len(legs), DOUBTS[doubt]))
    notes = ['{} legs {}, and are left out'.format(counts[doubt], words)
             for doubt, words in DOUBTS.items() if counts[doubt]]
    kept = [leg for leg, doubt in zip(legs, doubts) if not doubt]
    _check_names(kept, notes)
    for count, words in ((sum(not leg.counts for leg in kept), 'were moved, stuck from the start or cut off'),
                         (sum(leg.counts and not (leg.succeeded or leg.failed) for leg in kept),
                          'neither succeeded nor aborted (no result, preempted, cancelled)')):
        if count:
            notes.append('{} legs {}, and do not count'.format(count, words))
    return kept, notes


def shown_twice(times: Iterable[float]) -> List[Tuple[float, float]]:
    """Return [(low, high)]: the spans of time that a clock showed twice; ``times`` [s]: in the order as they came."""
    found, highest = [], -math.inf
    for time in times:
        if time < highest - _BACK:
            found.append((time, highest))
        highest = max(highest, time)
    return found


def times_of_two_runs(times: Iterable[float]) -> List[Tuple[float, float]]:
    """Return [(low, high)]: spans of time with those that two runs of a clock have in common.

    ``times`` [s]: in the order as they came; where they go back, another run begins. Messages that are only out of
    order, such as a later part of a bag that was written first, are runs that have nothing in common.
    """
    runs: List[Tuple[float, float]] = []
    for time in times:
        if runs and time >= runs[-1][1] - _BACK:
            runs[-1] = runs[-1][0], max(time, runs[-1][1])
        else:
            runs.append((time, time))
    found, highest = [], -math.inf
    for low, high in sorted(runs):
        if low + _BACK < min(high, highest):
            found.append((low, highest))
        highest = max(high, highest)
    return found


def _doubts(legs: Sequence[RecordedLeg]) -> Iterator[str]:
    """Yield the fault of each leg: a key of DOUBTS, or ''."""
    back = _sent_twice(legs)
    overlapping = _overlapping(legs)
    seen = set()
    speeds = [leg.start.distance_to(leg.goal) / leg.duration for leg in legs if leg.succeeded and leg.duration > 0.0]
    fastest = _TOO_FAST * float(np.quantile(speeds, 0.95)) if speeds else math.inf
    ends = [leg.end.distance_to(leg.goal) for leg in legs if leg.succeeded and leg.end is not None]
    furthest = max(_FAR_END[0], _FAR_END[1] * float(np.median(ends))) if ends else math.inf
    for leg in legs:
        same = leg.start, leg.goal, leg.duration
        yield leg.doubt or _doubt_of(leg, back, overlapping, same in seen, fastest, furthest)
        seen.add(same)


def _doubt_of(leg: RecordedLeg, back: Mapping[Tuple[str, str], List[Tuple[float, float]]],
              overlapping: AbstractSet[int], is_known: bool, fastest: float,
              furthest: float) -> str:
    straight = leg.start.distance_to(leg.goal)
    found = {
        'clock_back': any(leg.sent < high and leg.sent + leg.duration > low
                          for low, high in back.get(_name(leg), ()) if leg.sent is not None),
        'clock_leap': leg.by_stamps is not None and abs(leg.by_stamps - leg.duration) > _STAMPS,
        'overlap': id(leg) in overlapping,
        'twice': is_known,
        'teleport': leg.succeeded and straight > fastest * leg.duration,
        'elsewhere': leg.succeeded and leg.end is not None and leg.end.distance_to(leg.goal) > furthest,
        'short_way': leg.way is not None and leg.way.length < straight - max(_SHORTER[0], _SHORTER[1] * straight),
    }
    return next((doubt for doubt, is_so in found.items() if is_so), '')


def _name(leg: RecordedLeg) -> Tuple[str, str]:
    return leg.recording, leg.robot


def _by_robot(legs: Sequence[RecordedLeg]) -> Dict[Tuple[str, str], List[RecordedLeg]]:
    """Return {(recording, robot): its legs}."""
    found: Dict[Any, Any] = {}
    for leg in legs:
        found.setdefault(_name(leg), []).append(leg)
    return found


def _sent_twice(legs: Sequence[RecordedLeg]) -> Dict[Tuple[str, str], List[Tuple[float, float]]]:
    """Return {(recording, robot): [(low, high)]}: spans of time shown twice, by goals in the order of their numbers."""
    found: Dict[Any, Any] = {}
    for name, own in _by_robot(legs).items():
        sent = latest = -math.inf
        timed: Any = [leg for leg in own if leg.sent is not None]
        for leg in sorted(timed, key=lambda leg: leg.number):
            if leg.sent < sent - _BACK:
                found.setdefault(name, []).append((leg.sent, latest))
            sent, latest = max(sent, leg.sent), max(latest, leg.sent + leg.duration)
    return found


def _overlapping(legs: Sequence[RecordedLeg]) -> Set[int]:
    """Return the id() of legs of one robot that overlap in time."""
    found = set()
    for own in _by_robot(legs).values():
        timed: Any = [leg for leg in own if leg.sent is not None]
        ordered = sorted(timed, key=lambda leg: leg.sent)
        for one, other in zip(ordered, ordered[1:]):
            if other.sent < one.sent + one.duration - _OVERLAP:
                found |= {id(one), id(other)}
    return found


def _check_frame(legs: Sequence[RecordedLeg]) -> None:
    """Check that legs that succeeded end at their goals; otherwise the poses are of another frame or map."""
    gaps = np.array([(leg.end.x - leg.goal.x, leg.end.y - leg.goal.y) for leg in legs
                     if leg.succeeded and leg.end is not None])
    if not len(gaps):
        return
    lengths = np.hypot(*gaps.T)
    median, mean = float(np.median(lengths)), np.median(gaps, axis=0)
    least, far, share = _OFFSET
    one_way = len(gaps) >= least and median > far and float(np.hypot(*mean)) > share * median
    most = max(_FAR_ENDS[0], _FAR_ENDS[1] * float(np.median([leg.start.distance_to(leg.goal) for leg in legs])))
    if median > most or one_way:
        raise ConfigurationError(
            'legs that succeeded end {:.2f} m from their goals in the median, by ({:.2f}, {:.2f}) m; allowed: at most '
            '{:.1f} m, and above {:g} m not all to one side: the poses are those of another frame or map than the '
            'goals'.format(median, *map(float, mean), most, far))


def _check_names(legs: Sequence[RecordedLeg], notes: List[str]) -> None:
    """Note legs that do not begin where the one before ended; if these are most legs, refuse the recording."""
    begun = elsewhere = 0
    for own in _by_robot(legs).values():
        ordered = sorted(own, key=lambda leg: leg.number)
        pairs: Any = [(one, other) for one, other in zip(ordered, ordered[1:])
                 if other.number - one.number <= 1 and one.end is not None]
        begun += len(pairs)
        elsewhere += sum(one.end.distance_to(other.start) > FAR_STEP for one, other in pairs)
    words = '{} of {} legs begin further than {:g} m from where the one before ended'.format(
        elsewhere, begun, FAR_STEP)
    if elsewhere > max(5.0, _MOST_DOUBTS * begun):
        raise ConfigurationError('{}; allowed: at most half of them: there are two robots under one name, or the '
                                 'numbers of goals are those of others'.format(words))
    if elsewhere:
        notes.append('{}: the robot was moved there; they count'.format(words))
