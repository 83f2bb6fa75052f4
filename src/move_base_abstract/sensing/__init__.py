"""Laser scans of a robot: rays that end in the map, or at the outlines of other robots."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .laser import Laser as Laser, LaserSettings as LaserSettings, Scan as Scan, read_laser as read_laser
    from .surroundings import Surroundings as Surroundings
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
