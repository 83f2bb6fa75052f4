"""Ways pulled tight: each corner gives way to the corners of what is not free that lie within its bend.

Of a bend a - b - c both pieces are clear, so what keeps a from seeing c reaches in between a and c: a string along the
bend is caught by the convex hull of the corners in the triangle. Whole numbers decide.
"""
import numpy as np

from .planning_grid import PARTS
from .shortening import length_between

_ROUNDS = 3


def tightened(grid, places):
    """Return ``places`` (1/256 cells, see PlanningGrid), from start to goal, with tighter bends. It is never longer."""
    places = list(places)
    for _ in range(_ROUNDS):
        before = list(places)
        index = 1
        while index < len(places) - 1:
            chain = _pulled(grid, *places[index - 1:index + 2])
            places[index:index + 1] = chain
            index += max(1, len(chain))
        if places == before:
            break
    return places


def _pulled(grid, begin, bend, end):
    """Return the places by which the way from ``begin`` to ``end`` is tight, on the side of ``bend``."""
    if grid.sees(begin, end):
        return []
    side = _side(begin, end, *bend)
    if side == 0:
        return [bend]
    chain = _hull(begin, end, _corners_within(grid, begin, bend, end), 1 if side > 0 else -1)
    way = [begin, *chain, end]
    is_clear = all(grid.sees(one, other) for one, other in zip(way, way[1:]))
    return chain if is_clear and _length(way) < _length([begin, bend, end]) else [bend]


def _length(places):
    return sum(length_between(one, other) for one, other in zip(places, places[1:]))


def _side(begin, end, x, y):
    """Return > 0 where (x, y) lies to the left of the line from ``begin`` to ``end``, < 0 to the right of it."""
    return (end[0] - begin[0]) * (y - begin[1]) - (end[1] - begin[1]) * (x - begin[0])


def _corners_within(grid, begin, bend, end):
    """Return the places [(x, y)] of the corner cells in the triangle, its sides included."""
    low = [min(values) // PARTS for values in zip(begin, bend, end)]
    high = [max(values) // PARTS + 1 for values in zip(begin, bend, end)]
    rows, columns = np.nonzero(grid.corners[low[1]:high[1], low[0]:high[0]])
    x = (columns + low[0]) * PARTS + PARTS // 2
    y = (rows + low[1]) * PARTS + PARTS // 2
    sides = [_side(one, other, x, y) for one, other in ((begin, bend), (bend, end), (end, begin))]
    inside = np.logical_or(np.min(sides, axis=0) >= 0, np.max(sides, axis=0) <= 0)
    return list(zip(x[inside].tolist(), y[inside].tolist()))


def _hull(begin, end, points, sign):
    """Return the inside of the convex chain from ``begin`` to ``end`` around ``points``, left (``sign`` 1) or right.

    Points are taken in the order in which they lie along the line from begin to end; of equal ones the outer one first.
    """
    dx, dy = end[0] - begin[0], end[1] - begin[1]
    ordered = sorted((point for point in points if sign * _side(begin, end, *point) > 0), key=lambda point: (
        point[0] * dx + point[1] * dy, -sign * _side(begin, end, *point)))
    chain = [begin]
    for point in [*ordered, end]:
        while len(chain) > 1 and sign * _side(chain[-2], point, *chain[-1]) <= 0:
            chain.pop()
        chain.append(point)
    return chain[1:-1]
