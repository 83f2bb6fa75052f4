"""The walls of a map in the form for the time master: runs of occupied cells."""
from __future__ import annotations

from typing import List

import numpy as np

from ..common.errors import ConfigurationError
from ..maps.map_files import load_map, read_description

_OCCUPIED = 65  # of 100, as map_server's occupied_thresh; on a map with shades, this or more
_MOST_SIDE = 1 << 15


def wall_lines(path: str) -> List[str]:
    """Return the lines with the walls of the map whose YAML file is ``path``.

    :raises ConfigurationError: if it cannot be read, is rotated, or has more than 32768 cells along a side.
    """
    found = load_map(read_description(path))
    if found.axes != (1.0, 0.0):
        raise ConfigurationError(f'{path}: origin: a map whose walls a radio counts must not be rotated')
    if max(found.width, found.height) > _MOST_SIDE:
        raise ConfigurationError(f'{path}: got {found.width} x {found.height} cells; allowed: at most {_MOST_SIDE} '
                                 'along a side')
    lines = ['walls {!r} {!r} {!r} {} {}'.format(found.origin.x, found.origin.y, found.resolution, found.width,
                                                 found.height)]
    for row, cells in enumerate(np.asarray(found.cells) >= _OCCUPIED):
        edges = np.flatnonzero(np.diff(np.concatenate(([False], cells, [False])).astype(np.int8)))
        if len(edges):
            lines.append(' '.join(['wall', str(row), *map(str, edges.tolist())]))
    return lines
