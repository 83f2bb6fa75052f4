"""Make sites from sizes: a warehouse, a field, a ward. The same sizes and seed give the same files, to the byte."""
from __future__ import annotations

import random
from typing import Iterator, List, Mapping, NamedTuple, Tuple

from move_base_abstract.common.errors import ConfigurationError

from .layout import Site


class Size(NamedTuple):
    """One size of a site: its name, its default, its smallest and largest value, and ``what`` it is, for --help."""

    name: str
    default: int
    least: int
    most: int
    what: str


_SEED = Size('seed', 1, 0, 2 ** 31 - 1, 'seed of the orders')
_ORDERS = Size('orders', 200, 0, 100_000, 'orders that arrive within an hour')
#: {kind: (what it is, sizes, settings of all robots)}
KINDS = {
    'warehouse': ('one-way aisles between shelves, stations in front, chargers behind', (
        Size('aisles', 12, 2, 500, 'aisles, up and down in turn'), Size('bays', 6, 3, 500, 'nodes in an aisle'),
        Size('stations', 4, 1, 499, 'stations, fewer than aisles'),
        Size('chargers', 7, 1, 499, 'chargers, fewer than aisles'), Size('robots', 50, 1, 100_000, 'robots'),
        Size('lane_capacity', 0, 0, 1000, 'robots for which there is room on a lane; 0: any number'), _ORDERS, _SEED),
        {'max_speed': 1.5, 'acceleration': 0.8, 'robot_radius': 0.3, 'battery_capacity': 24.0}),
    'field': ('rows of a crop between two headlands, a yard with chargers', (
        Size('rows', 20, 2, 2000, 'rows'), Size('length', 60, 10, 10_000, 'length of a row [m]'),
        Size('chargers', 2, 1, 100, 'chargers'), Size('robots', 5, 1, 4000, 'robots'), _ORDERS, _SEED),
        {'max_speed': 1.0, 'acceleration': 0.5, 'robot_radius': 0.5, 'battery_capacity': 48.0}),
    'ward': ('rooms for one robot each on both sides of a corridor, a desk, chargers', (
        Size('rooms', 12, 2, 2000, 'rooms'), Size('chargers', 2, 1, 100, 'chargers'),
        Size('robots', 4, 1, 1000, 'robots'), _ORDERS, _SEED),
        {'max_speed': 1.0, 'acceleration': 0.5, 'robot_radius': 0.3, 'battery_capacity': 24.0})}


def make_site(kind: str, sizes: Mapping[str, int]) -> Site:
    """Return the :class:`.Site` of a ``kind`` (one of KINDS) with ``sizes``, {name: number}.

    :raises ConfigurationError: if the sizes do not fit one another.
    """
    site, names = {'warehouse': _warehouse, 'field': _field, 'ward': _ward}[kind](sizes)
    ends = [place['name'] for place in site.places if place['name'].startswith('station')]
    site.draw_orders(sizes['orders'], 3600.0, names, ends, random.Random(sizes['seed']))
    return site


_APART, _BAY, _ASIDE = 4.0, 3.0, 4.0  # m; distances of aisles, of bays in an aisle, of stations from the cross aisle


def _warehouse(sizes: Mapping[str, int]) -> Tuple[Site, List[str]]:
    """Lay out a warehouse, and return it with the places of orders.

    Aisles go up and down in turn, the last one down. The front lane leads west, the back lane east, so that robots can
    get from everywhere to everywhere.
    """
    aisles, bays, capacity = sizes['aisles'], sizes['bays'], sizes['lane_capacity'] or None
    for name in ('stations', 'chargers'):
        if sizes[name] >= aisles:
            raise ConfigurationError('--{}: got {}; allowed: fewer than --aisles, {}'.format(name, sizes[name], aisles))
    width, depth = _APART * (aisles - 1), _BAY * (bays - 1)
    site = Site((-7.0, -7.0, width + 3.0, depth + 7.0))
    site.nodes['gate'] = -_ASIDE, 0.0
    for aisle in range(aisles):
        for bay in range(bays):
            site.nodes[_bay(aisle, bay)] = _APART * aisle, _BAY * bay
    site.lane('gate', _bay(0, 0), one_way=False, capacity=capacity)
    for aisle in range(aisles):
        is_down = aisle % 2 == 1 or aisle == aisles - 1
        for bay in range(bays - 1):
            pair = _bay(aisle, bay), _bay(aisle, bay + 1)
            site.lane(*(pair[::-1] if is_down else pair), capacity=capacity)
    for aisle in range(1, aisles):
        site.lane(_bay(aisle, 0), _bay(aisle - 1, 0), capacity=capacity)
        site.lane(_bay(aisle - 1, bays - 1), _bay(aisle, bays - 1), capacity=capacity)
        site.walls.append((_APART * (aisle - 1) + 1.2, 1.5, _APART * aisle - 1.2, depth - 1.5))
    for number, aisle in _spread(sizes['stations'], aisles - 1):
        name = 'station_{}'.format(number)
        site.nodes[name] = _APART * (aisle - 0.5), -_ASIDE
        site.lane(_bay(aisle, 0), name, capacity=capacity)
        site.lane(name, _bay(aisle - 1, 0), capacity=capacity)
        site.place(name, name, capacity=1, duration=20.0)
    for number, aisle in _spread(sizes['chargers'], aisles - 1):
        name = 'charger_{}'.format(number)
        site.charger(name, _APART * (aisle - 0.5), depth + _ASIDE)
        site.lane(_bay(aisle - 1, bays - 1), name, capacity=capacity)
        site.lane(name, _bay(aisle, bays - 1), capacity=capacity)
    return _with_bays(site, aisles, bays)


def _bay(aisle: int, bay: int) -> str:
    return 'bay_{}_{}'.format(aisle + 1, bay + 1)


def _with_bays(site: Site, aisles: int, bays: int) -> Tuple[Site, List[str]]:
    """Add the places between the shelves, and the starts: first at bays, then between two bays of an aisle."""
    names = [_bay(aisle, bay) for aisle in range(aisles) for bay in range(1, bays - 1)]
    for name in names:
        site.place(name, name, duration=10.0)
    for bay in range(2 * bays - 1):
        site.starts += [(_APART * aisle, _BAY * bay / 2.0) for aisle in range(aisles)]
    site.starts.sort(key=lambda start: start[1] % _BAY != 0.0)
    return site, names


def _spread(count: int, most: int) -> Iterator[Tuple[int, int]]:
    """Yield (number from 1 on, place in 1..most) for ``count`` things that are spread evenly; count <= most."""
    yield from ((number + 1, 1 + number * most // count) for number in range(count))


def _field(sizes: Mapping[str, int]) -> Tuple[Site, List[str]]:
    """Lay out a field, and return it with the places of orders.

    Each row has a node at both headlands and one in the middle, where robots work.
    """
    rows, length, chargers = sizes['rows'], float(sizes['length']), sizes['chargers']
    wide = 3.0 * (rows - 1)
    site = Site((-6.0, -12.0, max(wide, 3.0 * (chargers + 1)) + 6.0, length + 6.0))
    for row in range(rows):
        for part, y in (('south', 0.0), ('middle', length / 2.0), ('north', length)):
            site.nodes['{}_{}'.format(part, row + 1)] = 3.0 * row, y
    for row in range(1, rows + 1):
        site.lane('south_{}'.format(row), 'middle_{}'.format(row), one_way=False)
        site.lane('middle_{}'.format(row), 'north_{}'.format(row), one_way=False)
        site.place('row_{}'.format(row), 'middle_{}'.format(row), duration=30.0)
        if row > 1:
            for part in ('south', 'north'):
                site.lane('{}_{}'.format(part, row - 1), '{}_{}'.format(part, row), one_way=False)
            site.walls.append((3.0 * (row - 1) - 1.7, 2.0, 3.0 * (row - 1) - 1.3, length - 2.0))
    site.nodes['yard'] = 0.0, -4.0
    site.lane('yard', 'south_1', one_way=False)
    _row_of_chargers(site, 'yard', chargers, -8.0)
    site.starts += [site.nodes['{}_{}'.format(part, row + 1)] for part in ('south', 'north') for row in range(rows)]
    return site, [place['name'] for place in site.places]


def _row_of_chargers(site: Site, node: str, count: int, y: float) -> None:
    """Add chargers side by side at ``y`` [m], each with a lane of its own from ``node`` and back."""
    x = site.nodes[node][0]
    for number in range(1, count + 1):
        name = 'charger_{}'.format(number)
        site.charger(name, x + 3.0 * (number - 1), y)
        site.lane(node, name, one_way=False)


def _ward(sizes: Mapping[str, int]) -> Tuple[Site, List[str]]:
    """Lay out a ward, and return it with the places of orders.

    Each door node of the corridor leads to two rooms; each room is a zone for one robot.
    """
    rooms, chargers = sizes['rooms'], sizes['chargers']
    doors = (rooms + 1) // 2
    right = 5.0 * doors
    site = Site((-6.0 - 3.0 * (chargers - 1), -8.0, right + 2.0, 8.0))
    site.nodes['desk'] = 0.0, 0.0
    for door in range(1, doors + 1):
        site.nodes['door_{}'.format(door)] = 5.0 * door - 2.5, 0.0
        site.lane('door_{}'.format(door - 1) if door > 1 else 'desk', 'door_{}'.format(door), one_way=False)
        _two_rooms(site, door, rooms)
    site.nodes['hall'] = -3.0, 0.0
    site.lane('desk', 'hall', one_way=False)
    for number in range(1, chargers + 1):
        name = 'charger_{}'.format(number)
        site.charger(name, -3.0 * number, -4.0)
        site.lane('hall', name, one_way=False)
    site.place('desk', 'desk', duration=30.0)
    site.starts += [site.nodes['door_{}'.format(door)] for door in range(1, doors + 1)]
    return site, [place['name'] for place in site.places if place['name'] != 'desk']


def _two_rooms(site: Site, door: int, rooms: int) -> None:
    x = 5.0 * door - 2.5
    for number, side in ((2 * door - 1, 1.0), (2 * door, -1.0)):
        low, high = sorted((side * 1.6, side * 2.0))
        if number > rooms:
            site.walls.append((x - 2.5, low, x + 2.5, high))
            continue
        name = 'room_{}'.format(number)
        site.nodes[name] = x, side * 5.0
        site.lane('door_{}'.format(door), name, one_way=False)
        site.place(name, name, duration=60.0)
        inner = sorted((side * 2.0, side * 7.8))
        site.zones.append({'name': 'in_' + name, 'rectangle': [x - 2.3, inner[0], x + 2.3, inner[1]], 'capacity': 1})
        site.walls += [(x - 2.5, low, x - 0.7, high), (x + 0.7, low, x + 2.5, high)]
        far = sorted((side * 2.0, side * 8.0))
        site.walls += [(x - 2.6, far[0], x - 2.4, far[1]), (x + 2.4, far[0], x + 2.6, far[1])]
