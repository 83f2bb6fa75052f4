"""The built-in metrics of a trial, from its event log alone.

A robot *moves* from `departed` to `stands`; it *waits* while it stands with a goal that it has set out for and that has
not ended; else it is *idle*. Distances go along the corners of a leg, from where the robot stood before to where it
stands then; where it stood first a `motion` says, or who knows the launch file. A leg that the end of the run cuts off
adds nothing to the distance, as nobody has told where it was cut. Robots *meet* in a run that has a row `meets`; each
of two that do has a row `encounter`.
"""
import hashlib
import json
import math
import re
import sys
from typing import NamedTuple

from move_base_abstract.motion.geometry import share_along
from move_base_abstract.runs import event_log
from move_base_abstract.runs.event_log import EventLog, EventLogError
from move_base_abstract.runs.run_difference import MESSAGES
from move_base_abstract_ros.launching import ends

from .validity import Validity

_NS_PER_S = 1e9  # dividing by it rounds once
_NEAR = 1e-9  # m, by which one point must be nearer than another
#: of a robot; what each says stands at robot_trace
PLACES = ('motion', 'departed', 'route', 'stands')
_END = re.compile(r' at ([0-9]+(?:\.[0-9]+)?) s\b')
REACHED = 'SUCCEEDED'
FAILED = ('ABORTED', 'REJECTED', 'LOST')
ROBOT_VALUES = ('goals', 'distance_m', 'moving_s', 'idle_s', 'waiting_s')


class Summary(NamedTuple):
    """What a log says: the end record's labels, and numbers.

    ``robots``: {name: {one of ROBOT_VALUES, or of validity.ROBOT_VALUES: number}}.
    """

    metrics: dict
    robots: dict
    simulated_seconds: float
    events: int
    repeatable: bool
    labels: list
    reason: str
    by_fault: bool
    open_goals: int = 0  # of robots that were under way or stood with a goal when the run ended
    ends: object = None  # launching.ends.Log


class _Robot:
    """One robot while its events are read."""

    def __init__(self, place, start_ns):
        self.place = place  # (x, y) where it stands or last stood [m], or None
        self.way = ()  # (x, y) [m] of the corners and the goal that it is under way to
        self.since_ns = start_ns
        self.state = 'idle'
        self.ns = {'moving': 0, 'idle': 0, 'waiting': 0}
        self.goals = 0
        self.distance = 0.0

    def be(self, state, now_ns):
        self.ns[self.state] += now_ns - self.since_ns
        self.state, self.since_ns = state, now_ns

    def stand(self, x, y, now_ns):
        if self.state == 'moving':
            self.distance += 0.0 if self.place is None else driven((self.place, *self.way), (x, y))
            self.be('waiting', now_ns)
        self.place = (x, y)

    def values(self):
        return {'goals': self.goals, 'distance_m': round(self.distance, 9),
                **{f'{state}_s': self.ns[state] / _NS_PER_S for state in ('moving', 'idle', 'waiting')}}


def driven(way, end):
    """Return the length [m] of a way, [(x, y), ...] [m], to its point that is nearest to ``end``, and on to that.

    Of points that are equally near the first counts.
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


def summarise(path, starts=None):
    """Return the Summary of an event log. ``starts``: {robot: (x, y)} [m], where they stand first.

    :raises EventLogError: if it cannot be read, or the run did not end properly.
    """
    with event_log.open_text(path) as stream:
        log = EventLog(stream, path)
        start_ns = log.start_ns
        robots, endings, last_ns = {}, {'reached': 0, 'failed': 0, 'last_ns': start_ns}, start_ns
        told, validity = ends.Log(), Validity()
        for event in log:
            last_ns = event.time_ns
            if event.kind in ends.KINDS:
                told.take(event)
            elif event.kind not in MESSAGES:
                _take(robots, endings, event, starts or {}, start_ns, validity)
    if log.end is None:
        raise EventLogError(f'{path}: has no end record: the run did not end properly')
    end_ns = max(last_ns, _end_ns(log.end.get('reason', '')))
    open_goals = sum(robot.state != 'idle' for robot in robots.values())
    for robot in robots.values():
        robot.be('idle', end_ns)
    told.end(log.end)
    return _summary(robots, endings, log, start_ns, end_ns, validity)._replace(open_goals=open_goals, ends=told)


def _take(robots, endings, event, starts, start_ns, validity):
    values = json.loads(event.values)
    validity.take(event.robot, event.kind, values)
    if event.kind in PLACES and len(values) >= 2 and all(map(_is_number, values)):  # anybody may write such a row
        robot = robots.setdefault(event.robot, None) or _Robot(starts.get(event.robot), start_ns)
        robots[event.robot] = robot
        if event.kind == 'stands':
            robot.stand(values[0], values[1], event.time_ns)
        elif event.kind == 'departed':
            robot.be('moving', event.time_ns)
            robot.way = (tuple(values[:2]),)
        elif event.kind == 'route':
            robot.way = (*zip(values[::2], values[1::2]), *robot.way[-1:])
        elif robot.state != 'moving':  # its motion's limits are told, and where it is
            robot.place = tuple(values[:2])
    elif event.kind == 'meets':
        endings.setdefault('stood', 0.0)
    elif event.kind == 'encounter' and len(values) == 4 and _is_number(values[3]):
        endings['rows'] = endings.get('rows', 0) + 1
        endings['stood'] = endings.get('stood', 0.0) + values[3]
    elif event.kind == 'ended' and len(values) >= 2:
        endings['reached'] += values[1] == REACHED
        endings['failed'] += values[1] in FAILED
        endings['last_ns'] = event.time_ns
        robot = robots.get(event.robot)
        if robot is not None:
            robot.goals += values[1] == REACHED
            if robot.state == 'waiting':
                robot.be('idle', event.time_ns)


def _is_number(value):
    """Whether a value of a row is a finite number that can be counted with."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < sys.float_info.max


def _end_ns(reason):
    found = _END.search(reason)
    if found is None:
        return 0
    whole, _, part = found.group(1).partition('.')
    return int(whole) * 10**9 + int((part + '0' * 9)[:9])


def _summary(robots, endings, log, start_ns, end_ns, validity):
    seconds = (end_ns - start_ns) / _NS_PER_S
    by_robot = {name: {**robots[name].values(), **validity.of_robot(name)} for name in sorted(robots)}

    def mean(key):
        return round(sum(one[key] for one in by_robot.values()) / len(by_robot), 9) if by_robot else None
    ended = endings['reached'] + endings['failed']
    metrics = {
        'goals': endings['reached'], 'goals_failed': endings['failed'],
        'makespan': (endings['last_ns'] - start_ns) / _NS_PER_S if ended else None,
        'distance': round(sum(one['distance_m'] for one in by_robot.values()), 9),
        'moving': mean('moving_s'), 'idle': mean('idle_s'), 'waiting': mean('waiting_s'),
        'throughput': endings['reached'] * 3600.0 / seconds if seconds > 0.0 else None, **validity.metrics()}
    if 'stood' in endings:
        metrics.update(encounters=endings.get('rows', 0) // 2, encounter_time=round(endings['stood'], 9))
    labels = event_log.labels_of(log.end)
    return Summary(metrics, by_robot, seconds, log.events, bool(log.end.get('repeatable')) and not labels, labels,
                   log.end.get('reason', ''), bool(log.end.get('by_fault')))


def digest(path):
    """Return the SHA-256 of a file, as hex."""
    found = hashlib.sha256()
    with open(path, 'rb') as stream:
        for piece in iter(lambda: stream.read(1 << 20), b''):
            found.update(piece)
    return found.hexdigest()
