"""Ways pulled tight: each bend moves to the corners of the blocked cells inside it.

In a bend a - b - c both pieces are clear. So the blocked cells that hide c from a reach into the triangle between a and
c. A string along the bend would be caught by the convex hull of the corners in the triangle. All numbers are whole.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Iterable, List, Tuple, Union

from .shortening import length_between

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .planning_grid import PlanningGrid

_TRIES = 32  # per bend of the original way; usually a few are enough


def tightened(grid: PlanningGrid, places: List[Tuple[int, int]]) -> List[Tuple[int, int]]:
    """Return the way along ``places`` (1/256 cells, see PlanningGrid), pulled tight; it never gets longer."""
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
    """Return whether the way from ``begin`` to ``end`` bends around a corner, as near to it as is allowed."""
    corner = grid.corner_at(bend)
    if corner is None:
        return False
    towards = bend[0] + corner[0], bend[1] + corner[1]
    sides = [_side(bend, one, *other) for one, other in ((begin, towards), (towards, end), (begin, end))]
    return min(sides) > 0 or max(sides) < 0


def _pulled(grid: PlanningGrid, begin: Tuple[int, int], bend: Tuple[int, int],
            end: Tuple[int, int]) -> List[Tuple[int, int]]:
    """Return the places between ``begin`` and ``end`` with which the way is tight, on the side of ``bend``."""
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
    """Return a number > 0 if (x, y) is left of the line from ``begin`` to ``end``, < 0 if it is right of it."""
    return (end[0] - begin[0]) * (y - begin[1]) - (end[1] - begin[1]) * (x - begin[0])


def _bends_within(grid: PlanningGrid, begin: Tuple[int, int], bend: Tuple[int, int], end: Tuple[int, int],
                  sign: int) -> Iterable[Any]:
    """Return the bends [(x, y)] at the corners of blocked cells in the triangle, including its sides.

    A corner in the triangle counts even if its bend is slightly (1/256 cell) outside.
    """
    corners, bends = grid.corners_within((begin, bend, end))
    x, y = corners.T
    inside = (sign * _side(begin, bend, x, y) <= 0) & (sign * _side(bend, end, x, y) <= 0)
    inside &= sign * _side(begin, end, *bends.T) > 0
    return map(tuple, bends[inside].tolist())


def _around(begin: Tuple[int, int], end: Tuple[int, int], points: Iterable[Any]) -> List[Tuple[int, int]]:
    """Return the convex way from ``begin`` to ``end`` around ``points``, which are on one side of their line."""
    ordered = sorted([begin, end, *points])
    hull = _chain(ordered)[:-1] + _chain(ordered[::-1])[:-1]
    first = hull.index(begin)
    hull = hull[first:] + hull[:first]
    return hull if hull[-1] == end else hull[:1] + hull[:0:-1]


def _chain(ordered: List[Tuple[int, int]]) -> List[Tuple[int, int]]:
    """Return the points of the convex hull from the first to the last of ``ordered``, on the right of that line."""
    chain: List[Tuple[int, int]] = []
    for point in ordered:
        while len(chain) > 1 and _side(chain[-2], chain[-1], *point) <= 0:
            chain.pop()
        chain.append(point)
    return chain
