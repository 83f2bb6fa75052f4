"""Speed limits of zones: a way is cut where it enters or leaves such a zone, and each piece gets its own limit."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Iterator, List, Sequence, Tuple

from ..motion.planned_way import PieceLimit, PlannedWay
from .outline import BORDER

if TYPE_CHECKING:
    from ..motion.geometry import Pose2D
    from .outline import Outline

_FREE = PieceLimit()
Point = Tuple[float, float]


def limited(start: Pose2D, corners: Any, goal: Pose2D, zones: Sequence[Tuple[Outline, float]]) -> Any:
    """Return the way from ``start`` along ``corners`` to ``goal`` with the limits of ``zones`` ((Outline, m/s), ...).

    If the way is in none of them, ``corners`` is returned. Where there are several limits, including those that the
    pieces have already, the lowest counts.
    """
    points: List[Point] = [(start.x, start.y), *corners, (goal.x, goal.y)]
    inside = [(*piece, speed) for outline, speed in zones for piece in outline.pieces_inside(points)]
    if not inside:
        return corners
    count = len(points) - 1
    limits = getattr(corners, 'limits', ()) or (_FREE,) * count
    lanes = getattr(corners, 'lanes', ())
    ends, found, found_lanes = [], [], []
    for number, end, limit in _pieces(points, limits, inside):
        ends.append(end)
        found.append(limit)
        found_lanes.append(lanes[number] if lanes else None)
    return PlannedWay(ends[:-1], found, found_lanes if lanes else (), getattr(corners, 'seconds', None),
                      getattr(corners, 'ends_on_lane', False))


def _pieces(points: Sequence[Point], limits: Sequence[PieceLimit],
            inside: Sequence[Tuple[float, float, float]]) -> Iterator[Tuple[int, Point, PieceLimit]]:
    """Yield (number of the original piece, end, limit) for each piece after the cuts."""
    cuts = sorted({at for begin, end, _ in inside for at in (begin, end)})
    begun = 0.0
    for number, ((x, y), (to_x, to_y)) in enumerate(zip(points, points[1:])):
        length, last, limit = math.dist((x, y), (to_x, to_y)), 0.0, limits[number]
        for end in [*(at - begun for at in cuts if BORDER < at - begun < length - BORDER), length]:
            middle, share = begun + 0.5 * (last + end), end / length if length > 0.0 else 1.0
            speed = min((speed for one, other, speed in inside if one < middle < other), default=math.inf)
            place = (to_x, to_y) if end == length else (x + share * (to_x - x), y + share * (to_y - y))
            yield number, place, PieceLimit(min(limit.speed, speed / limit.share), limit.share,
                                            limit.goes_on or last > 0.0)
            last = end
        begun += length
