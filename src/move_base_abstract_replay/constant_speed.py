"""Draw legs with corners whose law of motion is not known: along the corners, at an even speed."""
from __future__ import annotations

import math
from typing import Any, List, Sequence, Tuple

from move_base_abstract.motion.geometry import share_along

_ON_WAY = 0.01  # m; a leg that ended as near as this to its way ended on it

Piece = Tuple[int, int, Tuple[float, float, float], Tuple[float, float, float]]


def even_pieces(begin_ns: int, end_ns: int, way: Sequence[Any], end: Tuple[float, float, float]) -> List[Piece]:
    """Return the pieces [(from [ns], to [ns], pose, pose), ...] of a leg that ended at ``end``; poses are (x, y, yaw).

    ``way``: the pose at the start, the corners (x, y), and the goal's pose. If the leg ended on its way, it is drawn
    along the way up to there, otherwise as a straight line.
    """
    points = [*_up_to(end, [place[:2] for place in way]), end[:2]]
    lengths = [math.hypot(x - a, y - b) for (a, b), (x, y) in zip(points, points[1:])]
    whole = math.fsum(lengths)
    if len(points) == 2 or not whole > 0.0:
        return [(begin_ns, end_ns, way[0], end)]
    pieces, covered, one_ns = [], 0.0, begin_ns
    for (a, b), (x, y), length in zip(points, points[1:], lengths):
        covered += length
        other_ns = begin_ns + int((end_ns - begin_ns) * min(1.0, covered / whole))
        course = math.atan2(y - b, x - a)
        if length > 0.0:
            pieces.append((one_ns, other_ns, (a, b, course), (x, y, course)))
            one_ns = other_ns
    *others, (one_ns, _, pose, _) = pieces
    return [*others, (one_ns, end_ns, pose, end)]


def _up_to(end: Tuple[float, float, float], points: Sequence[Tuple[float, float]]) -> Any:
    """Return the ``points`` of the way before its last point that is nearest to ``end``; at least the first one."""
    best = None
    for number, (one, other) in enumerate(zip(points, points[1:])):
        share = share_along(one, other, *end[:2])
        far = round(math.hypot(one[0] + share * (other[0] - one[0]) - end[0],
                               one[1] + share * (other[1] - one[1]) - end[1]), 6)
        if far <= _ON_WAY and (best is None or far <= best[0]):
            best = far, number
    return points[:1] if best is None else points[:best[1] + 1]
