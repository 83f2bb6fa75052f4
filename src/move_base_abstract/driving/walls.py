"""The walls that a driving body can touch: the occupied cells of a map."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Dict, Iterable, List, NamedTuple, Optional, Tuple

import numpy as np

from ..common.map_images import OCCUPIED
from ..maps.clearance import ClearanceField
from ..motion.geometry import Pose2D
from ..motion.pieces import Piece, pose_of, stand
from .contact import FREE, OVERLAP, REACH, Course, Limit, Shape, disc, first_touch, gap_of, limit_of, standing

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..maps.occupancy import OccupancyMap

_STRIDE = 0.25  # m; the way after which the cells near a body are looked up anew, if the body is smaller
_NS_PER_S = 1e9


class _Box(NamedTuple):
    """An upright box of occupied cells, in the map's own axes [m]."""

    left: float
    low: float
    right: float
    high: float

    def course(self) -> Course:
        """Return the :class:`.Course` of the box, which stands."""
        return standing([(self.left, self.low), (self.right, self.low), (self.right, self.high),
                         (self.left, self.high)])

    def distance(self, pose: Pose2D) -> float:
        """Return the distance [m] from ``pose`` to the box."""
        return math.hypot(max(self.left - pose.x, 0.0, pose.x - self.right),
                          max(self.low - pose.y, 0.0, pose.y - self.high))


class Walls:
    """The occupied cells of ``occupancy`` (OccupancyMap), for a body of ``shape`` (Shape).

    Unknown cells, and places off the map, are no walls.
    """

    def __init__(self, occupancy: OccupancyMap, shape: Shape) -> None:
        self._map = occupancy
        self._shape, self._bound = shape, disc(shape.reach)
        self._stride = max(shape.reach, _STRIDE)
        # A power of two, so that bodies of about the same size share a field.
        self._field = ClearanceField.on(occupancy, 2.0 ** math.ceil(math.log2(shape.reach + 2.0 * self._stride)))

    def gap_at(self, pose: Pose2D) -> float:
        """Return the gap [m] between the body at ``pose`` (map frame) and the walls, at most twice REACH."""
        course = Course(self._on_map(stand(pose, 0)), self._shape)
        return min([2.0 * REACH, *(gap for gap, _ in self._gaps(course, 0, True))])

    def first_touch(self, spans: Iterable[Tuple[Piece, int]], begin_ns: int) -> Optional[int]:
        """Return the first instant [ns] from ``begin_ns`` on at which the body touches a wall in ``spans``, or None.

        ``spans``: (a Piece, the instant [ns] at which it ends), ..., in order, in the frame of the map; the first one
        holds at ``begin_ns``. Cells that the body overlaps then are no walls in them.
        """
        limit: Optional[Limit] = None
        passed: Tuple[_Box, ...] = ()
        for piece, end_ns in spans:
            course, speed = Course(self._on_map(piece), self._shape), abs(piece.v)
            now_ns = max(begin_ns, piece.begin_ns)
            while now_ns < end_ns and (speed or piece.w):
                room = self._room(course, now_ns)
                if room > (0.0 if limit is None else 0.25 * self._stride):
                    limit = limit or FREE
                    now_ns = _later(now_ns, room, speed, end_ns)
                    continue
                if limit is None:
                    limit, passed = self._begin(course, now_ns)
                until_ns = _later(now_ns, self._stride, speed, end_ns)
                boxes = [box for box in self._near(course, now_ns, not passed) if box not in passed]
                touch_ns = self._first_of(course, boxes, limit, now_ns, until_ns)
                if touch_ns is not None:
                    return touch_ns
                now_ns = until_ns
        return None

    def _begin(self, course: Course, now_ns: int) -> Tuple[Limit, Tuple[_Box, ...]]:
        """Return (the Limit at which the body touches, the cells that it overlaps) for a motion from now on."""
        passed: Tuple[_Box, ...] = ()
        gap = min((gap for gap, _ in self._gaps(course, now_ns, True)), default=math.inf)
        if gap <= OVERLAP:
            gaps = self._gaps(course, now_ns, False)
            passed = tuple(box for gap, box in gaps if gap <= OVERLAP)
            gap = min((gap for gap, _ in gaps if gap > OVERLAP), default=math.inf)
        return limit_of(gap) or FREE, passed

    def _gaps(self, course: Course, now_ns: int, is_joined: bool) -> List[Tuple[float, _Box]]:
        """Return (the gap [m], a box) for all boxes whose gap may be below twice REACH."""
        pose, most = pose_of(course.piece, now_ns), self._shape.reach + 2.0 * REACH
        return [(gap_of(course, box.course(), now_ns), box) for box in self._near(course, now_ns, is_joined)
                if box.distance(pose) <= most]

    def _first_of(self, course: Course, boxes: List[_Box], limit: Limit, now_ns: int, end_ns: int) -> Optional[int]:
        found, pose = None, pose_of(course.piece, now_ns)
        way = self._shape.reach + REACH + abs(course.piece.v) * ((end_ns - now_ns) / _NS_PER_S)
        bound = Course(course.piece, self._bound)
        for box in boxes:
            distance = box.distance(pose)
            if distance > way:
                continue
            wall, begin_ns = box.course(), now_ns
            if distance > self._shape.reach + REACH:  # first for the disc around the body, which takes less time
                near_ns = first_touch(bound, wall, FREE, now_ns, end_ns)
                if near_ns is None:
                    continue
                begin_ns = near_ns
            touch_ns = first_touch(course, wall, limit, begin_ns, end_ns)
            if touch_ns is not None:
                found = end_ns = touch_ns
        return found

    def _on_map(self, piece: Piece) -> Piece:
        """Return ``piece`` in the map's own axes."""
        begin_ns, x, y, yaw, ux, uy, *rest = piece
        origin, (cos, sin) = self._map.origin, self._map.axes
        x, y = x - origin.x, y - origin.y
        return Piece(begin_ns, cos * x + sin * y, cos * y - sin * x, yaw - origin.yaw,
                     cos * ux + sin * uy, cos * uy - sin * ux, *rest)

    def _room(self, course: Course, now_ns: int) -> float:
        """Return a way [m] on which the body surely touches nothing; below 0: something may be near."""
        pose, side = pose_of(course.piece, now_ns), self._map.resolution
        return self._field.least_at(pose.x / side, pose.y / side) - self._shape.reach - 2.0 * REACH

    def _near(self, course: Course, now_ns: int, is_joined: bool) -> List[_Box]:
        """Return the occupied cells that the body may touch within a stride, as boxes; ``is_joined``: in large ones."""
        pose, side = pose_of(course.piece, now_ns), self._map.resolution
        reach = self._shape.reach + self._stride + 2.0 * REACH
        left, low = (max(0, math.floor((place - reach) / side)) for place in (pose.x, pose.y))
        right, high = (max(0, math.floor((place + reach) / side) + 1) for place in (pose.x, pose.y))
        blocked = self._map.cells[low:high, left:right] >= OCCUPIED
        if not is_joined:
            runs = [(row, column, column + 1, row + 1) for row, column in zip(*(
                found.tolist() for found in np.nonzero(blocked)))]
        else:
            runs = _joined(blocked)
        return [_Box((left + first) * side, (low + row) * side, (left + last) * side, (low + end) * side)
                for row, first, last, end in runs]


def _later(now_ns: int, way: float, speed: float, end_ns: int) -> int:
    """Return the instant [ns] at which ``way`` [m] are covered at ``speed`` [m/s], or ``end_ns`` if that is earlier."""
    left_ns = end_ns - now_ns
    return now_ns + max(1, int(way / speed * _NS_PER_S)) if way * _NS_PER_S < speed * left_ns else end_ns


def _joined(blocked: NDArray[Any]) -> List[Tuple[int, int, int, int]]:
    """Return (row, first column, last column + 1, last row + 1) of boxes that cover ``blocked``: equal runs of rows."""
    edges = np.diff(np.pad(blocked, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    rows, columns = (found.tolist() for found in np.nonzero(edges))
    found: List[Tuple[int, int, int, int]] = []
    open_runs: Dict[Tuple[int, int], Tuple[int, int]] = {}  # {(first, last + 1 column): (first, last + 1 row)}
    for row, first, last in zip(rows[::2], columns[::2], columns[1::2]):
        begin, end = open_runs.get((first, last), (row, row))
        if end != row:  # the run ended in a row before the one before this
            found.append((begin, first, last, end))
            begin = row
        open_runs[first, last] = begin, row + 1
    return found + [(begin, first, last, end) for (first, last), (begin, end) in open_runs.items()]
