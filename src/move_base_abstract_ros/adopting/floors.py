"""Find where a map's frame lies in Stage's world, from the floor plan of a world file and the map's own file."""
import math
import os

import numpy as np

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.geometry import Pose2D
from move_base_abstract.common.map_files import read_description, read_pixels
from move_base_abstract.common.map_images import FREE, OCCUPIED, UNKNOWN, ImageRule, cells_of_image

from . import worlds
from .worlds import Unknown, is_world, turned

_DRAWN = 127  # Stage's threshold: darker pixels are walls
_MOST_CELLS = 50_000_000
_ALIKE = 0.03  # share of a length by which two lengths may differ


def offset(floor, words):
    """Return (x [m], y [m], yaw [rad]) of the origin of a map's frame in Stage's world.

    Stage stretches the drawn part of an image to the size of its model; map_server uses the whole image.

    :param floor: the Floor of the world file, or None; words: the arguments of map_server: a YAML file, or an image and
        its resolution.
    :raises Unknown: if it cannot be known; the text says why.
    """
    if floor is None:
        raise Unknown('the world file has no floor plan with an image and a size')
    try:
        image, resolution, origin = _described(words)
        rows, columns = read_pixels(image).shape[:2]
    except ConfigurationError as error:
        raise Unknown('the map cannot be read: {}'.format(error)) from None
    if origin.yaw:
        raise Unknown('the map is turned')
    width, height = columns * resolution, rows * resolution
    left, bottom, right, top = (0.0, 0.0, 1.0, 1.0)
    if not _alike(floor, width, height):
        left, bottom, right, top = _drawn(floor.image)
        if not _alike(floor, width * (right - left), height * (top - bottom)):
            raise Unknown('the floor plan is {:g} m x {:g} m, the map {:g} m x {:g} m'.format(
                floor.width, floor.height, width, height))
    x, y = turned(-origin.x - left * width - floor.width / 2, -origin.y - bottom * height - floor.height / 2, floor.yaw)
    return _rounded(floor.x + x), _rounded(floor.y + y), floor.yaw


def map_of(path):
    """Return (cells, resolution [m], origin) of the floor plan of a world file of Stage, in the frame of that world.

    Cells are as in an OccupancyMap. The drawn part of the image is as large as the model, as Stage makes it; each of
    its pixels has a cell, so that no wall is lost.

    :raises ConfigurationError: if the file has no floor plan that can be read.
    """
    try:
        floor = worlds.read(path).floor
        if floor is None or not (floor.width > 0.0 and floor.height > 0.0):
            raise Unknown('it has no floor plan with an image and a size')
        left, bottom, right, top = _drawn(floor.image)
        dark = read_pixels(os.path.abspath(floor.image))[::-1, :, 0] < _DRAWN
    except (OSError, ValueError, Unknown) as error:
        raise ConfigurationError('{}: {}'.format(path, error)) from None
    rows, columns = dark.shape
    dark = dark[round(bottom * rows):round(top * rows), round(left * columns):round(right * columns)]
    sides = floor.height, floor.width
    resolution = min(side / count for side, count in zip(sides, dark.shape))
    counts = [round(side / resolution) for side in sides]
    if counts[0] * counts[1] > _MOST_CELLS:
        raise ConfigurationError('{}: its floor plan would have {} x {} cells; allowed: up to {}'.format(
            path, *counts, _MOST_CELLS))
    pixels = [((np.arange(count) + 0.5) * there / count).astype(int) for count, there in zip(counts, dark.shape)]
    origin = Pose2D(floor.x, floor.y, floor.yaw).compose(Pose2D(-floor.width / 2, -floor.height / 2))
    return np.where(dark[np.ix_(*pixels)], OCCUPIED, FREE).astype(np.int8), resolution, origin


def ground(words):
    """Return a function for a map_server with these arguments: where (x, y) [m, map frame] lies on its map, in words.

    It returns '' in free cells, and everywhere if we cannot read the map.
    """
    try:
        if words[:1] and is_world(words[0]):
            cells, resolution, origin = map_of(words[0])
        else:
            image, resolution, origin = _described(words)
            rule = read_description(words[0]).rule if image != words[0] else ImageRule()
            cells = cells_of_image(read_pixels(image), rule)
    except (ConfigurationError, Unknown):
        return lambda _x, _y: ''

    def at(x, y):
        place = origin.inverse().compose(Pose2D(x, y))
        column, row = math.floor(place.x / resolution), math.floor(place.y / resolution)
        if not (0 <= row < cells.shape[0] and 0 <= column < cells.shape[1]):
            return 'off the map'
        value = cells[row, column]
        return '' if 0 <= value < OCCUPIED else 'in an {} cell of the map'.format(
            'unknown' if value == UNKNOWN else 'occupied')
    return at


def why_not_served(words):
    """Return why a map_server with these arguments would serve no map, or ''."""
    if not words or not os.path.isfile(words[0]):
        return 'its map {} is not here'.format(words[0] if words else '(no name)')
    try:
        image = _described(words)[0]
    except (ConfigurationError, Unknown) as error:
        return 'its map cannot be read: {}'.format(error)
    return '' if os.path.isfile(image) else 'the image of its map, {}, is not here'.format(image)


def beside(words):
    """Return the image that lies beside the YAML file of a map_server's map, which names another place, or ''."""
    try:
        return read_description(words[0]).beside if words and words[0].endswith(('.yaml', '.yml')) else ''
    except ConfigurationError:
        return ''


def _described(words):
    """Return (path of the image, resolution [m], origin as Pose2D) of a map."""
    if len(words) > 1 and not words[0].endswith(('.yaml', '.yml')):
        try:
            return words[0], float(words[1]), Pose2D()
        except ValueError:
            raise Unknown('the map has no resolution') from None
    found = read_description(words[0])
    return found.beside or found.image, found.resolution, found.origin


def _alike(floor, width, height):
    return abs(floor.width - width) <= _ALIKE * width and abs(floor.height - height) <= _ALIKE * height


def _drawn(image):
    """Return (left, bottom, right, top) of the drawn part of an image, as shares of its width and height."""
    try:
        dark = read_pixels(os.path.abspath(image))[:, :, 0] < _DRAWN
    except ConfigurationError as error:
        raise Unknown("the floor plan's image cannot be read: {}".format(error)) from None
    rows, columns = np.flatnonzero(dark.any(axis=1)), np.flatnonzero(dark.any(axis=0))
    if not len(rows):
        raise Unknown("nothing is drawn in the floor plan's image")
    return (float(columns[0]) / dark.shape[1], 1.0 - float(rows[-1] + 1) / dark.shape[0],
            float(columns[-1] + 1) / dark.shape[1], 1.0 - float(rows[0]) / dark.shape[0])


def _rounded(value):
    return round(value, 6) + 0.0
