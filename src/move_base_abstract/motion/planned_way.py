"""The way that a planner finds: its corners and, if it has them, the limits of its pieces and its duration."""
import math
from typing import NamedTuple, Optional


class PieceLimit(NamedTuple):
    """How a straight piece of a way is driven: at most at ``speed`` [m/s], and ``share`` times as fast as that.

    A piece whose ``share`` is 0.5 takes as long as one of twice its length.
    """

    speed: float = math.inf
    share: float = 1.0
    #: whether it is driven into without a stop, whatever happens at corners: only the limit changes there
    goes_on: bool = False

    def of(self, max_speed):
        """Return the top speed [m/s] on the piece for a robot of ``max_speed`` [m/s]."""
        return min(self.speed, max_speed) * self.share


class PlannedWay(tuple):
    """The corners ((x, y), ...) [m] of a way, and what more is to be said of it. Immutable as the tuple that it is.

    ``limits`` (PieceLimit, ...) and ``lanes`` (what each piece runs on, or None) have one entry for each straight
    piece, one more than there are corners, or none at all; ``seconds``: how long the whole way takes, whatever the
    robot's limits, None: as long as these say. ``known``: None, or (start, goal, the route's Segments between them), of
    who knows them; ``routes``: what routes along it share, kept by :func:`.route.route_along`.
    """

    limits = ()
    lanes = ()
    seconds: Optional[float] = None
    known = None
    #: whether the goal lies on the last of the lanes, and not at its end
    ends_on_lane = False

    def __new__(cls, corners=(), limits=(), lanes=(), seconds=None, ends_on_lane=False, known=None):
        """Return the way by ``corners``."""
        way = super().__new__(cls, corners)
        way.limits, way.lanes, way.seconds = tuple(limits), tuple(lanes), seconds
        way.ends_on_lane, way.known, way.routes = ends_on_lane, known, {}
        return way
