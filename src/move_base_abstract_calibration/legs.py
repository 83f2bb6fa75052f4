"""Legs as a real robot drove them, and the way of each: its length and its turns."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, List, NamedTuple, Optional, Sequence, Tuple

from move_base_abstract.motion.geometry import Pose2D, normalize_angle

if TYPE_CHECKING:
    from move_base_abstract.maps.occupancy import OccupancyMap

FAR_STEP = 1.0  # m; two successive poses of a robot should not be farther apart


class Way(NamedTuple):
    """The length of a leg [m], and the turns of the robot at its start and its end [rad, to the left > 0]."""

    length: float
    start_turn: float
    end_turn: float


class RecordedLeg(NamedTuple):
    """One goal of one robot. All poses are in one fixed frame [m, m, rad]. A value that is not recorded is None.

    ``recording`` and ``robot``: where it comes from; ``duration`` [s]: from the goal to its result; ``way``: as planned
    or driven; ``end``: where the robot was at the result; ``counts``: whether the duration says something about the
    robot (not if somebody moved it, or it was already stuck); ``nearest_robot`` [m]: the least distance to another
    robot; ``clearance`` [m]: the least distance of the way to occupied cells; ``sent`` [s]: when the goal was sent;
    ``by_stamps`` [s]: the duration by two further stamps; ``doubt``: the fault that its reader has found, a key of
    checks.DOUBTS, or ''; ``cut``: whether it was preempted; ``map``: the name of its map, '' if it is not recorded;
    ``reverse`` [s]: how long the robot drove backwards; ``turned`` [rad]: by how much more it turned than its way asks
    for.
    """

    recording: str
    robot: str
    number: int
    start: Pose2D
    goal: Pose2D
    duration: float
    succeeded: bool
    failed: bool
    way: Optional[Way] = None
    end: Optional[Pose2D] = None
    counts: bool = True
    nearest_robot: Optional[float] = None
    clearance: Optional[float] = None
    sent: Optional[float] = None
    by_stamps: Optional[float] = None
    doubt: str = ''
    cut: bool = False
    map: str = ''
    reverse: Optional[float] = None
    turned: Optional[float] = None


#: a leg, and the way that it counts as
Pair = Tuple[RecordedLeg, Way]
Pairs = Sequence[Pair]


def met_no_robot(leg: RecordedLeg, distance: float) -> bool:
    """Return whether no other robot came nearer than ``distance`` [m], or it is not known."""
    return leg.nearest_robot is None or leg.nearest_robot >= distance


def way_along(start: Pose2D, points: Sequence[Tuple[float, float]], goal: Pose2D) -> Way:
    """Return the :class:`Way` of straight pieces from ``start`` by ``points`` [(x, y), m] to ``goal`` (Pose2D)."""
    places = [(start.x, start.y), *points, (goal.x, goal.y)]
    pieces = [(math.dist(one, other), math.atan2(other[1] - one[1], other[0] - one[0]))
              for one, other in zip(places, places[1:]) if one != other]
    if not pieces:
        return Way(0.0, 0.0, normalize_angle(goal.yaw - start.yaw))
    return Way(math.fsum(length for length, _ in pieces), normalize_angle(pieces[0][1] - start.yaw),
               normalize_angle(goal.yaw - pieces[-1][1]))


def ways_of(legs: Sequence[RecordedLeg], occupancy: Optional[OccupancyMap] = None, radius: float = 0.0) -> List[Pair]:
    """Return [(leg, Way)] for ``legs``: their recorded ways, or straight ones; with a map, ways planned on it.

    ``occupancy``: the map (OccupancyMap) or None. Planned ways keep ``radius`` [m] away from occupied cells, and the
    legs get their clearances. A leg without a way on the map is left out.
    """
    if occupancy is None:
        return [(leg, leg.way or way_along(leg.start, (), leg.goal)) for leg in legs]
    from move_base_abstract.maps.grid_planner import MapWays
    from move_base_abstract.maps.way_clearance import way_clearance
    map_ways, found = MapWays.on(occupancy, radius), []
    for leg in legs:
        corners = map_ways.corners(leg.start, leg.goal)
        if corners is not None:
            points = [(leg.start.x, leg.start.y), *corners, (leg.goal.x, leg.goal.y)]
            found.append((leg._replace(clearance=way_clearance(occupancy, points)),
                          way_along(leg.start, corners, leg.goal)))
    return found
