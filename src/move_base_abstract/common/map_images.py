"""How the image of a map becomes cells: free, occupied, unknown, or a value between. Only values; no file is read."""
from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import ConfigurationError
from .kinds import error

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: the cell values of a nav_msgs/OccupancyGrid
FREE, OCCUPIED, UNKNOWN = 0, 100, -1

_WHITE = 255


class MapMode(Enum):
    """How the shade of a pixel becomes the value of a cell."""

    TRINARY = 'trinary'
    SCALE = 'scale'
    RAW = 'raw'


@dataclass(frozen=True)
class ImageRule:
    """How an image is read: mode, whether white is occupied (``negate``), and the two thresholds of occupancy (0..1).

    :raises ConfigurationError: if a threshold is not finite.
    """

    mode: MapMode = MapMode.TRINARY
    negate: bool = False
    occupied_thresh: float = 0.65
    free_thresh: float = 0.196

    def __post_init__(self) -> None:
        for name in ('occupied_thresh', 'free_thresh'):
            if not math.isfinite(getattr(self, name)):
                raise error(name, getattr(self, name), 'a finite number, 0..1 as a rule')

    def cell_of_shade(self, shade: float) -> int:
        """Return the cell value of an opaque pixel of ``shade`` (0 black .. 255 white, fractions allowed).

        It does exactly what map_server of ROS Noetic does: black is occupied; the thresholds are exclusive; fractions
        are cut off, not rounded; ``raw`` takes the shade as one byte, so 255 is -1 (unknown) and 101..254 have no
        meaning.
        """
        if self.negate:
            shade = _WHITE - shade
        if self.mode is MapMode.RAW:
            return int(np.uint8(shade).view(np.int8))
        occupancy = (_WHITE - shade) / float(_WHITE)
        if occupancy > self.occupied_thresh:
            return OCCUPIED
        if occupancy < self.free_thresh:
            return FREE
        if self.mode is MapMode.TRINARY:
            return UNKNOWN
        span = self.occupied_thresh - self.free_thresh
        return int(1 + 98 * ((occupancy - self.free_thresh) / span)) if span > 0.0 else 1


def cells_of_image(pixels: NDArray[Any], rule: ImageRule) -> NDArray[Any]:
    """Return the int8 cells (row 0 in the south) of ``pixels``, uint8 (rows from the top, columns, channels).

    Channels: 1 = grey, 3 = colour, 4 = colour and alpha. The shade of a pixel is the mean of its channels. In the mode
    ``trinary`` the alpha channel is one of them (as in map_server). In the mode ``scale`` a fully transparent pixel
    between the thresholds is unknown.

    :raises ConfigurationError: if ``pixels`` has another type or shape.
    """
    pixels = np.asarray(pixels)
    if pixels.dtype != np.uint8 or pixels.ndim != 3 or pixels.shape[2] not in (1, 3, 4) or not pixels.size:
        raise ConfigurationError('image: got pixels of type {} and shape {}; allowed: uint8 of shape (rows, columns, '
                                 'channels) with 1, 3 or 4 channels'.format(pixels.dtype, pixels.shape))
    channels = pixels.shape[2]
    has_alpha = channels == 4
    counted = 3 if has_alpha and rule.mode is not MapMode.TRINARY else channels
    sums = pixels[:, :, :counted].sum(axis=2, dtype=np.uint16)
    table = np.array([rule.cell_of_shade(total / float(counted)) for total in range(_WHITE * counted + 1)], np.int8)
    cells = table[sums]
    if has_alpha and rule.mode is MapMode.SCALE:
        between = (cells != FREE) & (cells != OCCUPIED)
        cells[between & (pixels[:, :, 3] == 0)] = UNKNOWN
    return np.ascontiguousarray(cells[::-1])
