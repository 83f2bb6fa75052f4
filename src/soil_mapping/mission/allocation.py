"""Who gets a task: round robin or an auction; and where in the queue it goes."""

import math

from ..config import Allocation

WAY_DECIMALS = 6  # of metres


class Allocator:
    """The queues of all robots. A queue holds what a robot has not begun; the task it is at is not in it.

    Both allocations put a task where it makes the robot's queue longest by least (insertion heuristic): the way from
    where the robot will be free, which is where its present task is (or where it stands, if it has none), through all
    its tasks in order [m]. Equal ways: the earlier place.

    Round robin takes the robots in turn, and the turn goes on from one round of tasks to the next. In the auction
    (sequential single-item), every robot bids that whole way with the task in it; the lowest bid wins, ties go to the
    lower robot index. Ways that differ by less than a micrometre are equal, so that no rounding decides.

    :param places: (x, y) of each robot [m].
    """

    def __init__(self, allocation, places):
        self._auction = allocation is Allocation.AUCTION
        self._free_at = list(places)
        self.queues = [[] for _ in places]
        self._turn = 0

    def free_at(self, robot, place):
        """Note where a robot is that has no present task."""
        self._free_at[robot] = place

    def take(self, robot):
        """Remove and return the first task of a robot's queue; it becomes the robot's present one."""
        task = self.queues[robot].pop(0)
        self._free_at[robot] = (task.x, task.y)
        return task

    def allocate(self, task):
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

    def _cheapest(self, robot, task):
        """Return (length of the queue's way with the task [m], the position at which that is least)."""
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
