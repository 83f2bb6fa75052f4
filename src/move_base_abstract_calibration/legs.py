"""Legs as a real robot drove them, and the way that each had: its length and its turns."""
import math
from typing import NamedTuple, Optional

from move_base_abstract.motion.geometry import Pose2D, normalize_angle

FAR_STEP = 1.0  # m: between two poses one after the other a robot is not to be lost sight of so far


class Way(NamedTuple):
    """How far a leg leads [m], and by how much the robot turns before and behind [rad, to the left > 0]."""

    length: float
    start_turn: float
    end_turn: float


class RecordedLeg(NamedTuple):
    """One goal of one robot. Poses in one fixed frame [m, m, rad].

    ``recording`` and ``robot`` name where it comes from; ``duration`` [s] from the goal to its result; ``way`` as
    planned or driven, None where nothing says it; ``end`` where the robot was at the result; ``counts``: whether its
    duration says something of the robot (not of somebody who moved it, or of one that was stuck already);
    ``nearest_robot`` [m]: how near another robot came, ``clearance`` [m]: how near the way comes to what is occupied,
    ``sent`` [s]: when the goal was sent, ``by_stamps`` [s]: the duration between two stamps beside; None if nobody
    says. ``doubt``: what its reader has found wrong with it, one of checks.DOUBTS; ``map``: the name of its map,
    '' if nobody says; ``reverse`` [s]: how long it drove backwards, ``turned`` [rad]: by how much it turned beyond what
    its way asks for, None if nobody says.
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
    map: str = ''
    reverse: Optional[float] = None
    turned: Optional[float] = None


def met_no_robot(leg, distance):
    """Return whether no other robot came nearer than ``distance`` [m], as far as anybody says."""
    return leg.nearest_robot is None or leg.nearest_robot >= distance


def way_along(start, points, goal):
    """Return the :class:`Way` of straight pieces from ``start`` by ``points`` [(x, y), m] to ``goal`` (Pose2D)."""
    places = [(start.x, start.y), *points, (goal.x, goal.y)]
    pieces = [(math.dist(one, other), math.atan2(other[1] - one[1], other[0] - one[0]))
              for one, other in zip(places, places[1:]) if one != other]
    if not pieces:
        return Way(0.0, 0.0, normalize_angle(goal.yaw - start.yaw))
    return Way(math.fsum(length for length, _ in pieces), normalize_angle(pieces[0][1] - start.yaw),
               normalize_angle(goal.yaw - pieces[-1][1]))


def ways_of(legs, occupancy=None, radius=0.0):
    """Return [(leg, Way)] of ``legs``: as recorded, else straight; with a map (OccupancyMap) those planned on it.

    These keep ``radius`` [m] off what is occupied; the legs' clearances are theirs then. A leg to which no way leads is
    left out.
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
