"""The built-in metrics of a trial, from its event log alone.

A robot *moves* from `departed` to `stands`. It *waits* while it stands and the goal for which it has departed has not
ended. Otherwise it is *idle*. The distance of a leg goes along its corners, from where the robot stood before to where
it stands then. The first position comes from a row `motion`, or from the caller, who knows the launch file. A leg that
the end of the run cuts off adds nothing to the distance, because the log does not say where it was cut. Robots *meet*
in a run that has a row `meets`; each of the two robots of an encounter has a row `encounter`. Orders, and how robots
spent their time then, are in :mod:`.fleet_account`.
"""
from __future__ import annotations

import hashlib
import json
import math
import sys
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple

from move_base_abstract.motion.geometry import share_along
from move_base_abstract.runs import ends, event_log
from move_base_abstract.runs.event_log import Event, EventLog, EventLogError
from move_base_abstract.runs.fleet_account import FleetAccount
from move_base_abstract.runs.run_difference import MESSAGES

from . import radio, termination
from .validity import Validity

Place = Optional[Tuple[float, float]]  # (x, y) [m]; None: not known
Starts = Dict[str, Place]  # {robot: where it stands at the start}
_NS_PER_S = 1e9  # dividing by it rounds once
_NEAR = 1e-9  # m; a point must be nearer than another one by this much
#: the kinds of rows about a robot's place; robot_trace explains them
PLACES = ('motion', 'departed', 'route', 'stands')
REACHED = 'SUCCEEDED'
FAILED = ('ABORTED', 'REJECTED', 'LOST')
ROBOT_VALUES = ('goals', 'distance_m', 'moving_s', 'idle_s', 'waiting_s')


class Summary(NamedTuple):
    """The content of a log: the numbers that were counted, and the labels of the end record.

    ``robots``: {name: {one of ROBOT_VALUES, or of validity.ROBOT_VALUES: number}}.
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


class _Robot:
    """The state and the sums of one robot while its events are read."""

    def __init__(self, place: Place, start_ns: int) -> None:
        self.place = place  # where it stands or last stood
        self.way: Tuple[Tuple[float, float], ...] = ()  # (x, y) [m] of the corners and of the goal, while it moves
        self.since_ns = start_ns
        self.state = 'idle'
        self.ns = {'moving': 0, 'idle': 0, 'waiting': 0}
        self.goals = 0
        self.distance = 0.0

    def be(self, state: str, now_ns: int) -> None:
        self.ns[self.state] += now_ns - self.since_ns
        self.state, self.since_ns = state, now_ns

    def stand(self, x: float, y: float, now_ns: int) -> None:
        if self.state == 'moving':
            self.distance += 0.0 if self.place is None else driven((self.place, *self.way), (x, y))
            self.be('waiting', now_ns)
        self.place = (x, y)

    def values(self) -> Dict[str, float]:
        return {'goals': self.goals, 'distance_m': round(self.distance, 9),
                **{f'{state}_s': self.ns[state] / _NS_PER_S for state in ('moving', 'idle', 'waiting')}}


def driven(way: Sequence[Tuple[float, float]], end: Tuple[float, float]) -> float:
    """Return the length [m] of a way up to its point nearest to ``end``, plus the distance from there to ``end``.

    If several points are equally near, the first one counts. ``way``: [(x, y), ...] [m]; ``end``: (x, y) [m].
    """
    if len(way) <= 2:
        return math.dist(way[0], end)
    best = (math.inf, 0.0)
    before = 0.0
    for one, other in zip(way, way[1:]):
        length = math.dist(one, other)
        share = share_along(one, other, *end)
        foot = (one[0] + share * (other[0] - one[0]), one[1] + share * (other[1] - one[1]))
        off = math.dist(foot, end)
        if off < best[0] - _NEAR:
            best = (off, before + share * length + off)
        before += length
    return best[1]


def summarise(path: str, starts: Optional[Starts] = None) -> Summary:
    """Return the Summary of an event log. ``starts``: {robot: (x, y)} [m], where the robots stand at the start.

    :raises EventLogError: if it cannot be read, or the run did not end properly.
    """
    with event_log.open_text(path) as stream:
        log = EventLog(stream, path)
        tally, last_ns, told = _Tally(starts or {}, log.start_ns), log.start_ns, ends.Log()
        for event in log:
            last_ns = event.time_ns
            if event.kind in ends.KINDS:
                told.take(event)
            elif event.kind not in MESSAGES:
                tally.take(event)
    end = log.end
    if end is None:
        raise EventLogError(f'{path}: has no end record: the run did not end properly')
    told.end(end)
    end_ns = max(last_ns, end.get('at_ns', 0))
    open_goals = tally.close(end_ns)
    seconds, robots, labels = (end_ns - log.start_ns) / _NS_PER_S, tally.by_robot(), event_log.labels_of(end)
    tally.fleet.close(end_ns)
    return Summary({**tally.metrics(seconds, robots), **tally.fleet.metrics()}, robots, seconds, log.events,
                   bool(end.get('repeatable')) and not labels, labels, end.get('reason', ''), termination.of_run(end),
                   bool(end.get('by_fault')), open_goals, told,
                   {where: one.total_ns / _NS_PER_S for where, one in tally.fleet.waits.items()})


class _Tally:
    """The sums of all robots while the events of a log are read."""

    def __init__(self, starts: Starts, start_ns: int) -> None:
        self._starts = starts
        self._start_ns = self._last_ns = start_ns  # the latter: when the last goal ended
        self._robots: Dict[str, _Robot] = {}
        self._validity = Validity()
        self.fleet = FleetAccount(start_ns)
        self._radio = radio.Radio()
        self._reached = self._failed = self._encounters = 0
        self._stood: Optional[float] = None  # s; None: robots do not meet

    def take(self, event: Event) -> None:
        values = json.loads(event.values)
        self._validity.take(event.robot, event.kind, values)
        self.fleet.take(event.time_ns, event.robot, event.kind, values)
        if event.kind in PLACES and len(values) >= 2 and all(map(_is_number, values)):  # anybody may write such rows
            self._take_place(event, values)
        elif event.kind in radio.KINDS:
            self._radio.take(event.kind, values, event.time_ns)
        elif event.kind == 'meets':
            self._stood = self._stood or 0.0
        elif event.kind == 'encounter' and len(values) == 4 and _is_number(values[3]):
            self._encounters += 1
            self._stood = (self._stood or 0.0) + values[3]
        elif event.kind == 'ended' and len(values) >= 2:
            self._reached += values[1] == REACHED
            self._failed += values[1] in FAILED
            self._last_ns = event.time_ns
            if event.robot in self._robots:
                robot = self._robots[event.robot]
                robot.goals += values[1] == REACHED
                if robot.state == 'waiting':
                    robot.be('idle', event.time_ns)

    def _take_place(self, event: Event, values: List[Any]) -> None:
        if event.robot not in self._robots:
            self._robots[event.robot] = _Robot(self._starts.get(event.robot), self._start_ns)
        robot = self._robots[event.robot]
        if event.kind == 'stands':
            robot.stand(values[0], values[1], event.time_ns)
        elif event.kind == 'departed':
            robot.be('moving', event.time_ns)
            robot.way = ((values[0], values[1]),)
        elif event.kind == 'route':
            robot.way = (*zip(values[::2], values[1::2]), *robot.way[-1:])
        elif robot.state != 'moving':  # a row `motion`, which has the robot's place and its limits of motion
            robot.place = (values[0], values[1])

    def close(self, end_ns: int) -> int:
        """End the sums; return the number of robots that moved, or stood with a goal, when the run ended."""
        count = sum(robot.state != 'idle' for robot in self._robots.values())
        for robot in self._robots.values():
            robot.be('idle', end_ns)
        return count

    def by_robot(self) -> Dict[str, Dict[str, float]]:
        return {name: {**self._robots[name].values(), **self._validity.of_robot(name)} for name in sorted(self._robots)}

    def metrics(self, seconds: float, robots: Dict[str, Dict[str, float]]) -> Dict[str, Optional[float]]:
        def mean(key: str) -> Optional[float]:
            return round(sum(one[key] for one in robots.values()) / len(robots), 9) if robots else None
        has_ended = self._reached + self._failed > 0
        found: Dict[str, Optional[float]] = {
            'goals': self._reached, 'goals_failed': self._failed,
            'makespan': (self._last_ns - self._start_ns) / _NS_PER_S if has_ended else None,
            'distance': round(sum(one['distance_m'] for one in robots.values()), 9),
            'moving': mean('moving_s'), 'idle': mean('idle_s'), 'waiting': mean('waiting_s'),
            'throughput': self._reached * 3600.0 / seconds if seconds > 0.0 else None, **self._validity.metrics()}
        if self._stood is not None:
            found.update(encounters=self._encounters // 2, encounter_time=round(self._stood, 9))
        return {**found, **self._radio.metrics(self._start_ns + round(seconds * _NS_PER_S))}


def _is_number(value: Any) -> bool:
    """Return whether a value of a row is a finite number."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < sys.float_info.max


def digest(path: str) -> str:
    """Return the SHA-256 of a file, as hex."""
    found = hashlib.sha256()
    with open(path, 'rb') as stream:
        for piece in iter(lambda: stream.read(1 << 20), b''):
            found.update(piece)
    return found.hexdigest()
