"""When bodies that drive on straight lines and arcs touch, to the nanosecond, without stepping through time.

Two bodies touch when their gap is at most REACH. Bodies that are as near already, because they stand at one another
since they touched, touch when they come nearer by NEARER; then they stand where they have not come nearer. So one may
drive along the other, whatever rounding says, and no number of touches brings them nearer. A way that leads along and
by a hair nearer may do so, look by look, until the gap is half of REACH: from there on they touch when they come nearer
at all. Bodies that overlap, or whose gap is at most OVERLAP, do not touch in this motion: they may always come apart.

The instant is found by conservative advancement (Mirtich: Impulse-based Dynamic Simulation, Berkeley 1996). Between two
convex bodies lies a plane. No corner crosses it before it has covered its way to it, at its present speed across the
plane and with the largest acceleration that it has. Up to there the bodies surely do not touch, and there the gap is
computed anew. The last nanosecond is decided by the gap itself.
"""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, List, NamedTuple, Optional, Sequence, Tuple

from ..common.geometry import is_within
from ..engine.instants import first_ns
from ..motion.pieces import Piece, pose_of

if TYPE_CHECKING:
    from ..maps.costmaps import Footprint

Points = Sequence[Tuple[float, float]]

REACH = 1e-6  # m
NEARER = 1e-8  # m
OVERLAP = 1e-7  # m
_ROUNDING = 1e-12  # m; standing gaps that differ by less are the same
_NS_PER_S = 1e9
_INF = math.inf
_Side = Tuple[Tuple[float, float], Tuple[float, float]]
_Plane = Tuple[float, float, float]  # the gap [m], and the unit vector from one body to the other across it
_Corner = Tuple[float, float, float]  # its way to the plane [m], its speed [m/s] and acceleration [m/s^2] towards it


class Limit(NamedTuple):
    """The gap at which bodies ``touch`` [m], and the gap [m] above which they ``stand`` then."""

    touch: float
    stand: float


#: the limit of a motion that begins farther away
FREE = Limit(REACH, REACH)


class Shape(NamedTuple):
    """A body in its base frame: all points within ``radius`` [m] of its convex ``parts`` (points, ...) [m].

    ``outline`` [m] is the polygon whose inside belongs to it, too. No point is farther than ``reach`` [m] from the
    origin.
    """

    parts: Tuple[Points, ...]
    radius: float
    reach: float
    outline: Points = ()


def disc(radius: float) -> Shape:
    """Return the :class:`Shape` of a disc around the origin; ``radius`` [m]."""
    return Shape((((0.0, 0.0),),), radius, radius)


def polygon(points: Points) -> Shape:
    """Return the :class:`Shape` of a polygon; one that is not convex consists of its sides and its inside."""
    sides = _sides(points)
    turns = [(x - a) * (d - b) - (y - b) * (c - a) for (a, b), (c, d) in sides for x, y in points]
    is_convex = all(turn <= 1e-12 for turn in turns) or all(turn >= -1e-12 for turn in turns)
    reach = max(math.hypot(x, y) for x, y in points) * (1.0 + 1e-12)
    return Shape((tuple(points),) if is_convex else tuple(sides), 0.0, reach, tuple(points))


def shape_of(footprint: Footprint) -> Shape:
    """Return the :class:`Shape` of a robot with this Footprint, without the padding of costmaps."""
    return polygon(footprint.bare or footprint.points) if footprint.radius is None else disc(footprint.radius)


class Course(NamedTuple):
    """A body of ``shape`` (Shape) that moves as ``piece`` says: a Piece at constant velocities."""

    piece: Piece
    shape: Shape

    def corners(self, now_ns: int, part: Points) -> Points:
        """Return the points ``part`` of the base frame [m] where they are at ``now_ns`` [ns]."""
        pose = pose_of(self.piece, now_ns)
        x, y, cos, sin = pose.x, pose.y, math.cos(pose.yaw), math.sin(pose.yaw)
        return [(x + cos * a - sin * b, y + sin * a + cos * b) for a, b in part]

    def approach(self, now_ns: int, corners: Points, nx: float, ny: float) -> List[_Corner]:
        """Return how each of ``corners`` moves along the unit vector (nx, ny) from ``now_ns`` [ns] on."""
        begin_ns, _, _, _, ux, uy, v, _, w, k = self.piece
        if k < 0.0:
            angle = w * ((now_ns - begin_ns) / _NS_PER_S)
            cos, sin = math.cos(angle), math.sin(angle)
            ux, uy = ux * cos - uy * sin, uy * cos + ux * sin
        speed, bend = v * (ux * nx + uy * ny), abs(v * w) if k < 0.0 else 0.0
        ahead = [x * nx + y * ny for x, y in corners]
        most = max(ahead)
        if not w:
            return [(most - along, speed, bend) for along in ahead]
        pose = pose_of(self.piece, now_ns)
        return [(most - along, speed + w * ((x - pose.x) * ny - (y - pose.y) * nx),
                 bend + w * w * math.hypot(x - pose.x, y - pose.y)) for along, (x, y) in zip(ahead, corners)]


def standing(points: Points) -> Course:
    """Return the :class:`Course` of a convex body that stands for ever; ``points``: its corners [m]."""
    return Course(Piece(0, 0.0, 0.0, 0.0, 1.0, 0.0), Shape((points,), 0.0, 0.0, points))


def gap_of(one: Course, other: Course, now_ns: int) -> float:
    """Return the gap [m] between two bodies at ``now_ns`` [ns], 0 if they overlap."""
    for body, inside in ((one, other), (other, one)):
        corner, = inside.corners(now_ns, inside.shape.parts[0][:1])
        if is_within(_sides(body.corners(now_ns, body.shape.outline)), *corner):
            return 0.0
    least = min(_part_gap(one.corners(now_ns, part), other.corners(now_ns, their))
                for part in one.shape.parts for their in other.shape.parts)
    return max(0.0, least - one.shape.radius - other.shape.radius)


def limit_of(gap: float) -> Optional[Limit]:
    """Return the :class:`Limit` of a motion that begins at ``gap`` [m], None: the bodies do not touch in it."""
    if gap <= OVERLAP:
        return None
    if gap > REACH + NEARER:
        return FREE
    return Limit(gap - (NEARER if gap > 0.5 * REACH else _ROUNDING), min(REACH, gap - _ROUNDING))


def first_touch(one: Course, other: Course, limit: Limit, begin_ns: int, end_ns: int) -> Optional[int]:
    """Return the first instant [ns] in ``begin_ns`` .. ``end_ns`` - 1 at which the bodies touch, or None.

    If they touch by the gap ``limit.touch``, it is the first one at which the gap is at most ``limit.stand`` on the
    way there: in the nanosecond before it they may stand. The bodies must not overlap at ``begin_ns``.
    """
    found = None
    for part in one.shape.parts:
        for their in other.shape.parts:
            touch_ns = _first_touch(one, part, other, their, limit, begin_ns, end_ns)
            if touch_ns is not None:
                found = end_ns = touch_ns
    return found


def _first_touch(one: Course, part: Points, other: Course, their: Points, limit: Limit, begin_ns: int,
                 end_ns: int) -> Optional[int]:
    radii = one.shape.radius + other.shape.radius
    touch, rest = limit.touch + radii, limit.stand + radii
    now_ns = begin_ns
    while now_ns < end_ns:
        corners, others = one.corners(now_ns, part), other.corners(now_ns, their)
        gap, nx, ny = _between(corners, others)
        if gap <= touch:
            return first_ns(begin_ns, now_ns, lambda at_ns: _between(
                one.corners(at_ns, part), other.corners(at_ns, their))[0] <= rest, now_ns)
        seconds = _clear_for(gap - touch, one.approach(now_ns, corners, nx, ny),
                             other.approach(now_ns, others, -nx, -ny))
        if seconds * _NS_PER_S >= end_ns - now_ns:
            return None
        now_ns += max(1, int(seconds * _NS_PER_S))
    return None


def _clear_for(room: float, ones: Sequence[_Corner], others: Sequence[_Corner]) -> float:
    """Return the time [s] for which no corner of one side surely meets one of the other; ``room`` [m] is between."""
    least = _INF
    for way, speed, acceleration in ones:
        for their_way, their_speed, their_acceleration in others:
            s, a, d = speed + their_speed, acceleration + their_acceleration, room + way + their_way
            if s > 0.0 or a > 0.0:  # the root of a t^2 / 2 + s t = d, without a difference of two like numbers
                root = math.sqrt(s * s + 2.0 * a * d)
                least = min(least, 2.0 * d / (s + root) if s > 0.0 else (root - s) / a)
    return least


def _between(ones: Points, others: Points) -> _Plane:
    """Return the gap of two convex bodies that do not overlap, and the direction from the first to the second."""
    nearest = min(_nearest(ones, others, 1.0), _nearest(others, ones, -1.0))
    gap = math.sqrt(nearest[0])
    return (gap, nearest[1] / gap, nearest[2] / gap) if gap else (0.0, 1.0, 0.0)


def _nearest(ones: Points, others: Points, sign: float) -> _Plane:
    """Return the least squared distance from a corner of ``ones`` to a side of ``others``, and ``sign`` x its way."""
    best = (_INF, 0.0, 0.0)
    a, b = others[-1]
    for c, d in others:
        sx, sy = c - a, d - b
        squared = sx * sx + sy * sy
        for x, y in ones:
            dx, dy = a - x, b - y
            share = -(dx * sx + dy * sy)
            if share > 0.0:
                if share >= squared:
                    dx, dy = c - x, d - y
                else:
                    share /= squared
                    dx, dy = dx + share * sx, dy + share * sy
            square = dx * dx + dy * dy
            if square < best[0]:
                best = square, sign * dx, sign * dy
        a, b = c, d
    return best


def _part_gap(ones: Points, others: Points) -> float:
    """Return the gap [m] between two convex bodies of which neither is inside of the other, 0 if their sides cross."""
    for (a, b), (c, d) in _sides(ones):
        for (e, f), (g, h) in _sides(others):
            if ((c - a) * (f - b) - (d - b) * (e - a)) * ((c - a) * (h - b) - (d - b) * (g - a)) < 0.0 and (
                    ((g - e) * (b - f) - (h - f) * (a - e)) * ((g - e) * (d - f) - (h - f) * (c - e)) < 0.0):
                return 0.0
    return _between(ones, others)[0]


def _sides(points: Points) -> List[_Side]:
    return list(zip(points, (*points[1:], *points[:1])))

