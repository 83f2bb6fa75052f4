"""Robots, zones and places as markers for RViz."""
from move_base_abstract.common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'marker_builder': 'Look View', 'robot_markers': 'RobotMarkers', 'world_markers': 'AreaMarkers'})
