"""Where robots can go: cells of a map, nets of lanes, tables of times; and the planners that find ways on them."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'grid_planner': 'GridPlanner', 'lane_map': 'LaneMap make_lane_map read_lane_map', 'lane_planner': 'LanePlanner',
    'map_check': 'MapCheck', 'map_files': 'load_map read_description', 'occupancy': 'OccupancyMap',
    'planning': 'StraightLinePlanner WorldBounds',
    'travel_matrix': 'MatrixPlanner TravelMatrix make_travel_matrix read_travel_matrix'})
