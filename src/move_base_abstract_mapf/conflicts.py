"""Find conflicts: two robots in one cell, two robots that swap cells, two robots that come near each other."""
from __future__ import annotations

import math
from collections import defaultdict
from typing import Any, Callable, Dict, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Set, Tuple

from .movingai import Cell
from .plans import Plan


class Visit(NamedTuple):
    """A robot stands in a cell from ``arrive_ns`` to ``leave_ns`` [ns]; None: until the end."""

    robot: int
    cell: Cell
    arrive_ns: int
    leave_ns: Optional[int]


class Move(NamedTuple):
    """A robot goes from one cell to the next from ``begin_ns`` to ``end_ns`` [ns]; None: it has not arrived."""

    robot: int
    start: Cell
    goal: Cell
    begin_ns: int
    end_ns: Optional[int]


class Piece(NamedTuple):
    """A robot goes straight at an even speed from ``start`` to ``goal`` (x, y) [m], from ``begin`` to ``end`` [s]."""

    robot: int
    begin: float
    end: float
    start: Tuple[float, float]
    goal: Tuple[float, float]

    def at(self, time: float) -> Tuple[float, float]:
        """Return where the robot is at a time [s]: (x, y) [m]."""
        share = (time - self.begin) / (self.end - self.begin) if self.end > self.begin else 0.0
        return tuple(a + share * (b - a) for a, b in zip(self.start, self.goal))  # type: ignore[return-value]


def plan_conflicts(plan: Plan) -> Tuple[int, int]:
    """Return the numbers of vertex and swap conflicts of a plan: pairs of robots, summed over the steps."""
    vertex = swap = 0
    for step in range(max(plan.costs) + 1):
        cells: Dict[Cell, List[int]] = defaultdict(list)
        moves: Dict[Tuple[Cell, Cell], int] = defaultdict(int)
        for robot in range(len(plan.paths)):
            cell = plan.at(robot, step)
            cells[cell].append(robot)
            before = plan.at(robot, step - 1) if step else cell
            if before != cell:
                swap += moves[cell, before]
                moves[before, cell] += 1
        vertex += sum(len(robots) * (len(robots) - 1) // 2 for robots in cells.values())
    return vertex, swap


def vertex_conflicts(visits: Iterable[Visit]) -> List[Tuple[Visit, Visit]]:
    """Return the pairs of visits of two robots in one cell at the same instant, the earlier visit first."""
    by_cell: Dict[Cell, List[Visit]] = defaultdict(list)
    for visit in visits:
        by_cell[visit.cell].append(visit)
    return [pair for group in by_cell.values() for pair in _overlapping(
        sorted(group, key=lambda visit: (visit.arrive_ns, visit.robot)),
        lambda visit, other: visit.leave_ns is None or other.arrive_ns <= visit.leave_ns)]


def swap_conflicts(moves: Iterable[Move]) -> List[Tuple[Move, Move]]:
    """Return the pairs of moves by which two robots swap cells: in opposite directions at the same time."""
    by_edge: Dict[Tuple[Cell, ...], List[Move]] = defaultdict(list)
    for move in moves:
        by_edge[tuple(sorted((move.start, move.goal)))].append(move)
    return [(one, other) for group in by_edge.values() for one, other in _overlapping(
        sorted(group, key=lambda move: (move.begin_ns, move.robot)),
        lambda move, other: move.end_ns is None or other.begin_ns < move.end_ns) if one.start != other.start]


def _overlapping(group: Sequence[Any], lasts_until: Callable[[Any, Any], bool]) -> Iterator[Tuple[Any, Any]]:
    """Yield the pairs (one, other) that overlap, of a group sorted by begins.

    ``lasts_until(one, other)``: whether ``one`` lasts until ``other`` begins.
    """
    for index, other in enumerate(group):
        for one in group[:index]:
            if one.robot != other.robot and lasts_until(one, other):
                yield one, other


def nearest(pieces: Iterable[Piece], near: float, seconds: float) -> Dict[Tuple[int, int], float]:
    """Return {(robot, robot): least distance [m]} for all pairs that come nearer than ``near`` [m].

    ``seconds``: the length of the spans of time into which pieces are sorted; the result does not depend on it.
    """
    boxes: Dict[Tuple[int, int, int], List[Piece]] = defaultdict(list)
    for piece in pieces:
        for box in _boxes(piece, near, seconds):
            boxes[box].append(piece)
    found: Dict[Tuple[int, int], float] = {}
    seen: Set[Tuple[int, int]] = set()
    for group in boxes.values():
        for index, one in enumerate(group):
            for other in group[:index]:
                key = (id(one), id(other))
                if one.robot == other.robot or key in seen:
                    continue
                seen.add(key)
                distance = _least(one, other)
                pair = min(one.robot, other.robot), max(one.robot, other.robot)
                if distance < near and distance < found.get(pair, math.inf):
                    found[pair] = distance
    return found


def _boxes(piece: Piece, near: float, seconds: float) -> Iterator[Tuple[int, int, int]]:
    """Yield the boxes of time and place that a piece, with ``near`` around it, touches."""
    sides = [range(math.floor((min(a, b) - near / 2.0) / near), math.floor((max(a, b) + near / 2.0) / near) + 1)
             for a, b in zip(piece.start, piece.goal)]
    for turn in range(math.floor(piece.begin / seconds), math.floor(piece.end / seconds) + 1):
        for column in sides[0]:
            for row in sides[1]:
                yield turn, column, row


def _least(one: Piece, other: Piece) -> float:
    """Return the least distance [m] between two pieces while both last; infinite if they do not overlap in time."""
    begin, end = max(one.begin, other.begin), min(one.end, other.end)
    if begin > end:
        return math.inf
    (ax, ay), (bx, by) = one.at(begin), other.at(begin)
    (cx, cy), (dx, dy) = one.at(end), other.at(end)
    px, py, vx, vy = ax - bx, ay - by, (cx - dx) - (ax - bx), (cy - dy) - (ay - by)
    square = vx * vx + vy * vy
    share = 0.0 if square <= 0.0 else min(1.0, max(0.0, -(px * vx + py * vy) / square))
    return math.hypot(px + share * vx, py + share * vy)
