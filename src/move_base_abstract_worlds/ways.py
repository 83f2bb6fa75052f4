"""Ways and legs of robots before they drive, by the planners and laws that they will use."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Dict, List

import networkx

from move_base_abstract.maps.lane_map import NEAR
from move_base_abstract.maps.lane_planner import LaneWays
from move_base_abstract.motion.robot import Robot
from move_base_abstract.motion.route import CornerLaw

from .findings import Finding
from .net_check import graph_of

if TYPE_CHECKING:
    from move_base_abstract.common.geometry import Pose2D

    from .world import Drivers, Start, World

#: the largest number of ways that one check computes; if there are more, it says that it was not made
MOST_WAYS = 100_000


def too_many(world: World, name: str, what: str) -> Finding:
    """Return the Finding that a check was not made, because ``what`` ('3 robots have', for example) too many ways."""
    return Finding('not_checked', name, '{} more than {} ways'.format(what, MOST_WAYS), os.path.basename(world.path),
                   'check a scenario with fewer of them')


def leg_between(drivers: Drivers, begin: Pose2D, goal: Pose2D) -> Any:
    """Return the leg of a robot of ``drivers`` from ``begin`` to ``goal`` (Pose2D), from rest to rest; None: no way.

    It is at full speed, as :meth:`.Robot.depart` makes it, without overhead, factors and traffic.
    """
    corners = None if drivers.planner is None else drivers.planner.corners(begin, goal)
    if corners is None:
        return None
    settings = drivers.settings
    robot = Robot(0, 'robot', begin, settings.limits, settings.tolerances, 0, CornerLaw(settings.values['corners']),
                  settings.phases, 1, settings.original)
    try:
        return robot.depart(goal, 0, corners)
    except ValueError:  # the goal is too far away for the numbers of a leg
        return None


def alike(drivers: Drivers) -> List[List[Start]]:
    """Return the starts of ``drivers`` in groups, [[Start, ...], ...]. Those of one group reach the same places."""
    values = drivers.settings.values
    if drivers.planner is None or values['routes'] == 'none':
        return [list(drivers.starts)]
    if drivers.lanes is None:
        return [[start] for start in drivers.starts]
    ways = LaneWays.on(drivers.lanes, drivers.settings.limits.max_speed)
    graph = graph_of(drivers.lanes)
    parts = {name: number for number, names in enumerate(networkx.strongly_connected_components(graph))
             for name in names}
    places = {(pose.x, pose.y) for pose in drivers.lanes.nodes.values()}
    groups: Dict[Any, Any] = {}
    for start in drivers.starts:
        nodes = ways.meeting_nodes(start.xy)
        # A robot on a lane may have a goal ahead on it that no other robot reaches.
        is_alone = start.xy not in places and ways.distance_to(start.xy) <= NEAR
        groups.setdefault(start.xy if is_alone else parts[nodes[0]], []).append(start)
    return list(groups.values())
