"""Loads maps from files, and writes them; how they are read is in ``common.map_files``, whose names are here, too."""
from __future__ import annotations

import os
from typing import Any, Sequence

import numpy as np
import yaml

from ..common import own_files
from ..common.errors import ConfigurationError
from ..common.map_files import MapDescription, read_description, read_pixels
from ..common.map_images import cells_of_image
from .occupancy import OccupancyMap

__all__ = ['MapDescription', 'load_map', 'read_description', 'read_pixels', 'write_map']


def load_map(description: MapDescription) -> OccupancyMap:
    """Return the :class:`OccupancyMap` of a :class:`MapDescription`.

    :raises ConfigurationError: if the image is missing, damaged or in a format that cannot be read.
    """
    if description.beside:
        raise ConfigurationError('{}: cannot be read: No such file or directory; beside the YAML file there is {}: '
                                 'correct the image there'.format(description.image, description.beside))
    return OccupancyMap(cells_of_image(read_pixels(description.image), description.rule), description.resolution,
                        description.origin)


def write_map(folder: str, name: str, blocked: Any, resolution: float, origin: Sequence[float] = (0.0, 0.0),
              head: str = '') -> str:
    """Write a map for map_server, NAME.pgm and NAME.yaml, into a folder of ours; return the path of NAME.yaml.

    ``blocked``: which cells are occupied, an array [row from the north, column]; the others are free. ``resolution``
    [m]; ``origin`` (x, y) [m]: the south-western corner; ``head``: comments of NAME.yaml.

    :raises OutputError: if a file cannot be written.
    """
    path = os.path.join(folder, name)
    with own_files.whole_file(path + '.pgm', 'wb') as image:
        image.write('P5\n{} {}\n255\n'.format(*blocked.shape[::-1]).encode()
                    + np.where(blocked, 0, 254).astype(np.uint8).tobytes())
    with own_files.whole_file(path + '.yaml', encoding='utf-8') as stream:
        stream.write(head + yaml.safe_dump({
            'image': name + '.pgm', 'resolution': resolution, 'origin': [*origin, 0.0], 'negate': 0,
            'occupied_thresh': 0.65, 'free_thresh': 0.196}, sort_keys=False, default_flow_style=None, width=120))
    return path + '.yaml'
