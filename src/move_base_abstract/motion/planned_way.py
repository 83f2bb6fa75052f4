"""The way that a planner finds: its corners and, if there are any, the limits of its pieces and its duration."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Dict, Iterable, NamedTuple, Optional, Sequence, Tuple

if TYPE_CHECKING:
    from .phases import Segment
    from .route import Route

    Point = Tuple[float, float]
    Known = Tuple[Point, Point, Sequence[Segment]]


class PieceLimit(NamedTuple):
    """The limit of a straight piece of a way: the robot's top speed, at most ``speed`` [m/s], times ``share``.

    A piece whose ``share`` is 0.5 takes as long as a piece of twice its length.
    """

    speed: float = math.inf
    share: float = 1.0
    #: whether the robot drives into it without a stop, whatever it does at corners: only the limit changes there
    goes_on: bool = False

    def of(self, max_speed: float) -> float:
        """Return the top speed [m/s] on the piece for a robot of ``max_speed`` [m/s]."""
        return min(self.speed, max_speed) * self.share


class PlannedWay(Tuple[Tuple[float, float], ...]):
    """The corners ((x, y), ...) [m] of a way, and more about it. It is an immutable tuple.

    ``limits`` (PieceLimit, ...) and ``lanes`` (the lane on which each piece runs, or None) have one entry for each
    straight piece, one more than there are corners, or they are empty. ``seconds``: the time that the whole way takes,
    whatever the robot's limits, None: the time by these limits. ``known``: (start, goal, the route's Segments between
    them) if the planner knows them already, otherwise None. ``routes``: the routes that have been made along this way,
    kept by :func:`.route.route_along`.
    """

    limits: Tuple[Optional[PieceLimit], ...] = ()
    lanes: Tuple[Any, ...] = ()
    seconds: Optional[float] = None
    known: Optional[Known] = None
    routes: Dict[Tuple[Any, ...], Route]
    #: whether the goal lies on the last of the lanes, and not at its end
    ends_on_lane = False

    def __new__(cls, corners: Iterable[Point] = (), limits: Iterable[Optional[PieceLimit]] = (),
                lanes: Iterable[Any] = (), seconds: Optional[float] = None, ends_on_lane: bool = False,
                known: Optional[Known] = None) -> PlannedWay:
        """Return the way along ``corners``."""
        way: PlannedWay = super().__new__(cls, corners)
        way.limits, way.lanes, way.seconds = tuple(limits), tuple(lanes), seconds
        way.ends_on_lane, way.known, way.routes = ends_on_lane, known, {}
        return way
