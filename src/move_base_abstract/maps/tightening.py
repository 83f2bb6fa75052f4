"""Ways pulled tight: each bend moves to the corners of the blocked cells inside it.

Of a bend a - b - c both pieces are clear, so what keeps a from seeing c reaches in between a and c: a string along the
bend is caught by the convex hull of the corners in the triangle. Whole numbers decide.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Iterable, List, Tuple, Union

from .shortening import length_between

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .planning_grid import PlanningGrid

_TRIES = 32  # for each bend that a way has at first; a few are enough


def tightened(grid: PlanningGrid, places: List[Tuple[int, int]]) -> List[Tuple[int, int]]:
    """Return ``places`` (1/256 cells, see PlanningGrid), from start to goal, pulled tight. It is never longer."""
    places = list(places)
    tries = _TRIES * len(places)
    index = 1
    while index < len(places) - 1 and tries:
        tries -= 1
        chain = _pulled(grid, *places[index - 1:index + 2])
        if chain == places[index:index + 1]:
            index += 1
        else:
            places[index:index + 1] = chain
            index = max(1, index - 1)  # the piece before has changed
    return places


def is_taut(grid: PlanningGrid, begin: Tuple[int, int], bend: Tuple[int, int], end: Tuple[int, int]) -> bool:
    """Return whether the way from ``begin`` to ``end`` bends around a corner, as near to it as may be."""
    corner = grid.corner_at(bend)
    if corner is None:
        return False
    towards = bend[0] + corner[0], bend[1] + corner[1]
    sides = [_side(bend, one, *other) for one, other in ((begin, towards), (towards, end), (begin, end))]
    return min(sides) > 0 or max(sides) < 0


def _pulled(grid: PlanningGrid, begin: Tuple[int, int], bend: Tuple[int, int],
            end: Tuple[int, int]) -> List[Tuple[int, int]]:
    """Return the places by which the way from ``begin`` to ``end`` is tight, on the side of ``bend``."""
    if is_taut(grid, begin, bend, end):
        return [bend]
    if grid.sees(begin, end):
        return []
    side = _side(begin, end, *bend)
    if side == 0:
        return [bend]
    way = _around(begin, end, _bends_within(grid, begin, bend, end, 1 if side > 0 else -1))
    is_shorter = _length(way) < _length([begin, bend, end])
    return way[1:-1] if is_shorter and all(grid.sees(*piece) for piece in zip(way, way[1:])) else [bend]


def _length(places: List[Tuple[int, int]]) -> int:
    return sum(length_between(one, other) for one, other in zip(places, places[1:]))


def _side(begin: Tuple[int, int], end: Tuple[int, int], x: Union[int, NDArray[Any]],
          y: Union[int, NDArray[Any]]) -> Union[int, NDArray[Any]]:
    """Return > 0 where (x, y) lies to the left of the line from ``begin`` to ``end``, < 0 to the right of it."""
    return (end[0] - begin[0]) * (y - begin[1]) - (end[1] - begin[1]) * (x - begin[0])


def _bends_within(grid: PlanningGrid, begin: Tuple[int, int], bend: Tuple[int, int], end: Tuple[int, int],
                  sign: int) -> Iterable[Any]:
    """Return the places [(x, y)] by the corners of what is not free in the triangle, sides included.

    A corner may lie in the triangle and the place by it a part outside: what counts is the corner.
    """
    corners, bends = grid.corners_within((begin, bend, end))
    x, y = corners.T
    inside = (sign * _side(begin, bend, x, y) <= 0) & (sign * _side(bend, end, x, y) <= 0)
    inside &= sign * _side(begin, end, *bends.T) > 0
    return map(tuple, bends[inside].tolist())


def _around(begin: Tuple[int, int], end: Tuple[int, int], points: Iterable[Any]) -> List[Tuple[int, int]]:
    """Return the convex way from ``begin`` to ``end`` around ``points``, which lie on one side of their line."""
    ordered = sorted([begin, end, *points])
    hull = _chain(ordered)[:-1] + _chain(ordered[::-1])[:-1]
    first = hull.index(begin)
    hull = hull[first:] + hull[:first]
    return hull if hull[-1] == end else hull[:1] + hull[:0:-1]


def _chain(ordered: List[Tuple[int, int]]) -> List[Tuple[int, int]]:
    """Return those of the points, which are sorted, that bound them on the right of their first and last one."""
    chain: List[Tuple[int, int]] = []
    for point in ordered:
        while len(chain) > 1 and _side(chain[-2], chain[-1], *point) <= 0:
            chain.pop()
        chain.append(point)
    return chain
