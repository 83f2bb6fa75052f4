"""How a robot travels along corners: a polyline in closed form. A :class:`Leg` is a route without corners.

As for a leg, the pose at any instant is computed exactly, in any order; nothing is integrated.
"""
from __future__ import annotations

import math
from enum import Enum
from functools import partial
from itertools import accumulate, repeat
from typing import TYPE_CHECKING, Callable, Dict, Iterator, List, Optional, Sequence, Tuple, Union

from ..common.units import seconds_to_ns
from .geometry import Pose2D, normalize_angle
from .leg import Tolerances, left_to_drive, speed_profile, turn_within
from .limited_profile import profile_over
from .phases import Profile, Segment, drive_pieces, turn_piece
from .pieces import Motion, Placed
from .planned_way import PieceLimit, PlannedWay

if TYPE_CHECKING:
    from .leg import MotionLimits

_KEPT_ROUTES = 16  # per way


class CornerLaw(Enum):
    """What a robot does at a corner: it keeps its speed and turns in no time, or it stops, turns and starts again."""

    KEEP = 'keep'
    STOP = 'stop'


def segments_along(points: Sequence[Tuple[float, float]], limit: Optional[PieceLimit]) -> Tuple[Segment, ...]:
    """Return the pieces (:class:`Segment`, ...) along ``points`` ((x, y), ...) [m]; points in a row must differ."""
    return tuple(Segment(a, b, math.atan2(y - b, x - a), math.hypot(x - a, y - b), limit)
                 for (a, b), (x, y) in zip(points, points[1:]))


class Route(Motion):
    """One trip along ``corners`` [(x, y), m]: turn, drive from corner to corner, turn to the goal's heading. Immutable.

    ``corners`` may be a :class:`.PlannedWay`, whose pieces have speed limits of their own.

    With ``CornerLaw.KEEP`` one speed profile runs over the whole length, and headings change in no time. With
    ``CornerLaw.STOP`` the robot drives each straight piece from rest to rest, after a turn at the turn rate. The robot
    stops as soon as it is within the tolerances. Each turn and each drive lasts a whole number of nanoseconds;
    ``depart_ns`` and ``arrive_ns`` are simulated time [ns].
    """

    __slots__ = ('corners', '_way', '_parts', '_covers')

    def __init__(self, start: Pose2D, goal: Pose2D, corners: Sequence[Tuple[float, float]], limits: MotionLimits,
                 tolerances: Tolerances = Tolerances(), depart_ns: int = 0, law: CornerLaw = CornerLaw.KEEP) -> None:
        segments, place = _segments(start, goal, corners, tolerances.xy)
        drives = [segments] if law is CornerLaw.KEEP and segments else _drives(segments)
        self.start = start
        self.corners = corners if isinstance(corners, PlannedWay) else tuple(corners)
        self._way = (*([(one.x, one.y) for one in segments] or [(start.x, start.y)]), place)
        self.distance = math.fsum([segment.length for segment in segments])
        self.depart_ns = self.arrive_ns = depart_ns
        self._kept = None
        # the turns and drives: (begin after the departure [ns], the pieces from an instant on)
        self._parts: List[Tuple[int, Callable[[int], List[Placed]]]] = []
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

    @property
    def way(self) -> Tuple[Tuple[float, float], ...]:
        """The points ((x, y), ...) [m] between which the route is straight, from its start to its end."""
        return self._way

    def _drive(self, pieces: Sequence[Segment], yaw: float, limits: MotionLimits, driven: float) -> float:
        """Add the drive over ``pieces``, and the turn before it; return the distance [m] driven after it."""
        first = pieces[0]
        self._turn_to_drive(first, yaw, normalize_angle(first.course - yaw), limits, driven)
        return self._drive_on(pieces, limits, driven)

    def _drive_on(self, pieces: Sequence[Segment], limits: MotionLimits, driven: float) -> float:
        """Add the drive over ``pieces``, if there are any; return the distance [m] driven after it."""
        if not pieces:
            return driven
        profile = self._profile_along(pieces, limits)
        self._add(partial(drive_pieces, segments=pieces, profile=profile, driven=driven), profile.seconds)
        return driven + profile.distance

    def _add(self, part: Callable[[int], List[Placed]], seconds: float) -> None:
        """Add the turn or drive whose pieces ``part(begin_ns)`` returns, and which takes so many ``seconds``."""
        duration_ns = seconds_to_ns(seconds)
        if duration_ns:
            self._parts.append((self.arrive_ns - self.depart_ns, part))
            self.arrive_ns += duration_ns

    def _stretches(self) -> Iterator[Placed]:
        for after_ns, part in self._parts:
            yield from part(self.depart_ns + after_ns)

    def _turn_to_drive(self, first: Segment, yaw: float, turn: float, limits: MotionLimits, driven: float) -> None:
        """Add the turn by ``turn`` [rad] from ``yaw`` [rad] before the drive that begins with the piece ``first``."""
        self._turn(first, yaw, turn, limits.turn_rate, driven)

    def _turn_at_goal(self, begin: Pose2D, turn: float, _whole: float, limits: MotionLimits,
                      _tolerances: Tolerances) -> None:
        """Add the turn by ``turn`` [rad] at the end, from ``begin`` (Pose2D); ``_whole``: up to the goal's heading."""
        self._turn(begin, begin.yaw, turn, limits.turn_rate, self.distance)

    def _turn(self, place: Union[Pose2D, Segment], yaw: float, turn: float, rate: float, driven: float) -> None:
        """Add a turn by ``turn`` [rad] at ``rate`` [rad/s]; inf: it takes no time."""
        self._add(partial(turn_piece, place=place, yaw=yaw, rate=math.copysign(rate, turn), driven=driven),
                  abs(turn) / rate)

    def again(self, start: Pose2D, goal: Pose2D, depart_ns: int) -> Route:
        """Return this route with another departure [ns]; ``start`` and ``goal`` (Pose2D) are equal to its ends."""
        route = Route.__new__(Route)
        by_ns = depart_ns - self.depart_ns
        route.depart_ns, route.arrive_ns, route.start, route.end = depart_ns, self.arrive_ns + by_ns, start, goal
        route.distance, route.corners, route._way, route._parts = self.distance, self.corners, self._way, self._parts
        route._covers, route._kept = self._covers, None
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
        return speed_profile(length, limits.max_speed, limits.acceleration)

    def covers_ns(self, distance: float) -> int:
        """Return the same as :meth:`.pieces.Motion.covers_ns`; the same route driven again need not search for it."""
        elapsed_ns = self._covers.get(distance)
        if elapsed_ns is None:
            elapsed_ns = self._covers[distance] = super().covers_ns(distance) - self.depart_ns
        return self.depart_ns + elapsed_ns


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
