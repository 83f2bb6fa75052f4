"""The maps of the recordings, with the places to which robots may be sent, and the places where they meet.

Units are metres in the map frame, with the lower left corner at (0, 0). A cell is 0.1 m, as in the yard that ships. A
*lane* is a straight way with a width, on which two robots can meet. A *junction* is a crossing of two straight ways.
"""
import random
from collections import namedtuple
from pathlib import Path

import numpy as np
import yaml
from PIL import Image, ImageDraw
from scipy.ndimage import distance_transform_edt, label

RESOLUTION = 0.1  # m per cell
_WALL = 0.2  # m
_FREE, _OCCUPIED = 254, 0  # grey, as map_saver writes them
_ROOT = Path(__file__).resolve().parent.parent.parent
_ROOM, _CORRIDOR = 4.0, 2.0  # m: a room's side, the corridor's width
_ROOMS = 4  # on each side of the corridor
_DOORS = (0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.2)  # m, from the corridor into the rooms; robots are 0.36 m wide
_INNER_DOORS = (0.5, 0.6, 0.7, 0.8, 1.0, 1.5)  # m, from room to room
_AISLES = (1.5, 1.8, 2.0, 2.4, 3.0)  # m
_RACK, _RACKS, _END = 1.0, 8.0, 2.0  # m: a rack's depth and length, the width of the ways that join the aisles

Lane = namedtuple('Lane', 'start end width')
Junction = namedtuple('Junction', 'middle arm width')


class Place:
    """A map with its lanes, junctions and goals. ``clearance``: least distance of random goals from walls [m]."""

    def __init__(self, name, image, lanes, junctions, clearance):
        self.name, self.image, self.lanes, self.junctions = name, image, lanes, junctions
        self.width, self.height = (side * RESOLUTION for side in image.size)
        free = np.flipud(np.asarray(image)) > 250
        self.clearances = distance_transform_edt(free) * RESOLUTION - RESOLUTION / 2.0
        wide = self.clearances >= clearance
        parts, _ = label(self.clearances >= 0.19)
        largest = np.bincount(parts[parts > 0]).argmax()
        self.cells = [(x, y) for y, x in np.argwhere(wide & (parts == largest))]

    def clearance(self, x, y):
        """Return the distance from (x, y) to the nearest wall, from cell centre to cell edge [m]; 0 outside."""
        row, column = int(y / RESOLUTION), int(x / RESOLUTION)
        inside = 0 <= row < self.clearances.shape[0] and 0 <= column < self.clearances.shape[1]
        return max(0.0, float(self.clearances[row, column])) if inside else 0.0

    def point(self, chance):
        """Return the centre (x, y) [m] of a cell that is drawn uniformly among those with the clearance."""
        x, y = chance.choice(self.cells)
        return (x + 0.5) * RESOLUTION, (y + 0.5) * RESOLUTION

    def roomy_place_near(self, x, y):
        """Return the centre (x, y) [m] of the nearest cell with the clearance."""
        column, row = min(self.cells, key=lambda cell: ((cell[0] + 0.5) * RESOLUTION - x) ** 2
                          + ((cell[1] + 0.5) * RESOLUTION - y) ** 2)
        return (column + 0.5) * RESOLUTION, (row + 0.5) * RESOLUTION

    def write(self, folder):
        """Write the image and the YAML file for map_server; return the path of the YAML file."""
        self.image.save(folder / (self.name + '.png'), optimize=True)
        path = folder / (self.name + '.yaml')
        path.write_text(yaml.safe_dump({
            'image': self.name + '.png', 'resolution': RESOLUTION, 'origin': [0.0, 0.0, 0.0], 'negate': 0,
            'occupied_thresh': 0.65, 'free_thresh': 0.196}, sort_keys=False))
        return path


class _Drawing:
    def __init__(self, width, height):
        self._height = height
        self.image = Image.new('L', (round(width / RESOLUTION), round(height / RESOLUTION)), _OCCUPIED)
        self._draw = ImageDraw.Draw(self.image)

    def fill(self, x0, y0, x1, y1, shade=_FREE):
        self._draw.rectangle((round(x0 / RESOLUTION), round((self._height - y1) / RESOLUTION),
                              round(x1 / RESOLUTION) - 1, round((self._height - y0) / RESOLUTION) - 1), fill=shade)


def yard():
    """Return the yard that ships with the package."""
    lanes = [Lane((12.0, 20.0), (24.0, 20.0), 8.0), Lane((36.0, 20.0), (48.0, 20.0), 8.0),
             Lane((30.0, 6.0), (30.0, 16.0), 8.0), Lane((36.0, 26.6), (50.0, 26.6), 1.0),
             Lane((36.0, 29.6), (50.0, 29.6), 1.0), Lane((4.0, 24.0), (4.0, 34.0), 7.6)]
    lanes = [lane for lane in lanes if lane.width >= 2.0]
    image = Image.open(_ROOT / 'maps' / 'farm_yard.png').convert('L')
    return Place('farm_yard', image, lanes, [Junction((30.0, 20.0), 5.0, 8.0)], 1.0)


def aisles(seed):
    """Return racks with aisles of 1.5 to 3 m between them, joined at both ends; ``seed`` decides their order."""
    widths = list(_AISLES)
    random.Random('aisles {}'.format(seed)).shuffle(widths)
    width = sum(widths) + _RACK * (len(widths) - 1) + 2.0 * _WALL
    height = _RACKS + 2.0 * (_END + _WALL)
    drawing, lanes, junctions = _Drawing(width, height), [], []
    drawing.fill(_WALL, _WALL, width - _WALL, height - _WALL)
    left = _WALL
    for number, aisle in enumerate(widths):
        middle = left + aisle / 2.0
        lanes.append(Lane((middle, _WALL + _END), (middle, height - _WALL - _END), aisle))
        if 0 < number < len(widths) - 1:
            junctions += [Junction((middle, y), 3.0, min(aisle, _END))
                          for y in (_WALL + _END / 2.0, height - _WALL - _END / 2.0)]
        if number < len(widths) - 1:
            drawing.fill(left + aisle, _WALL + _END, left + aisle + _RACK, height - _WALL - _END, _OCCUPIED)
        left += aisle + _RACK
    lanes += [Lane((2.0, y), (width - 2.0, y), _END) for y in (_WALL + _END / 2.0, height - _WALL - _END / 2.0)]
    return Place('aisles_{}'.format(seed), drawing.image, lanes, junctions, 0.5)


def rooms(seed):
    """Return rooms along a corridor, with doors down to nearly the robots' width; ``seed`` decides their order."""
    chance = random.Random('rooms {}'.format(seed))
    doors, inner = list(_DOORS), list(_INNER_DOORS)
    chance.shuffle(doors)
    chance.shuffle(inner)
    width = _ROOMS * (_ROOM + _WALL) + _WALL
    height = 2.0 * (_ROOM + 2.0 * _WALL) + _CORRIDOR
    middle = height / 2.0
    drawing, lanes = _Drawing(width, height), [Lane((1.5, middle), (width - 1.5, middle), _CORRIDOR)]
    drawing.fill(_WALL, middle - _CORRIDOR / 2.0, width - _WALL, middle + _CORRIDOR / 2.0)
    for number, door in enumerate(doors):
        side, column = divmod(number, _ROOMS)
        left = _WALL + column * (_ROOM + _WALL)
        low = _WALL if side == 0 else height - _WALL - _ROOM
        drawing.fill(left, low, left + _ROOM, low + _ROOM)
        x = round(left + chance.uniform(1.0, _ROOM - 1.0 - door), 1)
        wall = low + _ROOM if side == 0 else low - _WALL
        drawing.fill(x, wall, x + door, wall + _WALL)
        lanes.append(Lane((x + door / 2.0, wall - 1.2), (x + door / 2.0, wall + _WALL + 1.2), door))
        if column < _ROOMS - 1:
            gap = inner[side * (_ROOMS - 1) + column]
            y = round(low + chance.uniform(0.8, _ROOM - 0.8 - gap), 1)
            drawing.fill(left + _ROOM, y, left + _ROOM + _WALL, y + gap)
            lanes.append(Lane((left + _ROOM - 1.3, y + gap / 2.0), (left + _ROOM + _WALL + 1.3, y + gap / 2.0), gap))
    return Place('rooms_{}'.format(seed), drawing.image, lanes, [], 0.5)


def place(name):
    """Return the Place ``name``: farm_yard, aisles_N or rooms_N."""
    kind, _, seed = name.partition('_')
    return yard() if name == 'farm_yard' else {'aisles': aisles, 'rooms': rooms}[kind](int(seed))
