"""The shortest times over a net (Dijkstra), and the cheapest way while lanes cost more than their time.

The latter is A-star, with the shortest times as its heuristic.
"""
from __future__ import annotations

from heapq import heappop, heappush
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple

#: (index of an edge, time [ns] at full speed) -> what the lane costs in addition to its time [ns, >= 0]
Prices = Callable[[int, int], int]


def times_to(arriving: Sequence[Sequence[Tuple[int, int]]], last: int) -> List[Optional[int]]:
    """Return for each node the time [ns] of the shortest way from there to the node ``last``, None: there is no way.

    ``arriving``: for each node [(a node from which a lane leads to it, its time [ns]), ...]; nodes are numbers.
    """
    count = len(arriving)
    times: List[Optional[int]] = [None] * count
    times[last] = 0
    open_ = [last]  # time * count + node, since a number is compared faster than a pair
    while open_:
        time, node = divmod(heappop(open_), count)
        if time != times[node]:
            continue
        for begin, lane_ns in arriving[node]:
            found, known = time + lane_ns, times[begin]
            if known is None or found < known:
                times[begin] = found
                heappush(open_, found * count + begin)
    return times


def cheapest(leaving: Mapping[str, Sequence[Any]], times: Mapping[str, int], first: str, last: str,
             prices: Prices) -> Tuple[int, List[Any]]:
    """Return (cost [ns], lanes) of the cheapest way from the node ``first``, which is in ``times``, to ``last``.

    ``leaving``: the lanes from each node, sorted by the nodes to which they lead; ``times``: {node: ns to ``last`` at
    full speed} of all nodes from which there is a way. Of equally cheap ways, the one that is found first counts. It is
    always the same one, whatever other robots there are.
    """
    costs: Dict[str, int] = {first: 0}
    came: Dict[str, Any] = {}
    done: Dict[str, bool] = {}
    count = 0
    open_: List[Tuple[int, int, str]] = [(times[first], 0, first)]
    while open_:
        node = heappop(open_)[2]
        if node == last:
            break
        if node in done:
            continue
        done[node] = True
        for lane in leaving[node]:
            if lane.end in times:
                cost = costs[node] + lane.cost + prices(lane.edge, lane.cost)
                if lane.end not in costs or cost < costs[lane.end]:
                    costs[lane.end], came[lane.end] = cost, lane
                    count += 1
                    heappush(open_, (cost + times[lane.end], count, lane.end))
    lanes: List[Any] = []
    node = last
    while node != first:
        lanes.append(came[node])
        node = came[node].begin
    return costs[last], lanes[::-1]
