"""The nodes of a net that have place for a limited number of robots."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Dict, List, Optional, Tuple

from ..maps.lane_map import NEAR
from .area import Area

if TYPE_CHECKING:
    from ..maps.lane_map import LaneMap


class NodeAreas:
    """The areas of the nodes of ``lanes`` (LaneMap) that have a capacity: :attr:`areas`, {name: Area}."""

    def __init__(self, lanes: LaneMap) -> None:
        self._nodes = lanes.nodes
        self._edges = lanes.edges
        self.areas = {name: Area('node', name, capacity, point=(lanes.nodes[name].x, lanes.nodes[name].y),
                                 spots=lanes.spots.get(name, ()))
                      for name, capacity in lanes.capacities.items()}
        self._cells: Dict[Tuple[int, int], List[Area]] = {}  # of 1 m
        for name, area in self.areas.items():
            points = [(lanes.nodes[name].x, lanes.nodes[name].y), *lanes.spots.get(name, ())]
            for cell in dict.fromkeys(_cell(x + dx, y + dy) for x, y in points for dx in (-NEAR, NEAR)
                                      for dy in (-NEAR, NEAR)):
                self._cells.setdefault(cell, []).append(area)

    def at(self, x: float, y: float) -> List[Area]:
        """Return the areas of the nodes at which a robot at (x, y) [m] is."""
        return [area for area in self._cells.get(_cell(x, y), ()) if area.contains(x, y)]

    def end_of(self, edge: Optional[int], point: Tuple[float, float]) -> Optional[Area]:
        """Return the area of the node at which a robot on ``edge`` (its index) comes off it near ``point`` (x, y) [m].

        ``edge`` None: it comes from off the net. The result is None if the node has no capacity, or there is no node.
        """
        if edge is None:
            return next(iter(self.at(*point)), None)
        ends = self._edges[edge].begin, self._edges[edge].end
        return self.areas.get(min(ends, key=lambda name: math.dist((self._nodes[name].x, self._nodes[name].y), point)))


def _cell(x: float, y: float) -> Tuple[int, int]:
    return math.floor(x), math.floor(y)
