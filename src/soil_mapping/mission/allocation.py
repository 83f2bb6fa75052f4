"""The allocation of tasks to robots, by round robin or auction, and the position of each task in the robot's queue."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Optional, Sequence, Tuple

from ..config import Allocation

if TYPE_CHECKING:
    from .sampling import Task

WAY_DECIMALS = 6  # of metres


class Allocator:
    """The queues of all robots. A queue has the tasks that a robot has not begun, without its present task.

    Both allocations put a task at the position where it lengthens the robot's way least (insertion heuristic). The way
    [m] begins where the robot will be free: at its present task, or where it stands if it has none. It goes through all
    tasks of the queue in order. Among equal ways the earlier position is taken.

    Round robin takes the robots in turn, and the turn goes on from one round of tasks to the next. In the auction
    (sequential single-item), every robot bids the length of its whole way with the task in it. The lowest bid wins;
    ties go to the lower robot index. Ways that differ by less than a micrometre are equal, so that no rounding error
    decides.

    :param places: (x, y) of each robot [m].
    """

    def __init__(self, allocation: Optional[Allocation], places: Sequence[Tuple[float, float]]) -> None:
        self._auction = allocation is Allocation.AUCTION
        self._free_at = list(places)
        self.queues: Any = [[] for _ in places]
        self._turn = 0

    def free_at(self, robot: int, place: Tuple[float, float]) -> None:
        """Note the place (x, y) [m] of a robot that has no present task."""
        self._free_at[robot] = place

    def take(self, robot: int) -> Task:
        """Remove and return the first task of a robot's queue, which becomes the robot's present task."""
        task = self.queues[robot].pop(0)
        self._free_at[robot] = (task.x, task.y)
        return task

    def allocate(self, task: Task) -> int:
        """Put a task into a robot's queue; return the robot's index."""
        if self._auction:
            bids = [self._cheapest(robot, task) for robot in range(len(self.queues))]
            robot = min(range(len(bids)), key=lambda index: bids[index][0])
            position = bids[robot][1]
        else:
            robot, self._turn = self._turn, (self._turn + 1) % len(self.queues)
            position = self._cheapest(robot, task)[1]
        self.queues[robot].insert(position, task)
        return robot

    def _cheapest(self, robot: int, task: Task) -> Tuple[float, int]:
        """Return (least length of the robot's way with the task [m], the position of the task for it)."""
        stops = [self._free_at[robot], *((queued.x, queued.y) for queued in self.queues[robot])]
        place = (task.x, task.y)
        length = sum(math.dist(a, b) for a, b in zip(stops, stops[1:]))
        best = (math.inf, 0)
        for position in range(len(stops)):
            before = stops[position]
            detour = math.dist(before, place)
            if position + 1 < len(stops):
                after = stops[position + 1]
                detour += math.dist(place, after) - math.dist(before, after)
            best = min(best, (round(length + detour, WAY_DECIMALS), position))
        return best
