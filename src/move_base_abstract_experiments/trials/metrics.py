"""The built-in metrics of a trial, from its event log alone.

What robots did and when is in the :class:`.Story` of the run. The distance of a leg goes along its corners, from where
the robot stood before to where it stands then. The first position comes from a row `motion`, or from the caller, who
knows the launch file. A leg that the end of the run cuts off adds nothing to the distance, because the log does not say
where it was cut. Robots *meet* in a run that has a row `meets`; each of the two robots of an encounter has a row
`encounter`.
"""
from __future__ import annotations

import math
import sys
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Set, Tuple

from move_base_abstract.motion.told import ToldMotion, motion_of_row
from move_base_abstract.runs import ends, event_log
from move_base_abstract.runs.event_log import EventLogError
from move_base_abstract.runs.metrics import Figures, RadioSums, metrics_of
from move_base_abstract.runs.run_difference import MESSAGES
from move_base_abstract.runs.states import STATES
from move_base_abstract.runs.story import Story
from move_base_abstract.runs.trace import TraceEntry

from . import termination

Place = Optional[Tuple[float, float]]  # (x, y) [m]; None: not known
Starts = Dict[str, Place]  # {robot: where it stands at the start}
_NS_PER_S = 1e9  # dividing by it rounds once
#: the kinds of rows about a robot's place, see goals.events
PLACES = ('motion', 'departed', 'driven', 'pieces', 'stands')
#: the keys of times that each robot has; those of other states are there if any robot was in them
_COMMON = ('moving_s', 'idle_s', 'waiting_s')
ROBOT_VALUES = ('goals', 'distance_m', *(state.key for state in STATES))
#: src/lockstep/radio_traffic.h and docs/radio.md explain these rows
_RADIO_KINDS = ('radio', 'radio_lost', 'link')
_SENT, _AT = 5, 6  # the places of the instants [ns] in a row `radio`: sent, arrived
#: the ways in which a goal can lie outside, see move_base_abstract.motion.recorded_range
BEYOND = ('longer', 'shorter', 'turn', 'narrow')
_GOAL_VALUES = ('goals_begun', 'goals_beyond', *(f'goals_beyond_{what}' for what in BEYOND))


class Summary(NamedTuple):
    """The content of a log: the numbers that were counted, and the labels of the end record.

    ``robots``: {name: {one of ROBOT_VALUES, or of the counts of :class:`Validity`: number}}.
    """

    metrics: Dict[str, Optional[float]]
    robots: Dict[str, Dict[str, float]]
    simulated_seconds: float
    events: int
    repeatable: bool
    labels: List[str]
    reason: str
    ended_by: str  # a code of termination
    by_fault: bool
    open_goals: int  # of robots that were under way or stood with a goal when the run ended
    log: ends.Log
    waits: Dict[str, float]  # {where: s}, all robots


class _Odometer:
    """How far a robot has driven, while its rows are read."""

    def __init__(self, place: Place) -> None:
        self.place = place  # where it stands or last stood
        self.departed_ns: Optional[int] = None  # when its leg under way began; None: it stands
        self.motion: Optional[ToldMotion] = None  # this leg, if the log has its pieces
        self.distance = 0.0

    def take(self, time_ns: int, kind: str, values: Sequence[Any]) -> None:
        """Take a row of one of the PLACES."""
        if kind == 'driven':
            self._stand(time_ns, (values[0], values[1]))
            self.departed_ns = time_ns
        elif kind == 'departed':
            if self.motion is not None:  # for another goal, on its way
                pose = self.motion.pose_at(time_ns)
                self._stand(time_ns, (pose.x, pose.y))
            self.departed_ns = time_ns
        elif kind == 'pieces':
            told = motion_of_row(values)
            if told is not None and self.departed_ns == time_ns == told.depart_ns:
                self.motion = told
        elif kind == 'stands' or self.departed_ns is None:  # or a row `motion`, which has the robot's place, too
            self._stand(time_ns, (values[0], values[1]))

    def _stand(self, time_ns: int, end: Tuple[float, float]) -> None:
        if self.departed_ns is not None:
            straight = math.dist(self.place, end) if self.place is not None else 0.0
            # No way is shorter than the straight line; robots of the original simulator are shown half-way.
            self.distance += max(straight, self.motion.distance_at(time_ns) if self.motion is not None else 0.0)
        self.place, self.departed_ns, self.motion = end, None, None


def summarise(path: str, starts: Optional[Starts] = None) -> Summary:
    """Return the Summary of an event log. ``starts``: {robot: (x, y)} [m], where the robots stand at the start.

    :raises EventLogError: if it cannot be read, or the run did not end properly.
    """
    with event_log.opened(path) as log:
        tally, told = _Tally(starts or {}, log.start_ns), ends.Log()
        for row in log.rows():
            told.take(row)
            if row.kind not in MESSAGES:
                tally.take(row)
    end = log.end
    if end is None:
        raise EventLogError(f'{path}: has no end record: the run did not end properly')
    told.end(end)
    story = tally.story
    story.close(end.get('at_ns'))
    robots, labels = tally.by_robot(), event_log.labels_of(end)
    return Summary(metrics_of(tally.figures(robots)), robots, story.seconds, log.events,
                   bool(end.get('repeatable')) and not labels, labels, end.get('reason', ''), termination.of_run(end),
                   bool(end.get('by_fault')), sum(one.begun('goal') is not None for one in story.robots.values()), told,
                   {where: one.total_ns / _NS_PER_S for where, one in story.waits.items()})


class _Tally:
    """The sums of all robots while the rows of a log are read."""

    def __init__(self, starts: Starts, start_ns: int) -> None:
        self._starts = starts
        self.story = Story(start_ns)
        self._odometers: Dict[str, _Odometer] = {}
        self._validity = Validity()
        self._radio = Radio()
        self._encounters = 0
        self._stood: Optional[float] = None  # s; None: robots do not meet

    def take(self, row: TraceEntry) -> None:
        time_ns, name, kind, values = row
        self._validity.take(name, kind, values)
        self.story.take(*row)
        if kind in PLACES and (kind == 'pieces' or len(values) >= 2 and all(map(_is_number, values))):  # of anybody
            if name not in self._odometers:
                self._odometers[name] = _Odometer(self._starts.get(name))
            self._odometers[name].take(time_ns, kind, values)
        elif kind in _RADIO_KINDS:
            self._radio.take(kind, values, time_ns)
        elif kind == 'meets':
            self._stood = self._stood or 0.0
        elif kind == 'encounter' and len(values) == 4 and _is_number(values[3]):
            self._encounters += 1
            self._stood = (self._stood or 0.0) + values[3]

    def by_robot(self) -> Dict[str, Dict[str, float]]:
        """Return the values of each robot. A state in which no robot was is left out, unless it is common."""
        robots, found = self.story.robots, {}
        for name, robot in robots.items():
            times = {state.key: robot.ns[number] / _NS_PER_S for number, state in enumerate(STATES)
                     if state.key in _COMMON or any(one.ns[number] for one in robots.values())}
            odometer = self._odometers.get(name)
            found[name] = {'goals': robot.goals, 'distance_m': round(odometer.distance, 9) if odometer else 0.0,
                           **times, **self._validity.of_robot(name)}
        return found

    def figures(self, robots: Dict[str, Dict[str, float]]) -> Figures:
        """Return all that metrics are computed of. ``robots``: the result of by_robot()."""
        return Figures(self.story, robots, self._validity.goals(), self._encounters // 2, self._stood,
                       self._radio.sums(self.story.end_ns))


def _is_number(value: Any) -> bool:
    """Return whether a value of a row is a finite number."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < sys.float_info.max


class Validity:
    """The counts of goals, from the rows ``recorded``, ``beyond``, ``departed`` and ``ended`` of a log."""

    def __init__(self) -> None:
        self._counts: Dict[str, Dict[str, float]] = {}  # of robots whose log has a row `recorded`
        self._under_way: Set[str] = set()  # the robots with a goal for which they have departed; never iterated

    def take(self, robot: str, kind: str, values: List[Any]) -> None:
        """Count a row; ``values`` is its list."""
        if kind == 'recorded':
            self._counts.setdefault(robot, dict.fromkeys(_GOAL_VALUES, 0))
        elif kind == 'ended':
            self._under_way.discard(robot)
        elif robot in self._counts and kind == 'departed' and robot not in self._under_way:
            self._under_way.add(robot)
            self._counts[robot]['goals_begun'] += 1
        elif robot in self._counts and kind == 'beyond':
            self._counts[robot]['goals_beyond'] += 1
            for what in BEYOND:
                self._counts[robot][f'goals_beyond_{what}'] += what in values

    def of_robot(self, robot: str) -> Dict[str, float]:
        """Return {one of _GOAL_VALUES: number}; {} for a robot without a row `recorded`."""
        return self._counts.get(robot, {})

    def goals(self) -> Optional[Tuple[float, float]]:
        """Return the number of goals, and of those outside; None if no robot has a row `recorded`."""
        if not self._counts:
            return None
        begun = sum(counts['goals_begun'] for counts in self._counts.values())
        return begun, sum(counts['goals_beyond'] for counts in self._counts.values())


class Radio:
    """The sums of a run's messages and links. Without a radio there are none."""

    def __init__(self) -> None:
        self._arrived = self._lost = self._age_ns = 0
        self._links: Dict[Tuple[str, str], Tuple[bool, int]] = {}  # whether it is up, since when [ns]
        self._down_ns = 0

    def take(self, kind: str, values: List[Any], now_ns: int) -> None:
        """Count a row of one of _RADIO_KINDS. Any program may write such a row; rows of another form are ignored."""
        if kind == 'link' and len(values) == 3 and all(isinstance(one, str) for one in values):
            self._turn((values[0], values[1]), values[2] == 'up', now_ns)
        elif kind == 'radio' and len(values) == _AT + 1 and all(type(one) is int for one in values[_SENT:]):
            self._arrived += 1
            self._age_ns += values[_AT] - values[_SENT]
        elif kind == 'radio_lost' and len(values) == _AT + 1:
            self._lost += 1

    def _turn(self, link: Tuple[str, str], is_up: bool, now_ns: int) -> None:
        was_up, since_ns = self._links.get(link, (True, now_ns))
        self._down_ns += 0 if was_up else now_ns - since_ns
        self._links[link] = is_up, now_ns

    def sums(self, end_ns: int) -> Optional[RadioSums]:
        """Return the sums of the run, which ended at ``end_ns``; None if it had no radio."""
        for link, (is_up, _) in list(self._links.items()):
            self._turn(link, is_up, end_ns)
        sent = self._arrived + self._lost
        if not sent and not self._links:
            return None
        return RadioSums(sent, self._arrived, self._age_ns, len(self._links), self._down_ns)
