"""The nodes of a net of lanes as places of robots, with the areas of each, and ways over given nodes."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from ..maps.lane_map import NEAR
from ..motion.geometry import Pose2D
from ..motion.planned_way import PieceLimit, PlannedWay

if TYPE_CHECKING:
    from ..maps.lane_map import Edge, LaneMap
    from .area import Area
    from .nodes import NodeAreas
    from .way import ZoneIndex

    Point = Tuple[float, float]


class WayOver(NamedTuple):
    """A way along ``corners`` (PlannedWay) to ``goal`` (Pose2D), the last of the given nodes."""

    corners: PlannedWay
    goal: Pose2D


class LanePlaces:
    """The nodes of ``lanes`` (LaneMap): ``areas`` {node: (Area, ...)}, ``steps`` {node: {next node: (Area, ...)}}.

    A robot at a node holds a place in the areas of the node, and in those of a step on its way to the next one. Only
    areas with a capacity count. ``area_of(edge)`` returns the area of an edge by its index, or None.
    """

    def __init__(self, lanes: LaneMap, zones: ZoneIndex, nodes: NodeAreas,
                 area_of: Callable[[int], Optional[Area]]) -> None:
        self._lanes = lanes
        self._nodes = nodes
        self._names = {area: name for name, area in nodes.areas.items()}
        self.areas: Dict[str, Tuple[Area, ...]] = {
            name: _counted([*zones.at(pose.x, pose.y), *([nodes.areas[name]] if name in nodes.areas else [])])
            for name, pose in lanes.nodes.items()}
        self.steps: Dict[str, Dict[str, Tuple[Area, ...]]] = {name: {} for name in lanes.nodes}
        self._edges: Dict[Tuple[str, str], int] = {}
        #: the first two nodes that are at one point, so that nobody can tell at which of them a robot is; ()
        self.same: Tuple[str, ...] = _at_one_point(lanes)
        self.on_edges: List[Tuple[Area, ...]] = []
        self._own = [area_of(index) for index in range(len(lanes.edges))]
        for index, (edge, own) in enumerate(zip(lanes.edges, self._own)):
            on_edge = _counted([*([] if own is None else [own]), *(stay.area for stay in zones.stays(edge.points))])
            self.on_edges.append(on_edge)
            for begin, end in [(edge.begin, edge.end)] + [(edge.end, edge.begin)] * (not edge.one_way):
                self.steps[begin][end] = on_edge
                self._edges[begin, end] = index

    def node_at(self, x: float, y: float) -> Optional[str]:
        """Return the node at (x, y) [m], or at one of whose spots this is, or None."""
        found = self._nodes.at(x, y)
        if found:
            return self._names[found[0]]
        return next((name for name, pose in self._lanes.nodes.items() if math.hypot(pose.x - x, pose.y - y) <= NEAR),
                    None)

    def edge_at(self, x: float, y: float, held: Mapping[Area, bool]) -> Optional[int]:
        """Return the index of the edge on which (x, y) [m] is, or None; first of those in whose own area a robot is.

        Then those come at whose other node it has its place: it has just set out.
        """
        found = [index for index, edge in enumerate(self._lanes.edges) if _piece_at(edge.points, (x, y)) is not None]
        held_on = [index for index in found if self._own[index] in held]
        here = self.node_at(x, y)
        towards = [index for index in found if any(area in held and area.point is not None for end in self.all_ends_of(
            index) if end != here for area in self.areas[end])]
        return next(iter([*held_on, *towards, *found]), None)

    def ends_of(self, edge: int, held: Mapping[Area, bool]) -> Tuple[str, ...]:
        """Return the nodes to which a robot on an edge may go: the one ahead if it holds its place there already."""
        one = self._lanes.edges[edge]
        ends = (one.end,) if one.one_way else (one.end, one.begin)
        ahead = tuple(end for end in ends if any(area.point is not None and area in held for area in self.areas[end]))
        return ahead or ends

    def all_ends_of(self, edge: int) -> Tuple[str, str]:
        """Return both nodes of an edge."""
        return self._lanes.edges[edge].begin, self._lanes.edges[edge].end

    def before_turn(self, begin: Point, edge: Optional[int], nodes: Sequence[str]) -> Sequence[str]:
        """Return the first of ``nodes``, up to the one at which a robot turns round on the lane by which it came.

        It drives from ``begin`` (x, y) [m], on the edge with the index ``edge``, or at a node.
        """
        before = self.node_at(*begin) if edge is None else next(
            (end for end in self.all_ends_of(edge) if end != nodes[0]), None)
        whole = [before, *nodes]
        end = next((number for number in range(1, len(nodes)) if whole[number - 1] == whole[number + 1]), len(nodes))
        return nodes[:end]

    def way(self, begin: Point, edge: Optional[int], nodes: Sequence[str]) -> WayOver:
        """Return the way from ``begin`` (x, y) [m] over ``nodes``, of which each is a neighbour of the one before.

        ``edge``: the index of the edge on which the robot is, None: it is at a node.
        """
        pieces: List[Tuple[Point, PieceLimit, Optional[int]]] = []
        before = self.node_at(*begin) if edge is None else None
        if before is not None:
            at = self._lanes.nodes[before]
            if math.hypot(at.x - begin[0], at.y - begin[1]) > NEAR:  # at a spot
                pieces.append(((at.x, at.y), PieceLimit(), None))
        for node in nodes:
            index = self._edges[before, node] if before is not None else edge
            assert index is not None
            one = self._lanes.edges[index]
            points = _towards(one, node, begin if before is None else None)
            limit = PieceLimit(math.inf if one.speed is None else one.speed, one.share)
            pieces += [(point, limit, index) for point in points]
            before = node
        pose = self._lanes.nodes[nodes[-1]]
        corner = pieces[-2][0] if len(pieces) > 1 else begin
        yaw = math.atan2(pose.y - corner[1], pose.x - corner[0])
        return WayOver(PlannedWay([point for point, _, _ in pieces[:-1]], [limit for _, limit, _ in pieces],
                                  [index for _, _, index in pieces]), Pose2D(pose.x, pose.y, yaw))


def _at_one_point(lanes: LaneMap) -> Tuple[str, ...]:
    nodes = sorted(lanes.nodes.items(), key=lambda one: (one[1].x, one[1].y))
    for number, (name, pose) in enumerate(nodes):
        for other, its in nodes[number + 1:]:
            if its.x - pose.x > NEAR:
                break
            if math.hypot(its.x - pose.x, its.y - pose.y) <= NEAR:
                return name, other
    return ()


def _counted(areas: Sequence[Area]) -> Tuple[Area, ...]:
    """Return those of ``areas`` and their groups that have a capacity, each once."""
    both = [*areas, *(area.group for area in areas if area.group is not None)]
    return tuple(dict.fromkeys(area for area in both if area.capacity is not None))


def _towards(edge: Edge, node: str, begin: Optional[Point]) -> Sequence[Point]:
    """Return the points of ``edge`` up to ``node``, behind its other end or behind ``begin``, a point on it."""
    points = edge.points if edge.end == node else edge.points[::-1]
    first = 0 if begin is None else _piece_at(points, begin)
    assert first is not None
    return points[first + 1:]


def _piece_at(points: Sequence[Point], place: Point) -> Optional[int]:
    """Return the number of the straight piece on which ``place`` is, or None."""
    for number, ((ax, ay), (bx, by)) in enumerate(zip(points, points[1:])):
        dx, dy = bx - ax, by - ay
        share = ((place[0] - ax) * dx + (place[1] - ay) * dy) / (dx * dx + dy * dy)
        share = min(1.0, max(0.0, share))
        if math.hypot(ax + share * dx - place[0], ay + share * dy - place[1]) <= NEAR:
            return number
    return None
