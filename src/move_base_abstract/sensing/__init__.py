"""Laser scans of a robot: rays that end in the map, or at the outlines of other robots."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {'laser': 'Laser LaserSettings Scan read_laser', 'surroundings': 'Surroundings'})
