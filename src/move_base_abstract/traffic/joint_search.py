"""An exact search over the joint places of a few robots: the moves, one at a time, that bring each to where it wants.

A robot stands at a place, and moves from place to place. A place, and each step between two places, lies in areas with
room for some robots. The search is A*: it finds a way with the fewest moves if there is one, and says so if there is
none. It knows nothing of robots but their places.
"""
from __future__ import annotations

from collections import deque
from heapq import heappop, heappush
from itertools import count
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

#: how many joint places are looked at by default before the search gives up
MOST_STATES = 100_000

Place = Any  # anything that can be a key
Joint = Tuple[Place, ...]
Move = Tuple[int, Place]


class Net(NamedTuple):
    """Where robots can stand, and how they move.

    ``areas``: {place: the areas of a robot that stands there}; ``steps``: {place: {next place: the areas of a robot on
    its way there, besides those of both places}}; ``room``: {area: the number of robots that have place in it}, without
    those that are not in it.
    """

    areas: Mapping[Place, Tuple[Any, ...]]
    steps: Mapping[Place, Mapping[Place, Tuple[Any, ...]]]
    room: Mapping[Any, int]

    def enters(self, place: Place, to: Place) -> List[Any]:
        """Return the areas into which a robot comes that moves from ``place`` to ``to``, each once."""
        held = self.areas[place]
        return [area for area in dict.fromkeys((*self.steps[place][to], *self.areas[to])) if area not in held]


class TooManyStates(Exception):
    """The search has looked at as many joint places as it may."""


def find_moves(net: Net, begin: Joint, wanted: Sequence[Optional[Place]], most: int = MOST_STATES,
               goals: Sequence[Optional[Place]] = ()) -> Optional[List[Move]]:
    """Return [(number of a robot, the place to which it moves), ...], or None if there is no way at all.

    ``begin``: the place of each robot; ``wanted``: where each has to stand at the end, None: anywhere,
    but only where a way leads from there to its place in ``goals``, if that is given.

    :raises TooManyStates: if there are more than ``most`` joint places to look at.
    """
    ends = [goal if want is None else want for want, goal in zip(wanted, goals or wanted)]
    far = [_distances(net, end) for end in ends]
    if any(place not in known for place, known, want in zip(begin, far, wanted) if want is not None):
        return None
    numbers = count()
    cost: Dict[Joint, int] = {begin: 0}
    came: Dict[Joint, Tuple[Joint, Move]] = {}
    open_: List[Tuple[int, int, int, Joint]] = [(_least(begin, far, wanted), 0, next(numbers), begin)]
    done: Dict[Joint, bool] = {}
    while open_:
        *_, joint = heappop(open_)
        if joint in done:
            continue
        if all(want is None or place == want for place, want in zip(joint, wanted)):
            return _back(came, joint)
        done[joint] = True
        if len(done) > most:
            raise TooManyStates
        for robot, to in _moves(net, joint):
            after = (*joint[:robot], to, *joint[robot + 1:])
            price = cost[joint] + 1
            if price < cost.get(after, price + 1) and (ends[robot] is None or to in far[robot]):
                cost[after], came[after] = price, (joint, (robot, to))
                heappush(open_, (price + _least(after, far, wanted), -price, next(numbers), after))
    return None


def find_most(net: Net, begin: Joint, wanted: Sequence[Optional[Place]], most: int,
              goals: Sequence[Place]) -> Tuple[List[Move], List[Optional[Place]]]:
    """Return (moves that bring some robots to where they want, where these stand then; None: anywhere).

    One robot after the other is added if there is a way for it together with those before; the others make way.

    :raises TooManyStates: as :func:`find_moves`.
    """
    moves: List[Move] = []
    met: List[Optional[Place]] = [None] * len(wanted)
    for robot, want in enumerate(wanted):
        also = [*met[:robot], want, *met[robot + 1:]]
        found = None if want is None else find_moves(net, begin, also, most, goals)
        if found is not None:
            moves, met = found, also
    return moves, met


def _moves(net: Net, joint: Joint) -> List[Move]:
    """Return the moves that are possible, in the order of the robots."""
    inside: Dict[Any, int] = {}
    for place in joint:
        for area in net.areas[place]:
            inside[area] = inside.get(area, 0) + 1
    return [(robot, to) for robot, place in enumerate(joint) for to in net.steps[place]
            if all(inside.get(area, 0) < net.room.get(area, len(joint)) for area in net.enters(place, to))]


def _distances(net: Net, wanted: Optional[Place]) -> Dict[Place, int]:
    """Return {place: the number of moves from there to ``wanted`` if no other robot is in the way}."""
    if wanted is None:
        return {}
    before: Dict[Place, List[Place]] = {}
    for place, steps in net.steps.items():
        for to in steps:
            before.setdefault(to, []).append(place)
    found = {wanted: 0}
    open_ = deque([wanted])
    while open_:
        place = open_.popleft()
        for one in before.get(place, ()):
            if one not in found:
                found[one] = found[place] + 1
                open_.append(one)
    return found


def _least(joint: Joint, far: Sequence[Mapping[Place, int]], wanted: Sequence[Optional[Place]]) -> int:
    """Return a number of moves with which it cannot be done faster."""
    return sum([known[place] for place, known, want in zip(joint, far, wanted) if want is not None])


def _back(came: Mapping[Joint, Any], joint: Joint) -> List[Move]:
    moves: List[Move] = []
    while joint in came:
        joint, move = came[joint]
        moves.append(move)
    return moves[::-1]
