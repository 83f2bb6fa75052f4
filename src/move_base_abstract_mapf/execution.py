"""Decide, move by move, which robots of a plan may begin their next move, and record the moves. No fleet, no ROS here.

Each move takes a robot to a neighbouring cell. It begins at its step at the earliest, when the robot has arrived where
the move starts. A policy says what else must be true:

as_timed    nothing
order_kept  robots enter each cell in the order of the plan: the robot before has begun to leave the cell
cell_left   as order_kept, and the robot before has arrived in its next cell
"""
from __future__ import annotations

from collections import defaultdict
from typing import Callable, Dict, Iterator, List, NamedTuple, Optional, Tuple

from .conflicts import Move, Visit
from .movingai import Cell
from .plans import Plan

POLICIES = ('as_timed', 'order_kept', 'cell_left')
AS_TIMED, ORDER_KEPT, CELL_LEFT = POLICIES


class Wanted(NamedTuple):
    """A move of the plan: at ``step`` from ``start`` to ``goal``.

    ``after``: the move by which the robot that was in the goal's cell before leaves it; None if no robot was there
    before, or this one itself.
    """

    step: int
    start: Cell
    goal: Cell
    after: Optional[Tuple[int, int]]  # (robot, number of its move)


class Execution:
    """Begins the moves of robots; look() calls ``send(robot, goal, start)`` for each, with two cells.

    ``begin_ns``: the instant of step 0 [ns]; ``step_ns``: the duration of a step [ns].
    """

    def __init__(self, plan: Plan, policy: str, begin_ns: int, step_ns: int,
                 send: Callable[[int, Cell, Cell], object]) -> None:
        self.plan = plan
        self.moves = _moves_of(plan)
        self.done: List[List[Move]] = [[] for _ in plan.paths]  # the last one may be under way
        self.retries = 0
        self._policy = policy
        self._begin_ns, self._step_ns = begin_ns, step_ns
        self._send = send
        self._arrived = [0] * len(plan.paths)  # per robot, the number of moves that have ended
        self._again_ns: Dict[int, int] = {}

    @property
    def instants_ns(self) -> Iterator[int]:
        """The instants [ns] at which :meth:`look` must be called; it must also be called when a move ends."""
        steps = sorted({move.step for moves in self.moves for move in moves})
        return (self._begin_ns + step * self._step_ns for step in steps)

    @property
    def is_over(self) -> bool:
        """Whether all robots have come to their last cells."""
        return all(count == len(moves) for count, moves in zip(self._arrived, self.moves))

    def ended(self, robot: int, has_arrived: bool, now_ns: int) -> None:
        """Take the end of a robot's move. A robot that has not arrived tries again a step later, in :meth:`look`."""
        if has_arrived:
            self.done[robot][-1] = self.done[robot][-1]._replace(end_ns=now_ns)
            self._arrived[robot] += 1
        else:
            self.retries += 1
            self._again_ns[robot] = now_ns + self._step_ns

    def look(self, now_ns: int) -> None:
        """Let all robots begin that may. Robots that wait for one another in a circle begin together."""
        for robot in [robot for robot, again_ns in self._again_ns.items() if again_ns <= now_ns]:
            del self._again_ns[robot]
            move = self.moves[robot][self._arrived[robot]]
            self._send(robot, move.goal, move.start)
        able = {robot for robot in range(len(self.moves)) if self._is_ready(robot, now_ns)}
        while True:
            hindered = [robot for robot in able if not self._may_follow(robot, able)]
            if not hindered:
                break
            able.difference_update(hindered)
        for robot in sorted(able):
            move = self.moves[robot][self._arrived[robot]]
            self.done[robot].append(Move(robot, move.start, move.goal, now_ns, None))
            self._send(robot, move.goal, move.start)

    def _is_ready(self, robot: int, now_ns: int) -> bool:
        count = self._arrived[robot]
        return (len(self.done[robot]) == count < len(self.moves[robot])
                and now_ns >= self._begin_ns + self.moves[robot][count].step * self._step_ns)

    def _may_follow(self, robot: int, able: 'set[int]') -> bool:
        after = self.moves[robot][self._arrived[robot]].after
        if self._policy == AS_TIMED or after is None:
            return True
        other, number = after
        if self._policy == CELL_LEFT:
            return self._arrived[other] > number
        return len(self.done[other]) > number or (len(self.done[other]) == number and other in able)

    def waits_for(self) -> Dict[int, int]:
        """Return {robot: the robot that must leave first} for the robots that wait for another one."""
        found = {}
        for robot, moves in enumerate(self.moves):
            count = self._arrived[robot]
            if len(self.done[robot]) == count < len(moves) and not self._may_follow(robot, set()):
                after = moves[count].after
                if after is not None:
                    found[robot] = after[0]
        return found

    def visits(self) -> Iterator[Visit]:
        """Yield a Visit for each cell in which a robot has stood."""
        for robot, moves in enumerate(self.done):
            arrive_ns, cell = self._begin_ns, self.plan.paths[robot][0]
            for move in moves:
                yield Visit(robot, cell, arrive_ns, move.begin_ns)
                if move.end_ns is None:
                    break
                arrive_ns, cell = move.end_ns, move.goal
            else:
                yield Visit(robot, cell, arrive_ns, None)

    def costs_ns(self) -> List[Optional[int]]:
        """Return for each robot when it came to its last cell, from step 0 on [ns]; None: it has not."""
        return [None if self._arrived[robot] < len(moves) else (self.done[robot][-1].end_ns or 0) - self._begin_ns
                if moves else 0 for robot, moves in enumerate(self.moves)]


def _moves_of(plan: Plan) -> List[List[Wanted]]:
    """Return the moves of each robot, each with the move by which the robot before leaves its goal."""
    stays: Dict[Cell, List[Tuple[int, int, Optional[int]]]] = defaultdict(list)  # (step of arrival, robot, move away)
    moves: List[List[Tuple[int, Cell, Cell]]] = []
    for robot, path in enumerate(plan.paths):
        own: List[Tuple[int, Cell, Cell]] = []
        came = 0
        for step, (one, other) in enumerate(zip(path, path[1:])):
            if one != other:
                stays[one].append((came, robot, len(own)))
                own.append((step, one, other))
                came = step + 1
        stays[path[-1]].append((came, robot, None))
        moves.append(own)
    before: Dict[Tuple[Cell, int, int], Tuple[int, int]] = {}
    for cell, visits in stays.items():
        visits.sort(key=lambda visit: visit[:2])
        for (_, left_by, away), (came, robot, _) in zip(visits, visits[1:]):
            if away is not None and left_by != robot:
                before[cell, robot, came] = left_by, away
    return [[Wanted(step, one, other, before.get((other, robot, step + 1))) for step, one, other in own]
            for robot, own in enumerate(moves)]
