"""The outline of an area in the plane: whether a point is inside, and which pieces of a way are inside.

A point is inside if it is more than a micrometre from the border, so no answer depends on how a number was rounded. A
robot that stands on the border, touches a corner or drives along an edge is outside.
"""
from __future__ import annotations

import math
from fractions import Fraction
from itertools import combinations
from typing import List, Optional, Sequence, Tuple

from ..common.geometry import is_within, share_along

BORDER = 1e-6  # m; a point as near to the border as this is on it
MAX_POINTS = 200


class Outline:
    """A simple polygon with the corners ``points`` ((x, y), ...) [m], in either direction.

    The last point may repeat the first.

    :raises ValueError: if it has less than 3 points or more than 200, or touches or crosses itself.
    """

    def __init__(self, points: Sequence[Tuple[float, float]]) -> None:
        points = tuple((float(x), float(y)) for x, y in points)
        if len(points) > 1 and points[0] == points[-1]:
            points = points[:-1]
        if not 3 <= len(points) <= MAX_POINTS:
            raise ValueError('has {} different points'.format(len(points)))
        self.points = points
        self._edges = tuple(zip(points, points[1:] + points[:1]))
        fault = _fault(self._edges)
        if fault:
            raise ValueError(fault)
        xs, ys = zip(*points)
        #: (x_min, y_min, x_max, y_max) [m]
        self.box = min(xs), min(ys), max(xs), max(ys)

    def contains(self, x: float, y: float) -> bool:
        """Return whether (x, y) [m] is inside."""
        x_min, y_min, x_max, y_max = self.box
        if not (x_min < x < x_max and y_min < y < y_max):
            return False
        return is_within(self._edges, x, y) and all(_distance(edge, x, y) > BORDER for edge in self._edges)

    def pieces_inside(self, way: Sequence[Tuple[float, float]]) -> List[Tuple[float, float]]:
        """Return the pieces of ``way`` ((x, y), ...) [m] that are inside: [(from, to), ...] in m along it, in order.

        A piece between two crossings of the border is inside if its middle is. Pieces of up to a micrometre are left
        out, and gaps of up to a micrometre are closed.
        """
        pieces: List[Tuple[float, float]] = []
        begun = 0.0
        x_min, y_min, x_max, y_max = self.box
        for begin, end in zip(way, way[1:]):
            (ax, ay), (bx, by) = begin, end
            length = math.hypot(bx - ax, by - ay)
            is_aside = (ax <= x_min and bx <= x_min or ax >= x_max and bx >= x_max
                        or ay <= y_min and by <= y_min or ay >= y_max and by >= y_max)  # so are nearly all
            for one, other in () if is_aside or length == 0.0 else self._pieces_of(begin, end, length):
                if pieces and begun + one - pieces[-1][1] <= BORDER:
                    pieces[-1] = pieces[-1][0], begun + other
                else:
                    pieces.append((begun + one, begun + other))
            begun += length
        return [piece for piece in pieces if piece[1] - piece[0] > BORDER]

    def _pieces_of(self, begin: Tuple[float, float], end: Tuple[float, float],
                   length: float) -> List[Tuple[float, float]]:
        ux, uy = (end[0] - begin[0]) / length, (end[1] - begin[1]) / length
        if not self._meets_box(begin, ux, uy):
            return []
        meetings = (at for edge in self._edges for at in _meetings(edge, begin, ux, uy))
        cuts = [0.0, *sorted(at for at in meetings if 0.0 < at < length), length]
        middles = ((one, other, 0.5 * (one + other)) for one, other in zip(cuts, cuts[1:]) if other > one)
        return [(one, other) for one, other, middle in middles
                if self.contains(begin[0] + middle * ux, begin[1] + middle * uy)]

    def _meets_box(self, begin: Tuple[float, float], ux: float, uy: float) -> bool:
        """Return whether the line from ``begin`` in the direction (ux, uy) meets the box."""
        x_min, y_min, x_max, y_max = self.box
        width, height = x_max - x_min, y_max - y_min
        aside = ux * (y_min + 0.5 * height - begin[1]) - uy * (x_min + 0.5 * width - begin[0])  # of the box's middle
        meets: bool = abs(aside) <= 0.5 * (abs(ux) * height + abs(uy) * width) + BORDER
        return meets


def rectangle(x_min: float, y_min: float, x_max: float, y_max: float) -> Outline:
    """Return the Outline of a rectangle [m].

    :raises ValueError: if a lower bound is not below its upper one.
    """
    if not (x_min < x_max and y_min < y_max):
        raise ValueError('has no area')
    return Outline(((x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max)))


def _meetings(edge: Tuple[Tuple[float, float], Tuple[float, float]], begin: Tuple[float, float], ux: float,
              uy: float) -> List[float]:
    """Return where the line from ``begin`` in the direction (ux, uy) meets ``edge``: distances along the line [m]."""
    (ax, ay), (bx, by) = edge
    ax, ay, bx, by = ax - begin[0], ay - begin[1], bx - begin[0], by - begin[1]
    left_a, left_b = ux * ay - uy * ax, ux * by - uy * bx
    found = [ux * x + uy * y for x, y, left in ((ax, ay, left_a), (bx, by, left_b)) if abs(left) <= BORDER]
    if (left_a > 0.0) != (left_b > 0.0) and left_a != left_b:
        share = left_a / (left_a - left_b)
        found.append(ux * (ax + share * (bx - ax)) + uy * (ay + share * (by - ay)))
    return found


def _distance(edge: Tuple[Tuple[float, float], Tuple[float, float]], x: float, y: float) -> float:
    """Return the distance [m] of (x, y) from ``edge``."""
    (ax, ay), (bx, by) = edge
    share = share_along(*edge, x, y)
    return math.hypot(x - ax - share * (bx - ax), y - ay - share * (by - ay))


def _fault(edges: Tuple[Tuple[Tuple[float, float], Tuple[float, float]], ...]) -> Optional[str]:
    """Return why ``edges`` are not the border of a simple polygon, or None. The numbers are exact fractions."""
    for (first, one), (second, other) in combinations(enumerate(edges), 2):
        if one[0] == one[1] or other[0] == other[1]:
            return 'has the same point twice in a row'
        apart = second - first
        if apart in (1, len(edges) - 1):
            corner, (before, after) = (one[1], (one[0], other[1])) if apart == 1 else (one[0], (other[0], one[1]))
            if _side(before, corner, after) == 0 and _dot(corner, before, after) > 0:
                return 'turns back on itself at ({:g}, {:g})'.format(*corner)
        elif _touch(one, other):
            return 'crosses or touches itself: the edges from ({:g}, {:g}) and from ({:g}, {:g}) meet'.format(
                *one[0], *other[0])
    return None


def _touch(one: Tuple[Tuple[float, float], Tuple[float, float]],
           other: Tuple[Tuple[float, float], Tuple[float, float]]) -> bool:
    if any(max(a[axis] for a in one) < min(b[axis] for b in other)
           or max(b[axis] for b in other) < min(a[axis] for a in one) for axis in (0, 1)):
        return False
    return (_side(*one, other[0]) * _side(*one, other[1]) <= 0
            and _side(*other, one[0]) * _side(*other, one[1]) <= 0)


def _side(a: Tuple[float, float], b: Tuple[float, float], c: Tuple[float, float]) -> int:
    """Return 1, 0 or -1: whether the point ``c`` is left of the line from ``a`` to ``b``, on it, or right of it."""
    (ax, ay), (bx, by), (cx, cy) = _exact(a), _exact(b), _exact(c)
    product = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    return (product > 0) - (product < 0)


def _dot(corner: Tuple[float, float], one: Tuple[float, float], other: Tuple[float, float]) -> Fraction:
    (x, y), (ax, ay), (bx, by) = _exact(corner), _exact(one), _exact(other)
    return (ax - x) * (bx - x) + (ay - y) * (by - y)


def _exact(point: Tuple[float, float]) -> Tuple[Fraction, Fraction]:
    return Fraction(point[0]), Fraction(point[1])
