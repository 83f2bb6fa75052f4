"""Ways along lanes: from where a robot is to the net, over the net in the shortest time, and from it to the goal."""
from __future__ import annotations

import math
from collections import OrderedDict
from itertools import chain
from typing import TYPE_CHECKING, Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ..common.units import NS_PER_S
from ..motion.planned_way import PieceLimit, PlannedWay
from ..motion.route import segments_along
from .kept import Kept, corners_of
from .lane_map import NEAR, path_length
from .planning import StraightLinePlanner, WorldBounds
from .priced_ways import cheapest, times_to

if TYPE_CHECKING:
    from typing import OrderedDict as Ordered

    from ..motion.geometry import Pose2D
    from ..motion.phases import Segment
    from .lane_map import Edge, LaneMap
    from .map_check import MapCheck
    from .priced_ways import Prices

_KEPT_NETS = 64
_KEPT_TIMES = 2_000_000  # times from nodes to goal nodes
_FREE = PieceLimit()

_shared: Ordered[Any, LaneWays] = OrderedDict()  # {(id of a LaneMap, speed): LaneWays, which keeps the map alive}


class _Lane(NamedTuple):
    """One direction of the edge with the index ``edge``; driving it takes ``cost`` [ns] at full speed."""

    edge: int
    begin: str
    end: str
    points: Tuple[Tuple[float, float], ...]
    limit: PieceLimit
    cost: int
    segments: Tuple[Segment, ...]


class _Piece(NamedTuple):
    """A straight piece up to ``to`` (x, y) [m], on the edge with the index ``edge``, None: off the net."""

    to: Tuple[float, float]
    limit: PieceLimit
    edge: object


class _Access(NamedTuple):
    """The connection of a point with the net: at ``node``, by ``pieces`` that take ``cost`` [ns] at full speed."""

    node: str
    pieces: Tuple[_Piece, ...]
    cost: int


class _Towards(NamedTuple):
    """Ways to one goal node.

    ``times``: {node: time to the goal node [ns] at full speed}; ``onward``: {node: the first lane of its shortest way},
    for nodes that were asked for.
    """

    times: Dict[str, int]
    onward: Dict[str, _Lane]


class LaneWays:
    """The ways on a :class:`.lane_map.LaneMap` for robots of ``max_speed`` [m/s]. Ways are cached.

    The shortest way takes the least time at full speed, in whole nanoseconds per edge. Of equally short ways, at each
    node where they part, the one counts whose next node comes first in the file.
    """

    def __init__(self, lane_map: LaneMap, max_speed: float) -> None:
        self._map = lane_map
        self._places = {name: (pose.x, pose.y) for name, pose in lane_map.nodes.items()}
        self._lanes = [lane for index, edge in enumerate(lane_map.edges) for lane in _lanes(index, edge, max_speed)]
        order = {name: number for number, name in enumerate(lane_map.nodes)}
        self._leaving: Dict[str, List[_Lane]] = {name: [] for name in order}
        self._arriving: List[List[Tuple[int, int]]] = [[] for _ in order]  # per node: [(number of another, ns), ...]
        for lane in sorted(self._lanes, key=lambda lane: order[lane.end]):
            self._leaving[lane.begin].append(lane)
            self._arriving[order[lane.end]].append((order[lane.begin], lane.cost))
        self._order = order
        self._goals: Ordered[str, _Towards] = OrderedDict()
        self._nodes_xy = np.array(list(self._places.values()))
        pieces = [(number, index, *one, *other) for number, lane in enumerate(self._lanes)
                  for index, (one, other) in enumerate(zip(lane.points, lane.points[1:]))]
        self._pieces = np.array(pieces, float).reshape(len(pieces), 6)
        # Robots go to the same places again and again.
        self._found: Callable[..., Optional[PlannedWay]] = Kept(self._find, corners_of)
        self._nearest: Callable[[Tuple[float, float]], Tuple[str, bool]] = Kept(self._find_nearest, len)
        self._accesses: Callable[..., Tuple[_Access, ...]] = Kept(
            self._find_accesses, lambda accesses: sum(len(access.pieces) for access in accesses))

    @classmethod
    def on(cls, lane_map: LaneMap, max_speed: float) -> LaneWays:
        """Return the ways on the LaneMap ``lane_map``; all robots with one ``max_speed`` [m/s] share them."""
        key = id(lane_map), max_speed
        if key not in _shared:
            _shared[key] = cls(lane_map, max_speed)
            if len(_shared) > _KEPT_NETS:
                _shared.popitem(last=False)
        return _shared[key]

    def way(self, start: Tuple[float, float], goal: Tuple[float, float]) -> Optional[PlannedWay]:
        """Return the :class:`.PlannedWay` from ``start`` to ``goal`` ((x, y), m), or None if no lanes lead there."""
        return self._found(start, goal)

    def priced_way(self, start: Tuple[float, float], goal: Tuple[float, float], prices: Prices) -> Optional[PlannedWay]:
        """Return the way with the least sum of time and ``prices``, or None if no lanes lead there; it is not cached.

        See :mod:`.priced_ways`.
        """
        return self._find(start, goal, prices)

    def meeting_nodes(self, place: Tuple[float, float], to_goal: bool = False) -> List[str]:
        """Return the nodes at which a robot comes onto the net from ``place`` ((x, y), m).

        With ``to_goal``, return the nodes at which a robot leaves the net for ``place``.
        """
        return [access.node for access in self._accesses(place, to_goal)]

    def distance_to(self, place: Tuple[float, float]) -> float:
        """Return the distance [m] from ``place`` ((x, y), m) to the nearest node or lane."""
        nearest = float(np.hypot(*(self._nodes_xy - place).T).min())
        return min(nearest, float(self._pieces_away(place)[1].min())) if len(self._pieces) else nearest

    def _find(self, start: Tuple[float, float], goal: Tuple[float, float],
              prices: Optional[Prices] = None) -> Optional[PlannedWay]:
        if math.dist(start, goal) <= NEAR:
            return PlannedWay()
        candidates = self._along_one_lane(start, goal)
        priced: Dict[Tuple[str, str], List[_Lane]] = {}
        for first in self._accesses(start):
            for last in self._accesses(goal, True):
                times = self._towards(last.node).times
                cost = times.get(first.node)
                if cost is not None and prices is not None:
                    cost, priced[first.node, last.node] = cheapest(
                        self._leaving, times, first.node, last.node, prices)
                if cost is not None:
                    candidates.append((first.cost + cost + last.cost, first, last))
        if not candidates:
            return None
        _, first, last = min(candidates, key=lambda candidate: candidate[0])
        if last is None:
            return _planned(start, first, goal, True)
        lanes = priced.get((first.node, last.node)) or self._lanes_between(first.node, last.node)
        if lanes and (lanes[0].points[0], lanes[-1].points[-1]) == (start, goal):
            return _over_lanes(lanes)
        over = [piece for lane in lanes for piece in _pieces(lane, lane.points[1:])]
        return _planned(start, [*first.pieces, *over, *last.pieces], goal, bool(last.pieces))

    def _towards(self, node: str) -> _Towards:
        towards = self._goals.get(node)
        if towards is None:
            times = times_to(self._arriving, self._order[node])
            towards = self._goals[node] = _Towards({name: time for name, time in zip(self._order, times)
                                                    if time is not None}, {})
            if len(self._goals) * len(self._places) > _KEPT_TIMES:
                self._goals.popitem(last=False)
        return towards

    def _lanes_between(self, node: str, last: str) -> List[_Lane]:
        """Return the lanes of the shortest way from ``node`` to ``last``; for equal ones see the class."""
        times, onward = self._towards(last)
        lanes: List[_Lane] = []
        while node != last:
            lane = onward.get(node)
            if lane is None:
                lane = onward[node] = next(lane for lane in self._leaving[node]
                                           if lane.end in times and lane.cost + times[lane.end] == times[node])
            lanes.append(lane)
            node = lane.end
        return lanes

    def _find_accesses(self, place: Tuple[float, float], to_goal: bool = False) -> Tuple[_Access, ...]:
        """Return the connections of ``place`` to the net, or with ``to_goal`` from the net to it.

        If the place is on lanes, they lead along these. Otherwise there is one, straight between the place and the
        nearest node; of equally near nodes the first in the file counts.
        """
        node, is_there = self._nearest(place)
        if is_there:
            return (_Access(node, (), 0),)
        accesses = []
        for number, index, share in self._lanes_at(place):
            lane = self._lanes[number]
            points = [*lane.points[1:index + 1], place] if to_goal else lane.points[index + 1:]
            covered = path_length(lane.points[:index + 1]) + share * path_length(lane.points[index:index + 2])
            part = covered / path_length(lane.points)
            cost = round((part if to_goal else 1.0 - part) * lane.cost)
            accesses.append(_Access(lane.begin if to_goal else lane.end, _pieces(lane, points), cost))
        if accesses:
            return tuple(accesses)
        return (_Access(node, () if to_goal else (_Piece(self._places[node], _FREE, None),), 0),)

    def _find_nearest(self, place: Tuple[float, float]) -> Tuple[str, bool]:
        """Return (the node that is nearest to ``place``, whether the place is at that node)."""
        far = np.hypot(*(self._nodes_xy - place).T)
        nearest = int(np.round(far, 6).argmin())
        return list(self._places)[nearest], far[nearest] <= NEAR

    def _lanes_at(self, place: Tuple[float, float]) -> List[Tuple[int, int, float]]:
        """Return (number of the lane, number of its piece, share of the piece) for each lane on which ``place`` is."""
        if not len(self._pieces):
            return []
        shares, far = self._pieces_away(place)
        near = np.flatnonzero(far <= NEAR)
        found: Dict[int, Tuple[int, float]] = {}
        for one in near:
            found.setdefault(int(self._pieces[one, 0]), (int(self._pieces[one, 1]), float(shares[one])))
        return [(number, *where) for number, where in found.items()]

    def _pieces_away(self, place: Tuple[float, float]) -> Tuple[Any, Any]:
        """Return (shares at which the pieces of the lanes are nearest to ``place``, the distances there [m])."""
        begin, along = self._pieces[:, 2:4], self._pieces[:, 4:6] - self._pieces[:, 2:4]
        shares = np.clip(((place - begin) * along).sum(1) / (along * along).sum(1), 0.0, 1.0)
        return shares, np.hypot(*(begin + shares[:, None] * along - place).T)

    def _along_one_lane(self, start: Tuple[float, float],
                        goal: Tuple[float, float]) -> List[Tuple[int, Any, Any]]:
        """Return the candidates that stay on one lane: both points are on it, and neither is at a node."""
        if self._nearest(start)[1] or self._nearest(goal)[1]:
            return []
        ends: Dict[int, List[Any]] = {number: where for number, *where in self._lanes_at(goal)}
        candidates: List[Tuple[int, Any, Any]] = []
        begin: List[Any]
        for number, *begin in self._lanes_at(start):
            if number in ends and begin <= ends[number]:
                lane, last = self._lanes[number], ends[number][0]
                points = [*lane.points[begin[0] + 1:last + 1], goal]
                cost = round(path_length([start, *points]) / path_length(lane.points) * lane.cost)
                candidates.append((cost, _pieces(lane, points), None))
        return candidates


class LanePlanner(StraightLinePlanner):
    """Plans ways along the lanes of ``ways`` (LaneWays). ``bounds`` and the map only decide which goals are allowed."""

    goes_straight = False

    def __init__(self, ways: LaneWays, bounds: WorldBounds = WorldBounds(),
                 map_check: Optional[MapCheck] = None) -> None:
        super().__init__(bounds, map_check)
        self._ways = ways

    def refusal_of_way(self, start: Pose2D, goal: Pose2D) -> Optional[str]:
        """Return a text that says why there is no way from ``start`` to ``goal``; call it only if there is none."""
        return super().refusal_of_way(start, goal) or (
            'No lanes lead from ({:g}, {:g}) to the goal ({:g}, {:g}).'.format(start.x, start.y, goal.x, goal.y))

    def corners(self, start: Pose2D, goal: Pose2D) -> Optional[PlannedWay]:
        """Return the :class:`.PlannedWay`, or None if there is no way."""
        if not self.reachable(goal):
            return None
        ends = (start.x, start.y), (goal.x, goal.y)
        return self._ways.way(*ends) if self.prices is None else self._ways.priced_way(*ends, self.prices)


def _lanes(index: int, edge: Edge, max_speed: float) -> List[_Lane]:
    """Return the directions of an edge in which robots may drive."""
    limit = PieceLimit(math.inf if edge.speed is None else edge.speed, edge.share)
    cost = max(1, round(path_length(edge.points) / limit.of(max_speed) * NS_PER_S))
    ways = [(edge.begin, edge.end, edge.points)]
    if not edge.one_way:
        ways.append((edge.end, edge.begin, edge.points[::-1]))
    return [_Lane(index, *way, limit, cost, segments_along(way[2], limit)) for way in ways]


def _over_lanes(lanes: Sequence[_Lane]) -> PlannedWay:
    """Return the PlannedWay over exactly these ``lanes``."""
    points = list(chain.from_iterable([lane.points[1:] for lane in lanes]))
    segments = tuple(chain.from_iterable([lane.segments for lane in lanes]))
    return PlannedWay(points[:-1], [segment.limit for segment in segments],
                      [lane.edge for lane in lanes for _ in lane.segments],
                      known=(lanes[0].points[0], points[-1], segments))


def _pieces(lane: _Lane, points: Sequence[Tuple[float, float]]) -> Tuple[_Piece, ...]:
    return tuple(_Piece(point, lane.limit, lane.edge) for point in points)


def _planned(start: Tuple[float, float], pieces: Sequence[_Piece], goal: Tuple[float, float],
             ends_on_lane: bool) -> PlannedWay:
    """Return the PlannedWay from ``start`` along ``pieces`` to ``goal``, without pieces of no length."""
    kept = _without_rests(start, pieces)
    if kept and math.dist(kept[-1].to, goal) <= NEAR:
        kept[-1] = kept[-1]._replace(to=goal)
    else:
        kept.append(_Piece(goal, _FREE, None))
    return PlannedWay([piece.to for piece in kept[:-1]], [piece.limit for piece in kept],
                      [piece.edge for piece in kept], ends_on_lane=ends_on_lane)


def _without_rests(start: Tuple[float, float], pieces: Sequence[_Piece]) -> List[_Piece]:
    kept: List[_Piece] = []
    for piece in pieces:
        if piece.to != (kept[-1].to if kept else start):
            kept.append(piece)
    return kept
