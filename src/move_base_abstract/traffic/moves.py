"""The moves of robots that a search has found, and how far they are: each area is entered in the order of the moves."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List, Optional, Sequence, Tuple

if TYPE_CHECKING:
    from .area import Area
    from .joint_search import Move, Net
    from .traveller import Traveller


class Moves:
    """Moves of ``robots`` [(Traveller, node of its goal), ...] from the joint places ``begin``.

    ``moves``: [(number of a robot, place), ...] on ``net``. :attr:`nodes`: {Traveller: the nodes to which it drives}.
    """

    def __init__(self, robots: Sequence[Tuple[Traveller, str]], net: Net, begin: Sequence[Any],
                 moves: Sequence[Move]) -> None:
        self.nodes: Dict[Traveller, List[Any]] = {traveller: [] for traveller, _ in robots}
        self._goals = dict(robots)
        self._begins: Dict[Traveller, Any] = {traveller: place for (traveller, _), place in zip(robots, begin)}
        self._begun = dict.fromkeys(self.nodes, 0)  # the number of moves that each has begun
        self._entries: Dict[Any, List[Tuple[Traveller, int]]] = {}  # {area: [(Traveller, number of its move), ...]}
        joint = list(begin)
        for robot, place in moves:
            traveller = robots[robot][0]
            self.nodes[traveller].append(place)
            for area in net.enters(joint[robot], place):
                self._entries.setdefault(area, []).append((traveller, len(self.nodes[traveller])))
            joint[robot] = place

    def ends_at_goal(self, traveller: Traveller) -> bool:
        """Return whether the moves of a robot, of which it has some, end at its goal."""
        return bool(self.nodes[traveller][-1] == self._goals[traveller])

    def uses(self, areas: Sequence[Area]) -> bool:
        """Return whether any of ``areas`` has yet to be entered."""
        return any(self._entries.get(area) for area in areas)

    def allows(self, traveller: Traveller, areas: Sequence[Area]) -> bool:
        """Return whether no other robot enters any of ``areas`` before."""
        return all(not self._entries.get(area) or self._entries[area][0][0] is traveller for area in areas)

    def entered(self, traveller: Traveller, areas: Sequence[Area]) -> None:
        """Note that a robot has got a place in ``areas``."""
        for area in areas:
            entries = self._entries.get(area)
            if entries and entries[0][0] is traveller:
                self._begun[traveller] = max(self._begun[traveller], entries.pop(0)[1])

    def left(self, traveller: Traveller, node: Optional[str], ends: Sequence[str]) -> List[str]:
        """Return the nodes to which a robot still drives that is at ``node``, or on an edge between the nodes ``ends``.

        The robot is in the last move that it has begun, or at the end of that, or still where it begins.
        """
        begins = [self._begins[traveller], *self.nodes[traveller]]
        first = max(0, self._begun[traveller] - 1)
        if node is None:
            number = next((number for number in range(first, len(begins) - 1) if begins[number + 1] in ends
                           and (begins[number] in ends or not number)), len(begins) - 1)
            return begins[number + 1:]
        begun = self._begun[traveller]
        order = [begun, first, *range(begun, len(begins))]
        number = next((number for number in order if begins[number] == node), begun)
        return begins[number + 1:]
