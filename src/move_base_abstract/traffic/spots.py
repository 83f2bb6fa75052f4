"""Where a robot stands at a node that has place for several robots, each at its own spot."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Optional, Sequence, Tuple

from ..maps.lane_map import NEAR
from ..motion.geometry import Pose2D
from ..motion.planned_way import PieceLimit, PlannedWay

if TYPE_CHECKING:
    from ..goals.travel import Travel
    from ..maps.lane_map import LaneMap
    from .area import Area, Point
    from .control import Traffic
    from .nodes import NodeAreas
    from .traveller import Traveller

_FREE = PieceLimit()


class Standing:
    """Brings the robot of ``traveller`` to its spots at ``nodes`` (NodeAreas): at its goal, and where it must wait.

    A robot gets to know its own spot when it gets its place at the node. Before, it drives to the one that it would
    get.
    """

    def __init__(self, traveller: Traveller, nodes: NodeAreas, travel: Travel) -> None:
        self._traveller = traveller
        self._nodes = nodes
        self._aims: Optional[Tuple[Area, Point]] = None  # the node of its goal, and the spot to which it drives
        self._travel = travel
        travel.to_spot = self._to_spot

    def takes(self, node: Area, now_ns: int) -> None:
        """Give the robot, which has a place at ``node``, its spot there: the one where it is, or to which it drives.

        Otherwise it gets one when it needs one.
        """
        pose = self._traveller.navigator.robot.pose_at(now_ns)
        wished = pose.x, pose.y
        if node.is_spot(wished):
            node.forget_spot(self._traveller)  # it may have been placed there
        elif self._aims is not None and self._aims[0] is node:
            wished = self._aims[1]
        else:
            return
        node.spot(self._traveller, wished)

    def goes_elsewhere(self, now_ns: int) -> bool:
        """Have the robot go on to its spot if that is not the one to which it drives; return whether it does."""
        if self._aims is None or self._aims[0] not in self._traveller.held:
            return False
        node, spot = self._aims
        if node.spot(self._traveller, spot) == spot:
            return False
        self._travel.change_way(now_ns)
        return True

    def goes_aside(self, leaves: Sequence[Area], now_ns: int) -> bool:
        """Have the robot, which must wait, drive to its spot at the node among ``leaves``; return whether it does."""
        pose = self._traveller.navigator.robot.pose_at(now_ns)
        for node in leaves:
            spot = node.spot(self._traveller, (pose.x, pose.y)) if node in self._traveller.held else None
            if spot is not None and math.dist(spot, (pose.x, pose.y)) > NEAR:
                yaw = math.atan2(spot[1] - pose.y, spot[0] - pose.x)
                self._travel.change_way(now_ns, PlannedWay((), [_FREE], [None]), Pose2D(*spot, yaw))
                return True
        return False

    def _to_spot(self, start: Pose2D, corners: Any, target: Pose2D, is_aside: bool) -> Tuple[Any, Pose2D]:
        """Return the way from ``start`` to the robot's spot at the node of ``target``, and its end; see Travel.

        A way aside stays as it is. The robot then drives to no spot for its goal.
        """
        self._aims = None
        for node in () if is_aside else self._nodes.at(target.x, target.y):
            spot = node.spot(self._traveller, (target.x, target.y))
            if spot is not None:
                self._aims = node, spot
                return _way(node, (start.x, start.y), corners, (target.x, target.y), spot), Pose2D(*spot, target.yaw)
        return corners, target


def standing_on(lanes: Optional[LaneMap], traveller: Traveller, traffic: Traffic, travel: Travel) -> Optional[Standing]:
    """Return the Standing of a robot that drives on ``lanes``, or None if these have no spots."""
    return Standing(traveller, traffic.nodes(lanes.source), travel) if lanes is not None and lanes.spots else None


def _way(node: Area, start: Point, corners: Any, target: Point, spot: Point) -> Any:
    """Return the way from ``start`` to ``spot`` of ``node``; ``corners``: that to ``target``, at the node or a spot."""
    if math.dist(start, spot) <= NEAR:
        return PlannedWay()
    if math.dist(start, target) <= NEAR:
        return PlannedWay((), [_FREE], [None])
    if node.is_spot(target):
        return corners
    return PlannedWay([*corners, target], [*corners.limits, _FREE], [*corners.lanes, None])
