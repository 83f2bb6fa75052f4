"""Tiny nets, each place with room for one robot, and an exhaustive search that says whether their robots can arrive.

One robot after the other goes from a node to a neighbour that is free, and all have to stand at their goals at one
time. A robot whose goal is where it starts has arrived at once, and stays. The search knows nothing of the product: it
spreads the set of all joint places that can be reached, as one array, until nothing new comes.
"""
import random
from typing import NamedTuple

import numpy as np

APART = 10.0  # m, from a node to the next one in its row or column
ZONE = 1.0  # m; the zone of a node reaches as far to each side
_WIDTH = 4  # nodes in a row


class Instance(NamedTuple):
    """``nodes``: {name: (column, row)}; ``edges``: [(node, node), ...]; ``robots``: {name: (start, goal)}, nodes."""

    nodes: dict
    edges: list
    robots: dict
    is_grid: bool

    def net(self, **more):
        """Return the document of the net of lanes."""
        return {**more,
                'nodes': [{'name': name, 'x': APART * x, 'y': APART * y} for name, (x, y) in self.nodes.items()],
                'edges': [{'from': one, 'to': other, 'capacity': 1} for one, other in self.edges]}

    def scenario(self, lanes, has_zones, **more):
        """Return the scenario for the net in the file ``lanes``; ``has_zones``: with a zone for one robot at each node.

        Otherwise the net gives the nodes their capacity.
        """
        return {'lanes': str(lanes), 'defaults': {'routes': 'lanes', 'max_speed': 1.0, 'log_motion': True},
                'robots': [{'name': name, 'start_x': APART * x, 'start_y': APART * y}
                           for name, (x, y) in ((name, self.nodes[start]) for name, (start, _) in self.robots.items())],
                'zones': [{'name': 'at_' + name, 'capacity': 1,
                           'rectangle': [APART * x - ZONE, APART * y - ZONE, APART * x + ZONE, APART * y + ZONE]}
                          for name, (x, y) in self.nodes.items() if has_zones], **more}


def instance(seed):
    """Return the :class:`Instance` of a seed: 4 to 12 nodes, 2 to 4 robots.

    Every other one is a grid, of which all neighbours are joined. The others have some of the lanes of a grid, and some
    across its fields; no two lanes cross.
    """
    dice = random.Random(seed)
    is_grid = seed % 2 == 0
    cells = [(dice.randrange(_WIDTH), dice.randrange(_WIDTH))]
    for _ in range(dice.randint(3, 11)):
        cells.append(dice.choice(sorted({cell for one in cells for cell in _around(one, not is_grid)} - {*cells})))
    names = {cell: f'n{number}' for number, cell in enumerate(cells)}
    robots = dice.randint(2, min(4, len(cells) - 1))
    starts, goals = dice.sample(list(names.values()), robots), dice.sample(list(names.values()), robots)
    return Instance({name: cell for cell, name in names.items()}, _lanes(names, dice, is_grid),
                    {f'r{number}': pair for number, pair in enumerate(zip(starts, goals))}, is_grid)


def _around(cell, with_corners):
    x, y = cell
    return [(x + i, y + j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i or j) and (with_corners or not (i and j))
            and 0 <= x + i < _WIDTH and 0 <= y + j < _WIDTH]


def _lanes(names, dice, is_grid):
    """Return lanes that join all nodes; on a grid all that there are, else a tree and some more."""
    pairs = [(one, other) for one in names for other in _around(one, not is_grid) if other in names and one < other]
    dice.shuffle(pairs)
    kept, more = [], []
    part = {cell: cell for cell in names}  # {cell: the name of its part}
    for one, other in pairs:
        if part[one] == part[other]:
            more.append((one, other))
        elif _crosses(one, other, kept):
            continue
        else:
            kept.append((one, other))
            part = {cell: part[one] if its == part[other] else its for cell, its in part.items()}
    for one, other in more:
        if is_grid or dice.random() < 0.25 and not _crosses(one, other, kept):
            kept.append((one, other))
    assert len({*part.values()}) == 1
    return [(names[one], names[other]) for one, other in kept]


def _crosses(one, other, kept):
    """Return whether the lane crosses one of those that are kept: the other one across the same field of the grid."""
    (x, y), (to_x, to_y) = one, other
    return x != to_x and y != to_y and (((x, to_y), (to_x, y)) in kept or ((to_x, y), (x, to_y)) in kept)


def is_solvable(one, stays=True):
    """Return whether all robots of an :class:`Instance` can stand at their goals, by trying all joint places.

    ``stays``: whether a robot whose goal is where it starts makes way for none.
    """
    places = {name: number for number, name in enumerate(one.nodes)}
    steps = np.eye(len(places), dtype=np.float32)
    for begin, end in one.edges:
        steps[places[begin], places[end]] = steps[places[end], places[begin]] = 1.0
    count = len(one.robots)
    allowed = np.ones((len(places),) * count, bool)
    for first in range(count):
        for second in range(first):
            axes = [len(places) if axis in (first, second) else 1 for axis in range(count)]
            allowed &= ~np.eye(len(places), dtype=bool).reshape(axes)
    start, goal = (tuple(places[pair[end]] for pair in one.robots.values()) for end in (0, 1))
    reached = np.zeros_like(allowed)
    reached[start] = True
    while not reached[goal]:
        before = reached.copy()
        for axis, (begin, end) in enumerate(one.robots.values()):
            if stays and begin == end:
                continue
            moved = np.tensordot(steps, reached.astype(np.float32), (0, axis)) > 0.0
            reached |= np.moveaxis(moved, 0, axis) & allowed
        if (reached == before).all():
            return False
    return True
