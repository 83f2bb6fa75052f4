"""Lay out a site (nodes, lanes, places, zones, starts, walls), and write the files of its scenario."""
from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Mapping, Optional, Sequence

import numpy as np
import yaml

from move_base_abstract.common import own_files
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.maps.map_files import write_map

if TYPE_CHECKING:
    import random

FOLDER = own_files.FolderKind('scenario', ['scenario.yaml', 'lanes.yaml', 'map.yaml', 'map.pgm', 'orders.csv'])
#: the settings of the dispatcher that assigns the orders of a site
DISPATCHER = {'policy': 'nearest', 'charge_below': 0.3, 'charge_until': 0.9, 'charge_when_idle': 0.6}
_DEADLINE = 600.0  # s, from the arrival of an order
_MOST_CELLS = 4_000  # along a side of the map


@dataclass
class Site:
    """A site, lengths in m; each name occurs once. ``walls``: occupied boxes [(x_min, y_min, x_max, y_max), ...]."""

    #: (x_min, y_min, x_max, y_max) of the map; there is a wall around it
    box: tuple
    nodes: dict = field(default_factory=dict)  # {name: (x, y)}
    edges: list = field(default_factory=list)
    places: list = field(default_factory=list)
    zones: list = field(default_factory=list)
    starts: list = field(default_factory=list)  # (x, y) where robots may start, in the order in which they are used
    walls: list = field(default_factory=list)
    orders: list = field(default_factory=list)  # (arrival [s], name of a place, or (place to load, place to unload))

    def lane(self, begin: str, end: str, one_way: bool = True, capacity: Optional[int] = None) -> None:
        """Add a lane from node to node."""
        self.edges.append({'from': begin, 'to': end, **({'one_way': True} if one_way else {}),
                           **({'capacity': capacity} if capacity else {})})

    def place(self, name: str, node: str, **work: float) -> None:
        """Add a place at a node; ``work``: further keys of the place."""
        x, y = self.nodes[node]
        self.places.append({'name': name, 'x': x, 'y': y, **work})

    def charger(self, name: str, x: float, y: float, half: float = 0.8) -> None:
        """Add a charger with room for one robot, and a node in its middle. ``half``: half of its side [m]."""
        self.nodes[name] = x, y
        self.zones.append({'name': name, 'rectangle': [x - half, y - half, x + half, y + half], 'capacity': 1,
                           'charger': True})

    @property
    def goes_to_and_fro(self) -> bool:
        """Whether its orders have two stops, so that it needs a dispatcher."""
        return bool(self.orders) and not isinstance(self.orders[0][1], str)

    def draw_orders(self, count: int, seconds: float, names: Sequence[str], ends: Sequence[str],
                    dice: random.Random) -> None:
        """Draw ``count`` orders that arrive within ``seconds``, each for one of the places ``names``.

        ``dice``: a Random. ``ends``: the places to which goods are brought from there; if there are
        none, an order is work at its place.
        """
        instants = sorted(round(dice.uniform(0.0, seconds), 3) for _ in range(count))
        places = [dice.choice(names) for _ in instants]
        targets = [dice.choice(ends) if ends else None for _ in instants]
        self.orders = [(instant, (place, target) if target else place)
                       for instant, place, target in zip(instants, places, targets)]


def write_site(site: Site, robots: int, defaults: Mapping[str, float], words: str, folder: str) -> None:
    """Write the files of a scenario into a ``folder``.

    ``robots``: their number; ``defaults``: their settings; ``words``: the command, for a comment in the files.

    :raises ConfigurationError: if a file in the folder is not of this program, or there are not enough starts.
    :raises OutputError: if it cannot be written.
    """
    if robots > len(site.starts):
        raise ConfigurationError('--robots: got {}; allowed: at most {} of them start at a place of their own in a '
                                 'world of these sizes'.format(robots, len(site.starts)))
    head = '# Made by: {}\n'.format(words)
    marker = FOLDER.make(folder)
    try:
        _write(folder, 'lanes.yaml', head + _yaml({
            'nodes': [{'name': name, 'x': x, 'y': y} for name, (x, y) in site.nodes.items()], 'edges': site.edges}))
        _write_map(folder, head, site)
        if site.goes_to_and_fro:
            _write(folder, 'orders.csv', 'time,stops,deadline\n' + ''.join(
                '{},load {}; unload {},{:g}\n'.format(instant, *stops, _DEADLINE) for instant, stops in site.orders))
        elif site.orders:
            _write(folder, 'orders.csv', 'time,place\n' + ''.join('{},{}\n'.format(*order) for order in site.orders))
        _write(folder, 'scenario.yaml', head + _yaml({
            'lanes': 'lanes.yaml', 'defaults': {'routes': 'lanes', **defaults},
            'robots': [{'name': 'robot_{}'.format(number), 'start_x': x, 'start_y': y}
                       for number, (x, y) in enumerate(site.starts[:robots])],
            'zones': site.zones, 'places': site.places,
            **({'deadlock': 'avoid'} if any('capacity' in edge for edge in site.edges) else {}),
            **({'orders' if site.goes_to_and_fro else 'arrivals': [{'name': 'orders', 'file': 'orders.csv'}]}
               if site.orders else {}),
            **({'dispatcher': DISPATCHER} if site.goes_to_and_fro else {})}))
    finally:
        os.close(marker)


def _yaml(value: Mapping[str, Any]) -> str:
    return yaml.safe_dump(_rounded(value), sort_keys=False, default_flow_style=None, width=120)


def _rounded(value: Any) -> Any:
    """Return ``value`` with numbers rounded to the millimetre, and lists instead of tuples."""
    if isinstance(value, float):
        return round(value, 3)
    if isinstance(value, dict):
        return {key: _rounded(one) for key, one in value.items()}
    return [_rounded(one) for one in value] if isinstance(value, (list, tuple)) else value


def _write_map(folder: str, head: str, site: Site) -> None:
    left, low, right, high = site.box
    resolution = 0.1 * 2 ** max(0, int(np.ceil(np.log2(max(right - left, high - low) / 0.1 / _MOST_CELLS))))
    columns, rows = (int(round(side / resolution)) for side in (right - left, high - low))
    blocked = np.zeros((rows, columns), bool)  # the first row is in the south
    for x_min, y_min, x_max, y_max in site.walls:
        begin = [int(round(value / resolution)) for value in (x_min - left, y_min - low)]
        end = [int(round(value / resolution)) for value in (x_max - left, y_max - low)]
        blocked[max(0, begin[1]):max(0, end[1]), max(0, begin[0]):max(0, end[0])] = True
    blocked[[0, -1]] = blocked[:, [0, -1]] = True
    write_map(folder, 'map', blocked[::-1], round(resolution, 3), (round(left, 3), round(low, 3)), head)


def _write(folder: str, name: str, text: str) -> None:
    with own_files.whole_file(os.path.join(folder, name), 'w', encoding='utf-8') as stream:
        stream.write(text)
