"""Loads maps from files; how such files are read is in ``common.map_files``, whose names are here, too."""
from __future__ import annotations

from ..common.map_files import MapDescription, read_description, read_pixels
from ..common.map_images import cells_of_image
from .occupancy import OccupancyMap

__all__ = ['MapDescription', 'load_map', 'read_description', 'read_pixels']


def load_map(description: MapDescription) -> OccupancyMap:
    """Return the :class:`OccupancyMap` of a :class:`MapDescription`.

    :raises ConfigurationError: if the image is missing, damaged or in a format that cannot be read.
    """
    return OccupancyMap(cells_of_image(read_pixels(description.image), description.rule), description.resolution,
                        description.origin)
