"""Which robot of a circle of waiting gives way, and by which way it drives back (deadlock: retreat).

The robot of the circle that would be served last gives way: the one with the lowest priority, then the one that asked
last, then by name. It drives back along the way by which it came, up to the first point at which it is in no area.
"""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple

from ..maps.lane_map import NEAR
from ..motion.geometry import Pose2D
from ..motion.planned_way import PieceLimit, PlannedWay
from .outline import BORDER
from .way import with_groups

if TYPE_CHECKING:
    from ..maps.lane_map import Edge
    from .area import Area
    from .traveller import Traveller
    from .waiting import Reason
    from .way import Stay

_FREE = PieceLimit()
Point = Tuple[float, float]


class Piece(NamedTuple):
    """A straight piece of a way that was driven, from ``begin`` to ``end`` [m], on the edge ``lane``, None: on none."""

    begin: Point
    end: Point
    limit: PieceLimit
    lane: Any

    @property
    def length(self) -> float:
        """Its length [m]."""
        return math.dist(self.begin, self.end)


class WayBack(NamedTuple):
    """A way from ``start`` (Pose2D) along ``corners`` (PlannedWay) to ``goal`` (Pose2D), ``distance`` [m] long."""

    start: Pose2D
    corners: PlannedWay
    goal: Pose2D
    distance: float

    @property
    def way(self) -> Tuple[Point, ...]:
        """The points ((x, y), ...) [m] between which it is straight, from its start to its goal."""
        return (self.start.x, self.start.y), *self.corners, (self.goal.x, self.goal.y)


def who_gives_way(circle: Sequence[Tuple[Traveller, Reason]]) -> List[Traveller]:
    """Return the robots of ``circle`` ((Traveller, Reason), ...) that may give way, those that are served last first.

    A robot may give way only if it holds a place in the area for which the robot before it in the circle waits.
    """
    holders = [one for one, (_, reason) in zip([*(pair[0] for pair in circle[1:]), circle[0][0]], circle)
               if reason.area in one.held]
    return sorted(holders, key=lambda one: one.request.key, reverse=True)  # type: ignore[union-attr]


def way_back(driven: Iterable[Tuple[Any, float]], held: Dict[Area, bool],
             stays_of: Callable[[Any], Sequence[Stay]], edges: Sequence[Edge] = ()) -> Optional[WayBack]:
    """Return the way back along the legs that were ``driven`` to where the robot is in no area, or None.

    ``driven``: [(leg, distance driven on it [m]), ...]; ``held``: the areas in which the robot holds a place; other
    areas on the way back must have room now. ``stays_of(way)`` returns the Stays of a way; ``edges``: the edges of the
    net by their indices.
    """
    pieces = _without_loops([Piece(piece.end, piece.begin, piece.limit, piece.lane)
                             for leg, length in driven for piece in _pieces(leg, length)][::-1])
    if not pieces:
        return None
    end, lane = pieces[-1].end, pieces[-1].lane  # a robot that began half-way on a lane is still on it there
    on_lane = lane is not None and all(math.dist(end, edges[lane].points[side]) > NEAR for side in (0, -1))
    stays = [stay for stay in with_groups(stays_of(_way(pieces, on_lane))) if stay.area.capacity is not None]
    length = _first_free(stays, math.fsum(piece.length for piece in pieces))
    if length is None or not all(stay.area in held or stay.area.has_room() for stay in stays
                                 if stay.begin < length - BORDER):
        return None
    return _way(_cut(pieces, length))


def _without_loops(pieces: Sequence[Piece]) -> List[Piece]:
    """Return the way without its loops; a robot that was stopped may have turned round."""
    kept: List[Piece] = []
    for piece in pieces:
        kept.append(piece)
        been = next((number for number, one in enumerate(kept) if math.dist(one.begin, piece.end) <= BORDER), None)
        del kept[been if been is not None else len(kept):]
    return kept


def _pieces(leg: Any, length: float) -> List[Piece]:
    """Return the pieces of the first ``length`` [m] of a leg."""
    corners = leg.corners
    points = [(leg.start.x, leg.start.y), *corners, leg.way[-1]]
    count = len(points) - 1
    limits = getattr(corners, 'limits', ()) or (_FREE,) * count
    lanes = getattr(corners, 'lanes', ()) or (None,) * count
    return _cut([Piece(*one) for one in zip(points, points[1:], limits, lanes)], length)


def _cut(pieces: Sequence[Piece], length: float) -> List[Piece]:
    """Return the first ``length`` [m] of ``pieces``."""
    found: List[Piece] = []
    for piece in pieces:
        whole = piece.length
        share = 1.0 if whole <= length + BORDER else max(0.0, length / whole)
        (x, y), (to_x, to_y) = piece.begin, piece.end
        if whole > 0.0 and share > 0.0:
            end = piece.end if share == 1.0 else (x + share * (to_x - x), y + share * (to_y - y))
            found.append(piece._replace(end=end))
        length -= whole
        if length <= BORDER:
            break
    return found


def _way(pieces: Sequence[Piece], ends_on_lane: bool = False) -> WayBack:
    (x, y), (to_x, to_y) = pieces[-1].begin, pieces[-1].end
    yaw = math.atan2(to_y - y, to_x - x)
    corners = PlannedWay([piece.end for piece in pieces[:-1]], [piece.limit for piece in pieces],
                         [piece.lane for piece in pieces], ends_on_lane=ends_on_lane)
    return WayBack(Pose2D(*pieces[0].begin, yaw), corners, Pose2D(to_x, to_y, yaw),
                   math.fsum(piece.length for piece in pieces))


def _first_free(stays: Sequence[Stay], length: float) -> Optional[float]:
    """Return the first distance [m] at which one of ``stays`` ends and no other one goes on, or None.

    At a node, where it has a place of its own, a robot is out of the way, too. ``length`` [m]: that of the way.
    """
    stays = [stay._replace(end=length) if stay.end is None and stay.area.point is not None else stay for stay in stays]
    ends = sorted(stay.end for stay in stays if stay.end is not None and stay.end > BORDER)
    return next((end for end in ends if not any(
        stay.begin < end - BORDER and (stay.end is None or stay.end > end + BORDER) for stay in stays)), None)
