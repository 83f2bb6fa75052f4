"""How a robot travels along corners: a polyline in closed form. A :class:`Leg` is a route without corners.

As for a leg, the pose at any instant is computed exactly, in any order; nothing is integrated.
"""
from __future__ import annotations

import math
from bisect import bisect_right
from enum import Enum
from itertools import accumulate, repeat
from typing import TYPE_CHECKING, Dict, Iterable, List, NamedTuple, Optional, Protocol, Sequence, Tuple, Union

from ..common.units import NS_PER_S, seconds_to_ns
from ..engine.instants import first_ns
from .geometry import Pose2D, normalize_angle
from .leg import SpeedProfile, Tolerances, left_to_drive, turn_within
from .limited_profile import profile_over
from .planned_way import PieceLimit, PlannedWay

if TYPE_CHECKING:
    from .approach import ApproachProfile
    from .leg import MotionLimits
    from .limited_profile import LimitedProfile

    Profile = Union[SpeedProfile, LimitedProfile, ApproachProfile]

    class _Part(Protocol):
        """A turn or a drive."""

        def even_instants(self, _ramp_pieces: int) -> Iterable[float]: ...
        def smooth(self) -> List[Tuple[float, float]]: ...
        def guess(self, _distance: float) -> Optional[float]: ...
        def pose_at(self, elapsed_ns: int) -> Pose2D: ...
        def velocity_at(self, _elapsed_ns: int) -> Tuple[float, float]: ...
        def distance_at(self, _elapsed_ns: int) -> float: ...

_KEPT_ROUTES = 16  # per way


class CornerLaw(Enum):
    """What a robot does at a corner: it keeps its speed and turns in no time, or it stops, turns and starts again."""

    KEEP = 'keep'
    STOP = 'stop'


class Segment(NamedTuple):
    """A straight piece of a route: where it begins [m], its direction [rad], its length [m, > 0] and its PieceLimit."""

    x: float
    y: float
    course: float
    length: float
    limit: Optional[PieceLimit] = None

    def at(self, covered: float) -> Pose2D:
        """Return the pose ``covered`` [m] after its beginning, with the heading along it."""
        return Pose2D(self.x + covered * math.cos(self.course), self.y + covered * math.sin(self.course), self.course)


def segments_along(points: Sequence[Tuple[float, float]], limit: Optional[PieceLimit]) -> Tuple[Segment, ...]:
    """Return the pieces (:class:`Segment`, ...) along ``points`` ((x, y), ...) [m]; points in a row must differ."""
    return tuple(Segment(a, b, math.atan2(y - b, x - a), math.hypot(x - a, y - b), limit)
                 for (a, b), (x, y) in zip(points, points[1:]))


class Route:
    """One trip along ``corners`` [(x, y), m]: turn, drive from corner to corner, turn to the goal's heading. Immutable.

    ``corners`` may be a :class:`.PlannedWay`, whose pieces have speed limits of their own.

    With ``CornerLaw.KEEP`` one speed profile runs over the whole length, and headings change in no time. With
    ``CornerLaw.STOP`` the robot drives each straight piece from rest to rest, after a turn at the turn rate. The robot
    stops as soon as it is within the tolerances. Each turn and each drive lasts a whole number of nanoseconds;
    ``depart_ns`` and ``arrive_ns`` are simulated time [ns].
    """

    __slots__ = ('depart_ns', 'arrive_ns', 'start', 'end', 'distance', 'corners', 'way', '_begins_ns', '_parts',
                 '_covers')

    #: as in :class:`.leg.Leg`
    manner: Tuple[float, ...] = ()

    def __init__(self, start: Pose2D, goal: Pose2D, corners: Sequence[Tuple[float, float]], limits: MotionLimits,
                 tolerances: Tolerances = Tolerances(), depart_ns: int = 0, law: CornerLaw = CornerLaw.KEEP) -> None:
        segments, place = _segments(start, goal, corners, tolerances.xy)
        drives = [segments] if law is CornerLaw.KEEP and segments else _drives(segments)
        self.start = start
        self.corners = corners if isinstance(corners, PlannedWay) else tuple(corners)
        #: the points ((x, y), ...) [m] between which the route is straight, from its start to its end
        self.way = (*([(one.x, one.y) for one in segments] or [(start.x, start.y)]), place)
        self.distance = math.fsum([segment.length for segment in segments])
        self.depart_ns = self.arrive_ns = depart_ns
        self._begins_ns: List[int] = []
        self._parts: List[_Part] = []
        # {distance [m]: time after the departure [ns]}, shared with the same route driven again
        self._covers: Dict[float, int] = {}
        yaw, driven = start.yaw, 0.0
        for pieces in drives:
            driven = self._drive(pieces, yaw, limits, driven)
            yaw = pieces[-1].course
        whole = normalize_angle(goal.yaw - yaw)
        turn = turn_within(whole, tolerances.yaw)
        self._turn_at_goal(Pose2D(*place, yaw), turn, whole, limits, tolerances)
        self.end = Pose2D(*place, goal.yaw if tolerances.yaw == 0.0 else yaw + turn)

    def _drive(self, pieces: Sequence[Segment], yaw: float, limits: MotionLimits, driven: float) -> float:
        """Add the drive over ``pieces``, and the turn before it; return the distance [m] driven after it."""
        first = pieces[0]
        self._turn_to_drive(first, yaw, normalize_angle(first.course - yaw), limits, driven)
        return self._drive_on(pieces, limits, driven)

    def _drive_on(self, pieces: Sequence[Segment], limits: MotionLimits, driven: float) -> float:
        """Add the drive over ``pieces``, if there are any; return the distance [m] driven after it."""
        if not pieces:
            return driven
        drive = _Drive(pieces, self._profile_along(pieces, limits), driven)
        self._add(drive, drive.profile.seconds)
        return driven + drive.profile.distance

    def _add(self, part: _Part, seconds: float) -> None:
        self._begins_ns.append(self.arrive_ns)
        self._parts.append(part)
        self.arrive_ns += seconds_to_ns(seconds)

    def _turn_to_drive(self, first: Segment, yaw: float, turn: float, limits: MotionLimits, driven: float) -> None:
        """Add the turn by ``turn`` [rad] from ``yaw`` [rad] before the drive that begins with the piece ``first``."""
        self._turn(first, yaw, turn, limits.turn_rate, driven)

    def _turn_at_goal(self, begin: Pose2D, turn: float, _whole: float, limits: MotionLimits,
                      _tolerances: Tolerances) -> None:
        """Add the turn by ``turn`` [rad] at the end, from ``begin`` (Pose2D); ``_whole``: up to the goal's heading."""
        self._turn(begin, begin.yaw, turn, limits.turn_rate, self.distance)

    def _turn(self, place: Union[Pose2D, Segment], yaw: float, turn: float, rate: float, driven: float) -> None:
        if rate != math.inf:  # otherwise the turn takes no time
            self._add(Turn(place.x, place.y, yaw, turn, rate, driven), abs(turn) / rate)

    def again(self, start: Pose2D, goal: Pose2D, depart_ns: int) -> Route:
        """Return this route with another departure [ns]; ``start`` and ``goal`` (Pose2D) are equal to its ends."""
        route = Route.__new__(Route)
        by_ns = depart_ns - self.depart_ns
        route.depart_ns, route.arrive_ns, route.start, route.end = depart_ns, self.arrive_ns + by_ns, start, goal
        route.distance, route.corners, route.way, route._parts = self.distance, self.corners, self.way, self._parts
        route._covers = self._covers
        route._begins_ns = [begin_ns + by_ns for begin_ns in self._begins_ns]
        return route

    def _profile_along(self, pieces: Sequence[Segment], limits: MotionLimits) -> Profile:
        """Return the profile of a drive over ``pieces`` (Segment, ...)."""
        first = pieces[0].limit
        if first is None:
            return self._profile(list(accumulate(piece.length for piece in pieces))[-1], limits)
        same = [piece.limit for piece in pieces].count(first) == len(pieces)  # the usual case
        if same:
            whole = list(accumulate([piece.length for piece in pieces]))[-1]
            return profile_over([(whole, first.of(limits.max_speed))], limits.acceleration)
        return profile_over([(piece.length, (piece.limit or first).of(limits.max_speed)) for piece in pieces],
                            limits.acceleration)

    def _profile(self, length: float, limits: MotionLimits) -> Profile:
        """Return the profile of a drive over ``length`` [m]."""
        return SpeedProfile(length, limits.max_speed, limits.acceleration)

    @property
    def duration_ns(self) -> int:
        """The simulated time that the trip takes [ns]."""
        return self.arrive_ns - self.depart_ns

    def distance_at(self, now_ns: int) -> float:
        """Return the distance [m] driven since the departure, at ``now_ns`` [ns]."""
        if now_ns < self.depart_ns:
            return 0.0
        if now_ns >= self.arrive_ns:  # also at the departure, if the whole route takes less than a nanosecond
            return self.distance
        index = bisect_right(self._begins_ns, now_ns) - 1  # as _part, without a call
        return self._parts[index].distance_at(now_ns - self._begins_ns[index])

    def guess_ns(self, distance: float) -> int:
        """Return the instant [ns] at which ``distance`` [m] are driven; rounding may shift it by a few ns."""
        for begin_ns, part in zip(self._begins_ns, self._parts):
            elapsed = part.guess(distance)
            if elapsed is not None:
                return begin_ns + int(elapsed * NS_PER_S)
        return self.arrive_ns

    def covers_ns(self, distance: float) -> int:
        """Return the same as :meth:`.leg.Leg.covers_ns`."""
        elapsed_ns = self._covers.get(distance)
        if elapsed_ns is None:
            elapsed_ns = self._covers[distance] = first_ns(
                self.depart_ns, self.arrive_ns, lambda at_ns: self.distance_at(at_ns) >= distance,
                self.guess_ns(distance)) - self.depart_ns
        return self.depart_ns + elapsed_ns

    def pose_at(self, now_ns: int) -> Pose2D:
        """Return the pose at ``now_ns`` [ns]: the start before the departure, the end from the arrival on."""
        if now_ns < self.depart_ns:
            return self.start
        if now_ns >= self.arrive_ns:
            return self.end
        part, elapsed_ns = self._part(now_ns)
        return part.pose_at(elapsed_ns)

    def velocity_at(self, now_ns: int) -> Tuple[float, float]:
        """Return (forward [m/s], turning [rad/s]) in base_link at ``now_ns`` [ns]."""
        if now_ns < self.depart_ns or now_ns >= self.arrive_ns:
            return 0.0, 0.0
        index = bisect_right(self._begins_ns, now_ns) - 1  # as _part, without a call
        return self._parts[index].velocity_at(now_ns - self._begins_ns[index])

    def corners_ahead(self, now_ns: int) -> Tuple[Tuple[float, float], ...]:
        """Return the ``corners`` that the robot has not reached at ``now_ns`` [ns]."""
        if now_ns >= self.arrive_ns:
            return ()
        passed = self.distance_at(now_ns)
        points = [(self.start.x, self.start.y), *self.corners]
        lengths = accumulate(math.hypot(x - a, y - b) for (a, b), (x, y) in zip(points, points[1:]))
        return tuple(corner for corner, length in zip(self.corners, lengths) if length > passed)

    def even_instants_ns(self, ramp_pieces: int) -> List[int]:
        """Return instants [ns] between which the robot turns in place, or drives straight at a nearly constant speed.

        Each time in which it changes its speed is divided into ``ramp_pieces`` equal parts.
        """
        instants = {self.depart_ns, self.arrive_ns, *self._begins_ns}
        for begin_ns, part in zip(self._begins_ns, self._parts):
            instants.update(begin_ns + seconds_to_ns(elapsed) for elapsed in part.even_instants(ramp_pieces))
        return sorted(instants)

    def smooth_ns(self) -> List[Tuple[int, float]]:
        """Return [(end [ns], most [m/s^2]), ...]: successive spans of time from the departure to the arrival.

        In each span the robot stands, turns in place, or drives straight with an acceleration of at most ``most``.
        """
        return [(begin_ns + seconds_to_ns(end), most) for begin_ns, part in zip(self._begins_ns, self._parts)
                for end, most in part.smooth()]

    def _part(self, now_ns: int) -> Tuple[_Part, int]:
        """Return (the turn or drive that is under way at ``now_ns`` [ns], the time since its start [ns])."""
        index = bisect_right(self._begins_ns, now_ns) - 1
        return self._parts[index], now_ns - self._begins_ns[index]


def route_along(start: Pose2D, goal: Pose2D, way: PlannedWay, limits: MotionLimits, tolerances: Tolerances,
                depart_ns: int, law: CornerLaw) -> Route:
    """Return the :class:`Route` along the :class:`.PlannedWay` ``way``.

    It is kept with the way, so that a robot with the same ends and limits need not compute it again.
    """
    if tolerances.xy or tolerances.yaw:
        return Route(start, goal, way, limits, tolerances, depart_ns, law)
    key = (start.x, start.y, start.yaw, goal.x, goal.y, goal.yaw, limits.max_speed, limits.acceleration,
           limits.turn_rate, law.value)
    route = way.routes.get(key)
    if route is not None:
        return route.again(start, goal, depart_ns)
    if len(way.routes) >= _KEPT_ROUTES:
        way.routes.clear()
    route = way.routes[key] = Route(start, goal, way, limits, tolerances, depart_ns, law)
    return route


class Turn:
    """A turn in place at (x, y) [m] by ``turn`` [rad] from ``yaw`` [rad], ``driven`` [m] after the departure."""

    __slots__ = ('_x', '_y', '_yaw', '_turn', '_rate', '_driven')

    def __init__(self, x: float, y: float, yaw: float, turn: float, rate: float, driven: float) -> None:
        self._x, self._y, self._yaw, self._turn, self._rate, self._driven = x, y, yaw, turn, rate, driven

    @staticmethod
    def even_instants(_ramp_pieces: int) -> Tuple[float, ...]:
        """Return no instants, since the rate of the turn is constant."""
        return ()

    def smooth(self) -> List[Tuple[float, float]]:
        """Return the same as :meth:`.leg.SpeedProfile.smooth`; the acceleration is 0 during a turn."""
        return [(abs(self._turn) / self._rate, 0.0)]

    @staticmethod
    def guess(_distance: float) -> None:
        """Return None: the robot drives no distance during a turn."""

    def pose_at(self, elapsed_ns: int) -> Pose2D:
        """Return the pose ``elapsed_ns`` [ns] after its start."""
        turned = math.copysign(self._rate * elapsed_ns / NS_PER_S, self._turn)
        return Pose2D(self._x, self._y, self._yaw + turned)

    def velocity_at(self, _elapsed_ns: int) -> Tuple[float, float]:
        """Return (forward [m/s], turning [rad/s])."""
        return 0.0, math.copysign(self._rate, self._turn)

    def distance_at(self, _elapsed_ns: int) -> float:
        """Return the distance [m] driven since the departure."""
        return self._driven


class _Drive:
    """Straight pieces driven from rest to rest by ``profile``; they begin ``driven`` [m] after the departure."""

    __slots__ = ('profile', '_pieces', '_begins', '_driven')

    def __init__(self, pieces: Sequence[Segment], profile: Profile, driven: float) -> None:
        ends = list(accumulate([piece.length for piece in pieces]))
        self.profile = profile
        self._pieces = pieces
        self._begins = [0.0] + ends[:-1]
        self._driven = driven

    def even_instants(self, ramp_pieces: int) -> List[float]:
        """Return the times [s] at which corners are passed, and the ends of the parts in which the speed changes."""
        return [*(self.profile.elapsed(begin) for begin in self._begins), *self.profile.changes(ramp_pieces)]

    def smooth(self) -> List[Tuple[float, float]]:
        """Return the same as :meth:`.leg.SpeedProfile.smooth`; a span also ends at each corner."""
        corners = [self.profile.elapsed(begin) for begin in self._begins[1:]]
        found: List[Tuple[float, float]] = []
        begin = 0.0
        for end, most in self.profile.smooth():
            found += [(corner, most) for corner in corners if begin < corner < end]
            found.append((end, most))
            begin = end
        return found

    def guess(self, distance: float) -> Optional[float]:
        """Return when [s after its start] the robot has driven ``distance`` [m] on its leg, None: after its end."""
        covered = distance - self._driven
        return self.profile.elapsed(covered) if covered <= self.profile.distance else None

    def pose_at(self, elapsed_ns: int) -> Pose2D:
        covered = self.profile.covered(elapsed_ns / NS_PER_S)
        index = bisect_right(self._begins, covered) - 1
        return self._pieces[index].at(covered - self._begins[index])

    def velocity_at(self, elapsed_ns: int) -> Tuple[float, float]:
        return self.profile.speed(elapsed_ns / NS_PER_S), 0.0

    def distance_at(self, elapsed_ns: int) -> float:
        return self._driven + self.profile.covered(elapsed_ns / NS_PER_S)


def _drives(segments: Sequence[Segment]) -> List[List[Segment]]:
    """Return the groups of segments [[Segment, ...], ...] that are driven from rest to rest, with a stop at corners."""
    drives: List[List[Segment]] = []
    for segment in segments:
        if drives and segment.limit is not None and segment.limit.goes_on:
            drives[-1].append(segment)
        else:
            drives.append([segment])
    return drives


def _segments(start: Pose2D, goal: Pose2D, corners: Sequence[Tuple[float, float]],
              tolerance: float) -> Tuple[List[Segment], Tuple[float, float]]:
    """Return (the pieces [:class:`Segment`, ...] of the way, the point (x, y) [m] at which it ends).

    The way ends where it first comes within ``tolerance`` [m] of the goal.
    """
    ends = (start.x, start.y), (goal.x, goal.y)
    known = getattr(corners, 'known', None)
    if known is not None and known[:2] == ends and tolerance == 0.0:
        return known[2], ends[1]
    segments = []
    begin = start
    points = [*(Pose2D(x, y) for x, y in corners), goal]
    for end, limit in zip(points, getattr(corners, 'limits', ()) or repeat(None)):
        length = begin.distance_to(end)
        reach = _first_within(begin, end, length, goal, tolerance)
        covered = length if reach is None else reach
        if length > 0.0 and covered > 0.0:
            segments.append(Segment(begin.x, begin.y, begin.bearing_to(end), covered, limit))
        if reach is not None:
            share = reach / length if length > 0.0 else 0.0
            if share == 1.0:
                return segments, (end.x, end.y)
            return segments, (begin.x + share * (end.x - begin.x), begin.y + share * (end.y - begin.y))
        begin = end
    raise AssertionError('a route that does not end at its goal')


def _first_within(begin: Pose2D, end: Pose2D, length: float, goal: Pose2D, tolerance: float) -> Optional[float]:
    """Return the distance [m] from ``begin`` at which the way to ``end`` comes within ``tolerance`` [m] of ``goal``.

    The result is None if it does not. It is where a line enters a circle: the root of a quadratic equation.
    """
    if end is goal:
        return left_to_drive(length, tolerance)
    if tolerance == 0.0 or length <= 0.0:
        return None
    dx, dy = goal.x - begin.x, goal.y - begin.y
    along = (dx * (end.x - begin.x) + dy * (end.y - begin.y)) / length
    rest = tolerance * tolerance - (dx * dx + dy * dy - along * along)
    if rest < 0.0:
        return None
    half = math.sqrt(rest)
    if along + half < 0.0 or along - half > length:
        return None
    return max(0.0, along - half)
